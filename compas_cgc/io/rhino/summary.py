"""What ``compas-cgc check`` says about a .3dm file."""

from __future__ import annotations

import dataclasses

import numpy as np

from ..asked import asked_of
from .model import Model3dm
from .units import unit_suffix

__all__ = ["describe"]


def describe(model: Model3dm) -> tuple[str, list[str]]:
    """Return what was found in a file and what would be done, and the problems that keep it from being solved.

    Parameters
    ----------
    model
        A model read from a file.

    Returns
    -------
    text, problems
        The problems of the file, then those of :meth:`compas_cgc.CGCMesh.check`, of
        which some do not keep it from being solved.
    """
    unit = unit_suffix(model.units)
    mesh = dataclasses.replace(model, problems=()).to_cgcmesh()
    lines = [f"{model.name}: {model.units}, tolerance {model.tolerance:g}{unit}"]
    lines += [f"- {note}" for note in model.notes]
    regions = mesh.regions()
    lines.append(f"{len(regions)} region{'s' if len(regions) > 1 else ''}:")
    for number, (faces, K) in enumerate(zip(regions, asked_of(mesh).region_targets())):
        centre = np.mean([mesh.face_centroid(face) for face in faces], axis=0)
        place = ", ".join(f"{x:.4g}" for x in centre)
        lines.append(f"- region {number} around ({place}): {len(faces)} faces, {'no target' if K is None else f'K = {K:g}'}")
    problems = [*model.problems, *mesh.check()]
    return "\n".join(lines), problems
