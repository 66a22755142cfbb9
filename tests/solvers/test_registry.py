"""One registry of methods, one resolver of settings: what a door asks for is understood, or refused in a sentence."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compas_cgc import AutoSettings
from compas_cgc import FlowSettings
from compas_cgc import NewtonSettings
from compas_cgc import ProjectionSettings
from compas_cgc import settings_for
from compas_cgc import solve
from compas_cgc.solvers import METHODS
from compas_cgc.solvers import Method
from compas_cgc.solvers import method_names
from compas_cgc.solvers import options
from compas_cgc.solvers import register

from .test_solve import dome


def test_nothing_given_leaves_everything_open():
    assert settings_for() is None
    assert settings_for("newton") == NewtonSettings()


def test_options_of_one_method_choose_it():
    assert settings_for(smoothness=0.2) == ProjectionSettings(smoothness=0.2)
    assert settings_for("auto", {"filter_radius": 2.0}) == FlowSettings(filter_radius=2.0)


def test_what_all_have_goes_to_whichever_is_picked():
    assert settings_for(steps=3, tolerance=1e-3) == AutoSettings(steps=3, tolerance=1e-3)
    result = solve(dome(), settings={"steps": 1})
    assert result.status == "step_limit" and result.iterations == 1


def test_a_delay_without_a_factor_lets_creases_follow_in_full():
    for made in (settings_for(delay=5), settings_for(e=5), settings_for("flow", delay=5), FlowSettings(e=5)):
        assert (made.s, made.e) == (1.0, 5)
    assert settings_for(delay=5, s=0.5).s == 0.5
    assert FlowSettings().s == 0.8


def test_numbers_of_numpy_are_numbers():
    assert settings_for("newton", steps=np.int64(7), tolerance=np.float32(0.5)) == NewtonSettings(steps=7, tolerance=0.5)
    assert type(NewtonSettings(steps=np.int32(7)).steps) is int
    assert FlowSettings(finish=np.bool_(False)).finish is False


REFUSED = [
    (("best", {}), "method must be one of auto, flow, newton, projection, bending, not 'best'"),
    (("auto", {"speed": 3}), "there is no setting 'speed'; there are steps, tolerance"),
    (("auto", {"s": 0.5, "smoothness": 0.1}), "do not belong to one method; name it, flow, newton, projection, bending"),
    (("newton", {"s": 0.5}), "s is a setting of flow, not of newton; leave it out, or use the method flow"),
    (("flow", {"steps": 0}), "steps must be a whole number from 1 up, not 0"),
    (("flow", {"steps": 2.5}), "steps must be a whole number from 1 up, not 2.5"),
    (("flow", {"steps": True}), "steps must be a whole number from 1 up, not True"),
    (("flow", {"steps": 10**400}), "steps must be a whole number from 1 up"),
    (("newton", {"tolerance": 0.0}), "tolerance must be a positive number"),
    (("flow", {"tolerance": float("nan")}), "tolerance must be a number from 0 up"),
    (("flow", {"s": 1.5}), "s must be between 0 and 1, not 1.5"),
    (("projection", {"retry": 1}), "retry must be True or False, not 1"),
    (("newton", {"start": "here"}), "start must be one of auto, elliptic, given, not 'here'"),
]


@pytest.mark.parametrize("asked, words", REFUSED)
def test_what_is_wrong_is_refused_in_a_sentence(asked, words):
    with pytest.raises(ValueError, match=words):
        settings_for(*asked)


@given(st.sampled_from(sorted(METHODS)), st.data())
def test_settings_go_through_json_and_come_back(method, data):
    own = METHODS[method].settings.options()
    values = {}
    for name in data.draw(st.sets(st.sampled_from(sorted(own)))):
        if own[name].kind is bool:
            values[name] = data.draw(st.booleans())
        elif own[name].choices:
            values[name] = data.draw(st.sampled_from(own[name].choices))
        elif own[name].kind is int:
            values[name] = data.draw(st.integers(1, 1000))
    made = settings_for(method, values)
    assert settings_for(method, json.loads(json.dumps(made.to_dict()))) == made


def test_what_is_infinite_goes_through_json_too():
    made = FlowSettings(zeta=float("inf"))
    assert settings_for("flow", json.loads(json.dumps(made.to_dict(), allow_nan=False))) == made


def test_every_option_says_what_it_does_and_what_it_takes():
    for name, own in options().items():
        assert own.summary.endswith(".") and len(own.summary) > 10, name
        assert own.rule, name
        assert own.default is None or own.checked(own.default) == own.default, name
    for method in METHODS.values():
        assert "Parameters\n" in method.settings.__doc__ and method.text.endswith(".")


@pytest.fixture
def toy():
    """A fourth method: it gives the mesh back."""
    from compas_cgc.model.result import Solution

    def still(problem, settings, callback):
        from compas_cgc.model.frame import Frame
        from compas_cgc.model.recorder import Recorder

        recorder = Recorder(settings.steps or 1, callback, Frame(np.zeros(3), 1.0), lambda vertices: vertices)
        recorder.record(0.0, 0.0, 0.0, 1.0, 1)
        recorder.cancelled(problem.vertices)
        return Solution(problem.vertices, "converged", "nothing was done", 1, recorder.seconds, 0.0, recorder.history)

    method = register(Method("still", "The mesh as it is.", AutoSettings, still))
    yield method
    METHODS.pop(method.name)


def test_a_fourth_method_is_one_value(toy):
    assert method_names()[-1] == "still"
    result = solve(dome(), method="still")
    assert (result.method, result.ending, result.iterations) == ("still", "nothing was done", 1)
    with pytest.raises(ValueError, match="there is a method 'still' already"):
        register(toy._replace(text="Another."))
    with pytest.raises(ValueError, match="method must be one of auto, flow, newton, projection, bending, still, not 'best'"):
        solve(dome(), method="best")
