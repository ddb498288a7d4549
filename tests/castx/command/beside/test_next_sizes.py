"""Sizes of the next mesh follow the errors of all bodies, in the energy that they stand for."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from castx.case.reading.adapted import error_fields, with_fields
from castx.case.reading.read import load_case
from castx.command.beside.next_sizes import write_next_sizes
from castx.command.run import RunSettings, run_case, with_output
from castx.domain.cad.size_map import read_size_map
from castx.meshes.cad.curvature import FILLING
from castx.results.reading import Results
from tests.castx.command.beside.two_blocks import two_blocks_case

pytestmark = pytest.mark.serial


def test_sizes_are_small_where_errors_are_large(comm, tmp_path):
    case = load_case(two_blocks_case(comm, tmp_path), ())
    case = with_output(with_fields(case, ["temperature", *error_fields(case)]), tmp_path / "out")
    run_case(case, RunSettings(comm))
    write_next_sizes(case, tmp_path / "sizes.vtu")
    found = read_size_map(tmp_path / "sizes.vtu", 1.0)
    places = found.corners.reshape(-1, 3)
    sizes = np.column_stack([places, found.sizes.reshape(-1)])
    nodes = sum(body["nodes"] for body in Results(tmp_path / "out").record["bodies"].values())
    assert len(np.unique(sizes, axis=0)) == len(np.unique(places, axis=0)) < nodes, (
        "bodies have one size where they touch"
    )
    lookup = cKDTree(found.corners.mean(axis=1))
    for body, conductivity in (("casting", 237.0), ("die", 25.0)):
        error = Results(tmp_path / "out").field("heat_flux_error", body)
        corners = error.points[error.cells]
        volumes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6.0
        new = found.sizes[lookup.query(corners.mean(axis=1))[1]].mean(axis=1)
        ratio = new / (volumes / FILLING) ** (1 / 3)
        square = volumes * error.values**2 / conductivity
        worst, least = square > np.quantile(square, 0.9), square < np.quantile(square, 0.1)
        assert ratio[worst].mean() < 0.85 * ratio[least].mean(), body
