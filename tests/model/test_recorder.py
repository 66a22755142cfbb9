"""The recorder: figures in model units, and a callback that cancels by True or by StopIteration, and by nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from compas_cgc.model.frame import Frame
from compas_cgc.model.recorder import Recorder

FRAME = Frame(np.array([1.0, 2.0, 3.0]), 4.0)


def recorder_of(callback, **more):
    recorder = Recorder(10, callback, FRAME, FRAME.to_model, **more)
    recorder.record(energy=1.0, error_norm=2.0, max_error=3.0, step_length=0.5, trials=2)
    return recorder


def test_figures_leave_the_local_frame():
    history = recorder_of(None, length_power=3).history
    assert (history.energy[0], history.error_norm[0], history.max_error[0]) == (4.0, 2.0 / 16, 3.0 / 16)
    assert history.step_length[0] == 0.5 * 64 and history.trials[0] == 2 and history.accepted[0]
    assert recorder_of(None).history.step_length[0] == 0.5


def test_the_callback_sees_the_model():
    seen = []
    assert not recorder_of(seen.append).cancelled(np.zeros((2, 3)))
    (state,) = seen
    assert (state.step, state.steps, state.energy, state.max_error) == (1, 10, 4.0, 3.0 / 16)
    assert np.array_equal(state.vertices, [[1.0, 2.0, 3.0]] * 2)


@pytest.mark.parametrize("answer", [None, False, 1, "yes", [0]])
def test_nothing_but_true_cancels(answer):
    assert not recorder_of(lambda state: answer).cancelled(np.zeros((1, 3)))


def test_true_and_stop_iteration_cancel():
    def stop(state):
        raise StopIteration

    assert recorder_of(lambda state: True).cancelled(np.zeros((1, 3)))
    assert recorder_of(stop).cancelled(np.zeros((1, 3)))
    assert not recorder_of(None).cancelled(np.zeros((1, 3)))
