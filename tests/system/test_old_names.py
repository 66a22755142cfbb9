"""Old names: what scripts and saved canvases import goes on working, with a warning that names the new one."""

from __future__ import annotations

import importlib
import subprocess
import sys
import warnings

import pytest

from compas_cgc._renamed import RENAMED

OLD = sorted(RENAMED)


@pytest.mark.parametrize("old", OLD)
def test_an_old_name_is_the_new_module(old):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        module = importlib.import_module(old)
    assert module is importlib.import_module(RENAMED[old])
    assert module.__spec__.name == module.__name__ == RENAMED[old]


def test_modules_of_renamed_packages_are_loaded_once_and_warned_about():
    code = (
        "import warnings; warnings.simplefilter('always')\n"
        "with warnings.catch_warnings(record=True) as said:\n"
        "    from compas_cgc.projection.settings import ProjectionSettings\n"
        "import compas_cgc\n"
        "assert ProjectionSettings is compas_cgc.ProjectionSettings\n"
        "print('\\n'.join(str(warning.message) for warning in said if warning.category is DeprecationWarning))"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "compas_cgc.projection.settings is now compas_cgc.solvers.projection.settings" in out.stdout


def test_the_flow_keeps_its_short_name_without_a_warning():
    code = "import compas_cgc; from compas_cgc.flow import curve_flow, flow, FlowSettings; print(flow.__module__)"
    out = subprocess.run([sys.executable, "-W", "error::DeprecationWarning", "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "compas_cgc.solvers.flow.gradient_flow"


def test_old_functions_ask_the_new_ones():
    import compas_cgc
    from compas_cgc import CGCProblem

    from ..support import shapes

    vertices, faces = shapes.grid(5)
    problem = CGCProblem(vertices, faces)
    from compas_cgc import _deprecated as posing

    with pytest.warns(DeprecationWarning, match="with_supports"):
        held = posing.set_supports(problem, "boundary")
    with pytest.warns(DeprecationWarning, match="with_targets"):
        asked = posing.set_target(held, 0.01)
    with pytest.warns(DeprecationWarning, match="is now compas_cgc.solve"):
        solution = compas_cgc.solve_problem(asked, "newton")
    assert solution.status == "converged"
    with pytest.warns(DeprecationWarning, match="compas_cgc.Fixed"):
        from compas_cgc.solvers.projection import Held
    assert Held is compas_cgc.Fixed
