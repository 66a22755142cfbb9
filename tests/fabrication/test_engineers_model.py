"""Engineer's model: text of the input file, reactions of CalculiX where it is installed, and its results."""

from __future__ import annotations

import os
import re
import shutil
import subprocess

import numpy as np
import pytest

from compas_cgc import CGCError
from compas_cgc import CGCProblem
from compas_cgc import FileError
from compas_cgc import get
from compas_cgc import read
from compas_cgc import solve
from compas_cgc.discrete import face_areas
from compas_cgc.discrete import face_normals
from compas_cgc.discrete.topology import boundary_mask
from compas_cgc.discrete.topology import within_rings
from compas_cgc.fabrication import membrane
from compas_cgc.io.frd import read_frd
from compas_cgc.io.frd import with_results
from compas_cgc.io.inp import Model
from compas_cgc.io.inp import inp_text
from compas_cgc.io.inp import load_cases
from compas_cgc.model.roles import FIXED

from ..support.constant_curvature import revolved_patch

MODEL = Model(snow=0.8, wind=(0.5, 0.3))
CORNERS = [0, 6, 48, 42]
CASES = [(0.02, "boundary"), (-0.02, "boundary"), (0.02, CORNERS)]


def state_of(K=0.02, supports="boundary", pressure=-1.5, weight=2.5):
    return membrane(CGCProblem(*revolved_patch(6, K)).with_supports(supports).with_targets(K), pressure, weight)


def by_thirds(problem, case):
    """Return the loads of a case on the vertices, a third of every face at each corner (n, 3)."""
    V, F = problem.vertices, problem.faces
    each = (case.pressure * face_normals(V, F) - [0.0, 0.0, case.weight]) * face_areas(V, F)[:, None] / 3.0
    total = np.zeros((len(V), 3))
    for corner in F.T:
        np.add.at(total, corner, each)
    return total + (case.forces if len(case.forces) else 0.0)


def test_lines_and_numbers_are_short_enough_for_both_programs():
    state = state_of(supports=CORNERS)
    text = inp_text(state, MODEL)
    assert max(map(len, text.splitlines())) <= 132 and text.isascii()
    data = [line for line in text.splitlines() if line[:1] not in "*"]
    assert max(len(number.strip()) for line in data for number in line.split(",")) <= 20
    assert max(line.count(",") for line in data) < 16
    places = np.array([line.split(",")[1:] for line in text.split("*NODE\n")[1].split("*")[0].splitlines()], dtype=float)
    assert np.abs(places - state.problem.vertices).max() < 1e-11


def test_the_model_states_its_units():
    text = inp_text(state_of(), MODEL)
    comments = " ".join(line[3:] for line in text.splitlines() if line.startswith("** "))
    assert "lengths and coordinates in m;" in comments and "unit of force: F" in comments and "moduli in F/m^2" in comments
    assert all(f"load case {name}, loads in F and F/m^2" in comments for name in ("PRESSURE", "SELF_WEIGHT", "SNOW", "WIND"))


def test_load_cases_have_the_loads_of_their_definition():
    state = state_of()
    V, F = state.problem.vertices, state.problem.faces
    cases = {case.name: case for case in load_cases(state, MODEL)}
    assert list(cases) == ["PRESSURE", "SELF_WEIGHT", "SNOW", "WIND"]
    (x, y) = (V[F][:, :, k] - V[F][:, :1, k] for k in (0, 1))
    plan = 0.5 * np.abs(x[:, 1] * y[:, 2] - x[:, 2] * y[:, 1]).sum()
    assert cases["SNOW"].forces.sum(axis=0) == pytest.approx([0, 0, -0.8 * plan])
    wind = cases["WIND"].forces
    assert (wind @ [0.5, 0.3, 0.0]).min() > 0.0 and np.abs(wind).max() > 0.0


@pytest.mark.parametrize(("supports", "noted"), [("boundary", True), (CORNERS, False)])
def test_a_held_rim_is_stated_to_be_indeterminate(supports, noted):
    state = state_of(supports=supports, weight=0.0)
    assert ("edges are held in all directions" in inp_text(state)) is noted
    assert any("edges are held in all directions" in remark for remark in state.remarks) is noted
    assert ("TYPE=B31" in inp_text(state)) is not noted


@pytest.mark.parametrize(("name", "value"), [("thickness", 0.0), ("beam", -1.0), ("modulus", 0.0)])
def test_sections_must_be_positive(name, value):
    with pytest.raises(CGCError, match=f"the {name} of the model must be positive"):
        inp_text(state_of(weight=0.0), Model(**{name: value}))


def test_sections_below_a_millimetre_are_written():
    sections = inp_text(state_of(supports=CORNERS, weight=0.0), Model(thickness=0.5, beam=0.75, modulus=0.5))
    assert "\n0.0005\n" in sections and "\n0.00075, 0.00075\n" in sections


def run_ccx(folder, text):
    (folder / "roof.inp").write_text(text)
    done = subprocess.run(
        ["ccx", "-i", "roof"], cwd=folder, capture_output=True, text=True, timeout=60, env={**os.environ, "OMP_NUM_THREADS": "1"}
    )
    assert done.returncode == 0 and "*ERROR" not in done.stdout, done.stdout[-2000:]
    totals = re.findall(r"total force.*\n\s*\n?(.*)\n", (folder / "roof.dat").read_text())
    return np.array([line.split() for line in totals], dtype=float)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
