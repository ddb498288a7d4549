"""Places of points: found on exactly one rank, with weights that interpolate exactly."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from castx.domain.cell_kinds import KINDS
from castx.results.locate import interpolation_weights, place_in_body, place_on_surface
from tests.castx.fakes import cylinder_mesh
from tests.partitions import PARTITION, scattered


@given(st.data())
@pytest.mark.parametrize("kind", KINDS)
def test_weights_are_those_of_the_place_in_a_skewed_cell(kind, data):
    cell = KINDS[kind]
    moves = st.lists(st.floats(-0.2, 0.2), min_size=3 * cell.corners, max_size=3 * cell.corners)
    corners = np.zeros((cell.corners, 3))
    corners[:, : cell.dimension] = cell.reference
    # Facets lie anywhere in space; cells move inside theirs.
    width = cell.dimension if cell.dimension > 1 else 3
    corners[:, :width] += np.array(data.draw(moves)).reshape(-1, 3)[:, :width]
    place = np.array(data.draw(st.lists(st.floats(0.0, 1.0), min_size=3, max_size=3)))
    place = place[: cell.dimension] / (max(place.sum(), 1.0) if cell.simplex else 1.0)
    weights = cell.shape_functions(place[None])[0][0]
    found = interpolation_weights(cell, 1e-3 * corners + 0.5, 1e-3 * weights @ corners + 0.5)
    assert found == pytest.approx(weights, abs=1e-10)


def linear(points: np.ndarray) -> np.ndarray:
    return 3.0 + points @ np.array([100.0, -200.0])


def value_at(comm, body, place) -> float:
    """Return a linear field at a place, which exactly one rank has."""
    assert comm.allreduce(int(place.owned)) == 1
    assert place.owned == (place.entity >= 0) == (len(place.nodes) > 0)
    return comm.allreduce(float(place.interpolate(linear(body.points))))


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("point", [(0.0071, 0.0133), (0.0, 0.0), (0.02, 0.04), (0.01, 0.02)])
def test_a_point_inside_is_its_own_place(comm, cells, point):
    body = cylinder_mesh(comm, cells=cells).bodies["casting"]
    place = place_in_body(body, point)
    assert place.distance == pytest.approx(0.0, abs=1e-12)
    assert 0.0 < place.size < 8e-3
    assert value_at(comm, body, place) == pytest.approx(linear(np.array(point)), abs=1e-10)


@pytest.mark.ranks
def test_a_point_that_several_ranks_have_is_on_one(comm, monkeypatch):
    """Neighbouring cells on different ranks share all of their nodes."""
    monkeypatch.setattr(PARTITION, scattered)
    body = cylinder_mesh(comm, size=1e-2).bodies["casting"]
    for point in ((0.01, 0.01), (0.01, 0.02), (0.01, 0.03)):
        found = value_at(comm, body, place_in_body(body, point))
        assert found == pytest.approx(linear(np.array(point)), abs=1e-9)


@pytest.mark.ranks
def test_a_point_outside_has_the_nearest_place_on_the_surface(comm):
    body = cylinder_mesh(comm).bodies["casting"]
    place = place_in_body(body, (0.023, 0.0131))
    assert place.distance == pytest.approx(0.003, rel=1e-9)
    assert value_at(comm, body, place) == pytest.approx(linear(np.array([0.02, 0.0131])), abs=1e-9)


@pytest.mark.ranks
def test_a_place_on_a_surface_is_on_that_surface(comm):
    """The axis is nearer to the point than the wall, but not part of the surface."""
    body = cylinder_mesh(comm).bodies["casting"]
    place = place_on_surface(body, "mould", (0.001, 0.0131))
    assert place.distance == pytest.approx(0.019, rel=1e-9)
    assert value_at(comm, body, place) == pytest.approx(linear(np.array([0.02, 0.0131])), abs=1e-9)


@pytest.mark.ranks
@pytest.mark.parametrize("away", [1e4, 1e30, 1e300])
def test_a_point_very_far_away_is_far_away(comm, away):
    body = cylinder_mesh(comm, size=1e-2).bodies["casting"]
    place = place_in_body(body, (away, 0.0))
    assert place.distance == pytest.approx(away, rel=1e-4) or place.distance == np.inf
    assert comm.allreduce(int(place.owned)) == 1
