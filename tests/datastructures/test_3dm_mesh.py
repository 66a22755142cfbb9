"""CGCMesh.from_3dm and to_3dm."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from compas_cgc import CGCMesh


def test_a_mesh_comes_back_from_a_rhino_file_bit_for_bit(tmp_path):
    mesh = CGCMesh.from_3dm(Path(__file__).parents[2] / "examples" / "nine_regions.3dm")
    mesh.set_target(0.01)
    mesh.set_target(0.04, region=4)
    mesh.vertex_attribute(17, "z", 1 / 3)
    for version in (7, 8):
        mesh.to_3dm(tmp_path / "roof.3dm", version=version)
        back = CGCMesh.from_3dm(tmp_path / "roof.3dm")
        assert all(np.array_equal(a, b) for a, b in zip(back.arrays(), mesh.arrays()))
        assert back.supports() == mesh.supports() and back.creases() == mesh.creases()
        assert [back.region_target(r) for r in range(9)] == [mesh.region_target(r) for r in range(9)]
        assert back.attributes["units"] == "Meters"
