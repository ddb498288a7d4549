"""Directions of mid-sides: those of conditions, at edges that lie in the surface."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.fixed_directions import SurfaceDisplacement, fixed_directions
from castx.mechanics.fixed_midsides import midside_directions
from castx.mechanics.midsides.midsides import Midsides
from tests.castx.mechanics.lone_bodies import slab
from tests.elastic_bodies import everywhere, fixed
from tests.partitions import PARTITION, scattered

pytestmark = pytest.mark.ranks


def directions(comm, model, *conditions):
    body = slab(comm, model)
    midsides = Midsides(body, model)
    found = midside_directions(body, midsides, fixed_directions(body, model, conditions))
    return body, midsides, found


@pytest.mark.parametrize("cut", [None, scattered])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_edges_in_the_surface_are_held_along_the_direction(comm, model, monkeypatch, cut):
    if cut is not None:
        monkeypatch.setattr(PARTITION, cut)
    body, midsides, found = directions(comm, model, fixed("wall", value=1e-3), fixed("far", "y"))
    for condition, axis, place in zip(found, (0, 1), (0.0, 0.02), strict=True):
        ends = body.points[midsides.ends[: midsides.owned_midsides]]
        there = np.flatnonzero((np.abs(ends[:, :, 0] - place) < 1e-9).all(axis=1))
        np.testing.assert_array_equal(condition.nodes, there)
        expected = np.tile(np.eye(body.mesh.geometry.dim)[axis], (len(there), 1))
        np.testing.assert_allclose(np.abs(condition.directions), expected, atol=1e-12)


def test_a_mid_side_has_nothing_beyond_its_ends_whatever_their_motion(comm):
    """Neither where it is prescribed nor where all nodes move equally."""
    given = fixed("wall", value=1e-3), SurfaceDisplacement("far", "normal", None)
    _, _, found = directions(comm, "plane-strain", *given)
    assert [float(condition.value(3.0)) for condition in found] == [0.0, 0.0]
    assert len(everywhere(comm, found[1].nodes)) == 2


def test_the_axis_holds_the_radius_of_its_edges(comm):
    body, midsides, (axis,) = directions(comm, "axisymmetric")
    ends = body.points[midsides.ends[axis.nodes]]
    assert np.abs(ends[:, :, 0]).max(initial=0.0) < 1e-12
    assert len(everywhere(comm, axis.nodes)) == 2
