"""Direction and area of clamped surfaces, and surfaces that have none."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError, MeshError
from castx.mechanics.press_direction import mean_normal, press_direction
from tests.castx.fakes import cylinder_mesh
from tests.castx.mechanics.lone_bodies import slab

AREAS = {"plane-strain": 0.01, "axisymmetric": 2 * np.pi * 0.02 * 0.01, "3d": 1e-4}


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_against_the_normal_of_a_flat_surface(comm, model):
    body = slab(comm, model)
    for surface, axis, sign in (("far", 0, -1.0), ("wall", 0, 1.0)):
        for given in (None, axis):
            direction, area = press_direction(body, model, surface, given)
            np.testing.assert_allclose(direction, sign * np.eye(len(direction))[0], atol=1e-12)
            assert area == pytest.approx(AREAS[model], rel=1e-12)
    direction, _ = press_direction(body, model, "bottom")
    np.testing.assert_allclose(direction, np.eye(len(direction))[1], atol=1e-12)


@pytest.mark.ranks
def test_radial_normals_cancel_over_the_turn(comm):
    """The end of a rod is flat, its mantle faces no direction at all."""
    body = slab(comm, "axisymmetric")
    direction, area = press_direction(body, "axisymmetric", "top")
    np.testing.assert_allclose(direction, [0.0, -1.0], atol=1e-12)
    assert area == pytest.approx(np.pi * 4e-4, rel=1e-12)
    with pytest.raises(CaseError, match="boundary 'casting/far', clamp: the surface is not flat"):
        press_direction(body, "axisymmetric", "far")
    with pytest.raises(CaseError, match=r"'casting/far', clamp\.direction: only 0 of the"):
        press_direction(body, "axisymmetric", "far", 1)


def test_a_curved_surface_needs_an_axis(comm):
    """The outside of a quarter of a cylinder faces x by 2/π of its area."""
    mould = cylinder_mesh(comm, "3d", 8e-3).bodies["mould"]
    with pytest.raises(CaseError, match="state the direction of the machine, such as direction ="):
        press_direction(mould, "3d", "outside")
    direction, area = press_direction(mould, "3d", "outside", 0)
    np.testing.assert_array_equal(direction, [-1.0, 0.0, 0.0])
    assert area == pytest.approx(0.5 * np.pi * 0.03 * 0.04, rel=0.02)
    with pytest.raises(CaseError, match="faces along it"):
        press_direction(mould, "3d", "outside", 2)


@pytest.mark.ranks
def test_mean_normals(comm):
    """Of a flat surface it is that of each facet, of a curved one it is shorter."""
    normal, area = mean_normal(slab(comm), "plane-strain", "far")
    np.testing.assert_allclose(normal, [1.0, 0.0], atol=1e-12)
    assert area == pytest.approx(AREAS["plane-strain"], rel=1e-12)
    mould = cylinder_mesh(comm, "3d", 8e-3).bodies["mould"]
    normal, area = mean_normal(mould, "3d", "outside")
    np.testing.assert_allclose(normal, [2 / np.pi, 2 / np.pi, 0.0], rtol=0.01, atol=1e-12)
    assert area == pytest.approx(0.5 * np.pi * 0.03 * 0.04, rel=0.02)


@pytest.mark.ranks
def test_an_unknown_surface(comm):
    with pytest.raises(MeshError, match="no surface 'behind'"):
        press_direction(slab(comm), "plane-strain", "behind")
