"""One body in the heat problem against dense matrices of its cells."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.heat.body import HeatBody, ThermalBody
from castx.tables import Table
from tests.castx.heat.heat_cases import ALLOY, cylinder, material
from tests.partitions import PARTITION, scattered

SOURCE = Table.from_points([[0.0, 0.0], [10.0, 2e6]])


def slab(comm) -> ThermalBody:
    sizes = {"length": 0.04, "width": 0.02, "size": 0.011}
    description = {"model": "plane-strain", "generator": "slab", **sizes}
    mesh = build_mesh(Geometry.model_validate(description), ["casting"], comm)
    body = HeatBody("casting", material(ALLOY), 590.0, SOURCE)
    return ThermalBody(mesh.bodies["casting"], mesh.model, body)


def dense_conduction(body: ThermalBody) -> tuple[np.ndarray, np.ndarray]:
    """Return ∫ ∇φ·∇φ and ∫ φ of linear triangles, node by node."""
    points, cells = body.mesh.points[:, :2], body.mesh.nodes.dofmap.list
    matrix, volumes = np.zeros((len(points), len(points))), np.zeros(len(points))
    for cell in cells:
        corners = np.column_stack((np.ones(3), points[cell]))
        area = 0.5 * abs(np.linalg.det(corners))
        gradients = np.linalg.inv(corners)[1:]
        matrix[np.ix_(cell, cell)] += area * gradients.T @ gradients
        volumes[cell] += area / 3.0
    return matrix, volumes


@pytest.mark.serial
def test_conduction_and_volumes_are_those_of_linear_triangles(comm):
    body = slab(comm)
    matrix, volumes = dense_conduction(body)
    np.testing.assert_allclose(body.volumes, volumes, rtol=1e-12)
    found = body.conduction.toarray()
    np.testing.assert_allclose(found, matrix[:, : len(found)], atol=1e-12)
    T = 560.0 + 2000.0 * body.mesh.points[:, 0]
    body.set_enthalpy(body.curve.enthalpy(T))
    solid, liquid = 180.0, 90.0  # conductivity, linear in the solid fraction from 560 to 620 °C
    knots = np.linspace(0.0, 60.0, 20_001)
    k = solid + (liquid - solid) * knots / 60.0
    potential = np.concatenate(([0.0], np.cumsum(0.5 * (k[1:] + k[:-1]) * np.diff(knots))))
    theta = np.interp(T - 560.0, knots, potential) + liquid * np.maximum(T - 620.0, 0.0)
    np.testing.assert_allclose(body.conducted_heat(), matrix @ theta, rtol=1e-6, atol=1e-6)


@pytest.mark.ranks
def test_cells_of_other_ranks_conduct_too(comm, monkeypatch):
    """Potentials that are linear in x put heat through both ends only, k ΔT/L for each m²."""
    monkeypatch.setattr(PARTITION, scattered)
    body = slab(comm)
    x = body.mesh.points[: body.owned, 0]
    body.set_enthalpy(body.curve.enthalpy(400.0 + 2500.0 * x))  # solid throughout
    heat = body.conducted_heat()
    at_ends = (x < 1e-9) | (x > 0.04 - 1e-9)
    np.testing.assert_allclose(heat[~at_ends], 0.0, atol=1e-8)
    for end in (x < 1e-9, x > 0.04 - 1e-9):
        total = comm.allreduce(float(np.abs(heat[end].sum())))
        assert total == pytest.approx(180.0 * 2500.0 * 0.02)


@pytest.mark.ranks
def test_slope_of_the_conducted_heat_by_differences(comm):
    body = slab(comm)
    T = 565.0 + 900.0 * body.mesh.points[: body.owned, 0]
    direction, step = np.cos(np.arange(body.owned) + comm.rank), 1e-3

    def heat(part):
        body.set_enthalpy(body.curve.enthalpy(T + part * direction))
        return body.conducted_heat()

    rise = (heat(step) - heat(-step)) / (2.0 * step)
    body.set_enthalpy(body.curve.enthalpy(T))
    slope = body.conduction.copy()
    slope.data = body.conduction_slope(np.ones(body.owned))
    # Global numbers go through the owned nodes of rank after rank.
    columns = np.concatenate(comm.allgather(direction))[body.column_nodes]
    np.testing.assert_allclose(slope @ columns, rise, rtol=1e-5, atol=1e-4)


@pytest.mark.ranks
def test_states_stored_heat_and_source(comm):
    body = slab(comm)
    volume = comm.allreduce(body.volumes.sum())
    assert volume == pytest.approx(0.04 * 0.02)
    # 590 °C: half solid, H = ρ c T + ρ L / 2
    enthalpy = 2700.0 * (1100.0 * 590.0 + 0.5 * 390e3)
    assert comm.allreduce(body.stored_heat()) == pytest.approx(volume * enthalpy, rel=1e-9)
    assert body.solid_fraction.x.array == pytest.approx(0.5)
    assert body.source(2.0, 6.0) == pytest.approx(8e5)
    body.set_enthalpy(body.curve.enthalpy(np.full(body.owned, 700.0)))
    assert body.temperature.x.array == pytest.approx(700.0)
    assert not body.solid_fraction.x.array.any()
    slope = body.temperature_slope()
    assert slope == pytest.approx(1.0 / (2700.0 * 1100.0))


def test_nodes_of_a_surface_share_its_area(comm):
    mesh = cylinder(comm, size=8e-3)
    description = HeatBody("casting", material(ALLOY), 20.0)
    body = ThermalBody(mesh.bodies["casting"], mesh.model, description)
    nodes, areas = body.surface_areas("top")
    assert comm.allreduce(areas.sum()) == pytest.approx(np.pi * 0.03**2)
    assert (body.mesh.points[nodes, 1] == pytest.approx(0.06)) or len(nodes) == 0
    assert (nodes < body.owned).all()
