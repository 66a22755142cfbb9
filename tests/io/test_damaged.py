"""Damaged files, one of each kind that once ended a reader with a traceback, ran code, or took seconds or gigabytes."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import pytest

from compas_cgc.errors import CGCError
from compas_cgc.io import read_problem
from compas_cgc.io.summary import describe
from compas_cgc.rationalisation import read_design

from ..support.mutated_files import FOREIGN
from ..support.mutated_files import processor_seconds

FOLDER = Path(__file__).parent / "damaged"
DRAWINGS = {
    "coordinate.obj": "vertex 35 has a coordinate that is not finite",
    "coordinate.ply": "vertex 44 has a coordinate that is not finite",
    "dimension.3dm": "is damaged; open it in Rhino",  # 900 million coordinates for each point of a curve
    "element_count.ply": "declares 99999999999 elements",
    "extent.3dm": "divide it more than 2000 times",  # control points at 3e12
    "foreign_type.json": "it holds X and no mesh",
    "missing_z.json": "'z' is missing",
    "no_faces.3dm": "has no faces; delete it",
    "targets_without_vertices.3dm": None,  # a mesh on another layer
}
DESIGNS = {
    "dimension.3dm": "is damaged; open it in Rhino",
    "no_faces.3dm": "has no faces; delete it",
    "no_faces.step": "the design has no faces",
    "targets_without_vertices.3dm": "faces with vertices that do not exist",
}


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_damaged_drawing_is_refused_with_a_sentence_at_once(name):
    edge_length = {"edge_length": 0.8} if name.endswith(".3dm") else {}
    refused(lambda path: describe(read_problem(path, **edge_length)), name, DRAWINGS[name])


@pytest.mark.parametrize("name", DESIGNS)
def test_a_damaged_design_is_refused_with_a_sentence_at_once(name):
    if name.endswith(".step"):
        pytest.importorskip("compas_occt")
    refused(read_design, name, DESIGNS[name])


def test_every_file_is_read():
    assert {path.name for path in FOLDER.iterdir()} == {*DRAWINGS, *DESIGNS}


def refused(read, name, sentence):
    """Check that a file is refused with a sentence, or read if there is none, within two seconds of processor time."""
    for _ in range(2):  # the first reading compiles the kernels that it needs
        started = processor_seconds()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            if sentence is None:
                read(FOLDER / name)
            else:
                with pytest.raises(CGCError, match=sentence) as found:
                    read(FOLDER / name)
                assert "\n" not in str(found.value)
    assert processor_seconds() - started < 2.0 and FOREIGN not in sys.modules
