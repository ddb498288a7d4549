"""A ring cast round a core: shape of its cells, bore, sections, refusals."""

import numpy as np
import pytest

from castx.meshes.generators.core_in_ring import core_in_ring
from tests.meshes.gmsh_meshes import BOTH, edges, generated, refused, scaled_jacobians

pytestmark = pytest.mark.serial

BODIES = ["core", "casting"]
RING = {"core_radius": 0.03, "core_bore": 0.01, "outer_radius": 0.06}


def surface_points(mesh, name):
    faces = mesh.faces[mesh.face_surfaces == mesh.surface_names.index(name)]
    return mesh.points[np.unique(faces)]


@BOTH
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_bore_and_outside_are_round(model, cells):
    mesh = generated(core_in_ring, BODIES, model=model, height=0.01, size=0.01, cells=cells, **RING)
    for name, radius in (("bore", 0.01), ("outside", 0.06)):
        points = surface_points(mesh, name)
        np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), radius, rtol=1e-9)


@BOTH
def test_the_section_of_an_axisymmetric_ring_begins_at_its_bore(cells):
    arguments = {**RING, "model": "axisymmetric", "height": 0.02, "size": 0.01, "cells": cells}
    mesh = generated(core_in_ring, BODIES, **arguments)
    assert mesh.points[:, 0].min() == 0.01 and mesh.points[:, 0].max() == pytest.approx(0.06)
    middle = mesh.points[mesh.cells].mean(axis=1)
    assert np.array_equal(mesh.bodies, (middle[:, 0] > 0.03).astype(int))
    assert "bore" in mesh.surface_names
    assert np.diff(np.unique(mesh.points[:, 0])).max() <= 0.01 * 1.001
    solid = generated(core_in_ring, BODIES, **{**arguments, "core_bore": 0.0})
    assert solid.points[:, 0].min() == 0.0 and "bore" not in solid.surface_names


def test_plane_models_mesh_a_quarter_whatever_the_sector():
    mesh = generated(core_in_ring, BODIES, model="plane-stress", size=0.01, sector="full", **RING)
    assert mesh.points.min() == 0.0
    assert not {"base", "top"} & set(mesh.surface_names)


@pytest.mark.parametrize("sizes", [{}, {"interface_size": 0.002}, {"size": 0.1}])
@pytest.mark.parametrize("bore", [0.0, 0.01])
def test_quadrilaterals_of_round_plans_are_nearly_squares(sizes, bore):
    arguments = {"core_radius": 0.03, "core_bore": bore, "outer_radius": 0.05, "size": 0.004}
    mesh = generated(
        core_in_ring, ["core", "casting"], model="plane-strain", cells="quadrilaterals",
        **arguments | sizes,
    )  # fmt: skip
    assert scaled_jacobians(mesh).min() > 0.8
    if not sizes and not bore:
        assert (edges(mesh).max(axis=0) / edges(mesh).min(axis=0)).max() < 2.2
        assert edges(mesh).max() < 0.004 * 0.05 / 0.03 * 1.001


@pytest.mark.parametrize(
    "arguments, text",
    [
        (
            {"model": "plane-stress", "core_bore": 0.2, "core_radius": 0.1},
            "need 0 <= core_bore < core_radius < outer_radius, got 0.2, 0.1, 0.3 m",
        ),
        ({"model": "3d"}, "needs a height"),
        ({"model": "axisymmetric", "height": 0.0}, "height must be positive"),
    ],
)
def test_impossible_geometries_are_refused(arguments, text):
    refused(core_in_ring, text, **{"core_radius": 0.1, "outer_radius": 0.3, **arguments})