@pytest.mark.parametrize(("K", "supports"), CASES, ids=["dome", "saddle", "four corners"])
def test_calculix_carries_every_load_case_to_the_supports(tmp_path, K, supports):
    state = state_of(K, supports)
    totals = run_ccx(tmp_path, inp_text(state, MODEL))
    cases = load_cases(state, MODEL)
    assert len(totals) == len(cases) == 4
    loose = state.problem.roles != FIXED
    for case, total in zip(cases, totals):
        load = by_thirds(state.problem, case)[loose]
        assert np.abs(total + load.sum(axis=0)).max() < 1e-6 * np.linalg.norm(load, axis=1).sum()
    revised = with_results(state, tmp_path / "roof.frd", 0.01)
    assert np.median(revised.forces) < 0.0 or K < 0  # a dome under suction and weight is compressed
    assert "load case 1 in roof.frd" in revised.remarks[-1]
    with pytest.raises(FileError, match="load cases 1 to 4, not 5"):
        with_results(state, tmp_path / "roof.frd", 0.01, 5)
    # The model states the thickness.
    assert np.array_equal(with_results(state, tmp_path / "roof.frd").forces, revised.forces)
    with pytest.raises(FileError, match=r"roof.inp has a membrane 0.01 thick, not 0.02"):
        with_results(state, tmp_path / "roof.frd", 0.02)
    (tmp_path / "roof.inp").unlink()
    with pytest.raises(FileError, match=r"there is no roof.inp beside roof.frd"):
        with_results(state, tmp_path / "roof.frd")


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
def test_the_forces_of_calculix_depend_on_the_stiffness_of_beams_as_stated(tmp_path):
    state = membrane(solve(read(get("canopy.3dm"))).problem, -1.5)
    F = state.problem.faces
    inner = ~within_rings(F, boundary_mask(len(state.problem.vertices), F), 3)[F].any(axis=1)
    off = []
    for beam in (200.0, 1000.0, 5000.0):
        run_ccx(tmp_path, inp_text(state, Model(beam=beam)))
        found = with_results(state, tmp_path / "roof.frd", 0.01).forces
        off.append(np.median(np.abs(found - state.forces)[inner] / np.abs(state.forces[inner]).max(axis=1)[:, None]))
    assert off[0] > 0.5 and off[0] > 5.0 * off[1] > 25.0 * off[2] and off[2] < 0.02


def test_beams_are_stated_to_be_indeterminate():
    state = state_of(supports=CORNERS, weight=0.0)
    text = " ".join(line.lstrip("* ") for line in inp_text(state, Model(beam=150.0)).splitlines() if line.startswith("**"))
    most = np.linalg.norm(state.edge_loads.load[state.edge_loads.kind > 0], axis=1).max()
    assert "squares of 150 mm along creases and free edges, are elastic" in text and f"up to {most:.4g};" in text
    assert any("statically indeterminate with elastic beams" in remark for remark in state.remarks)
    held = state_of(weight=0.0)
    assert "are elastic" not in inp_text(held) and not any("elastic beams" in remark for remark in held.remarks)


def frd_of(stress, fields=("DISP", "STRESS")):
    """Return a result file of one face, a wedge whose two sides have the given stress and three times that stress."""
    values = {"DISP": [[0.0, 0.0, -0.25]] * 6, "STRESS": [stress] * 3 + [[3.0 * x for x in stress]] * 3}
    lines = ["    1C", "    3C", " -1         1    2    0    1", " -2" + "".join(f"{node:10d}" for node in range(11, 17)), " -3"]
    for field in fields:
        lines.append(f" -4  {field:8s}{len(values[field][0]):5d}    1")
        lines += [f" -1{i:10d}" + "".join(f"{x:12.5E}" for x in row) for i, row in enumerate(values[field], 11)]
        lines.append(" -3")
    return "\n".join([*lines, " 9999", ""])


def test_results_are_read_with_all_components(tmp_path):
    path = tmp_path / "own.frd"
    path.write_text(frd_of([1.0, 2.0, 3.0, -4.0, -5.0, -6.0]))
    (step,) = read_frd(path, 1)
    assert step.displacements[0, 2].tolist() == [0.0, 0.0, -0.25]
    assert step.stresses[0, 0].tolist() == [[2.0, -8.0, -12.0], [-8.0, 4.0, -10.0], [-12.0, -10.0, 6.0]]


@pytest.mark.parametrize(
    ("count", "text", "sentence"),
    [
        (2, frd_of([0.0] * 6), "has no results for element or node 2 of this mesh of 2 faces"),
        (1, frd_of([0.0] * 6, ("DISP",)), "does not hold displacements and stresses"),
        (1, frd_of([0.0] * 6).replace("-2.50000E-01", "-2.5****E-01"), "is damaged"),
    ],
    ids=["other mesh", "no stresses", "damaged"],
)
def test_unusable_results_are_refused(tmp_path, count, text, sentence):
    path = tmp_path / "own.frd"
    path.write_text(text)
    with pytest.raises(FileError, match=sentence):
        read_frd(path, count)
