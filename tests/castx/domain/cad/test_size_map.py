"""Sizes over space are read as they were written, or refused with what is needed."""

from __future__ import annotations

import meshio
import numpy as np
import pytest

from castx.domain.cad.size_map import read_size_map, write_size_map
from castx.errors import MeshError

pytestmark = pytest.mark.serial

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=np.float64)
CELLS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
SIZES = np.array([0.1, 0.2, 0.3, 0.4, 0.5])


def test_sizes_are_those_that_were_written_over_the_refinement(tmp_path):
    file = tmp_path / "sizes.vtu"
    write_size_map(file, POINTS, CELLS, SIZES)
    found = read_size_map(file, 2.0)
    np.testing.assert_allclose(found.corners, POINTS[CELLS], rtol=1e-12)
    np.testing.assert_allclose(found.sizes, SIZES[CELLS] / 2.0, rtol=1e-12)


@pytest.mark.parametrize("wrong", ["missing", "broken", "without sizes", "triangles", "negative"])
def test_other_files_are_refused(tmp_path, wrong):
    file = tmp_path / "sizes.vtu"
    if wrong == "broken":
        file.write_text("sizes")
    elif wrong == "without sizes":
        meshio.Mesh(POINTS, [("tetra", CELLS)]).write(file)
    elif wrong == "triangles":
        meshio.Mesh(POINTS, [("triangle", CELLS[:, :3])], point_data={"size": SIZES}).write(file)
    elif wrong == "negative":
        write_size_map(file, POINTS, CELLS, -SIZES)
    needed = {"missing": "no such file", "broken": "meshio says", "negative": "one positive length"}
    with pytest.raises(MeshError, match=needed.get(wrong, "tetrahedra with the values 'size'")):
        read_size_map(file, 1.0)
