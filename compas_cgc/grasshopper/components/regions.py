"""Regions: the parts of a mesh as Rhino geometry, one branch per region."""

from __future__ import annotations

from typing import Any
from typing import NamedTuple

import numpy as np

from ...discrete.arrays import FloatArray
from ...discrete.arrays import IntArray
from ...io.rhino.rhinocommon import mesh_from_arrays
from ...io.rhino.rhinocommon import points_to_rhino
from ...io.rhino.rhinocommon import polyline_to_rhino
from ...meshing import boundary_loops
from ..runtime.component_feedback import ask_for
from ..runtime.component_feedback import reports_errors
from ..runtime.progress import Report
from ..runtime.runner import Finished
from ..runtime.runner import Last
from ..runtime.runner import Runner
from ..runtime.trees import tree_of

__all__ = ["RegionsOutputs", "part_of", "regions"]


class RegionsOutputs(NamedTuple):
    """Outputs of the component."""

    regions: Any = None
    creases: Any = None
    edges: Any = None
    supports: Any = None
    targets: Any = None
    by_region: Any = None
    borders: Any = None
    points: Any = None


_RUNNER = Runner(RegionsOutputs(), "splitting")


@reports_errors(RegionsOutputs)
def regions(component: Any, cgc_mesh: Any) -> RegionsOutputs:
    """Split a mesh into regions, creases, open edges and supports."""
    if cgc_mesh is None:
        ask_for(component, "a CGC mesh")
        _RUNNER.reset(component)
        return RegionsOutputs()

    def work(report: Report, last: Last) -> Finished:
        return _split(cgc_mesh)

    return _RUNNER.outputs(component, (cgc_mesh,), work).outputs


def _split(cgc_mesh: Any) -> Finished:
    problem = cgc_mesh.to_problem().without_dummies()
    label = problem.regions()
    parts = [part_of(problem.vertices, problem.faces[label == number]) for number in range(label.max(initial=-1) + 1)]
    meshes = [mesh_from_arrays(*part) for part in parts]
    out = RegionsOutputs(
        meshes,
        [polyline_to_rhino(problem.vertices[path]) for path in problem.crease_paths()],
        [polyline_to_rhino(problem.vertices[[*loop, loop[0]]]) for loop in boundary_loops(problem.faces)],
        points_to_rhino(problem.vertices[problem.supports]),
        problem.region_targets(),
        tree_of([[mesh] for mesh in meshes]),
        tree_of([[polyline_to_rhino(vertices[[*loop, loop[0]]]) for loop in boundary_loops(faces)] for vertices, faces in parts]),
        tree_of([points_to_rhino(vertices) for vertices, _ in parts]),
    )
    return Finished(out, f"{len(parts)} regions")


def part_of(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the vertices (k, 3) of faces of a mesh, and the faces with their new vertex indices."""
    used, local = np.unique(faces, return_inverse=True)
    return vertices[used], local.reshape(-1, 3)
