"""Latent heat inside cells: what it stores beside the nodes, and its slopes."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.heat.body import HeatBody, ThermalBody
from tests.castx.heat.heat_cases import ALLOY, material

METAL = material(ALLOY)
LATENT = METAL.density * METAL.latent_heat
SOLIDUS, LIQUIDUS = float(METAL.solidus or 0.0), float(METAL.liquidus or 0.0)
SPAN = LIQUIDUS - SOLIDUS
ACROSS = SOLIDUS - 0.3 * SPAN, LIQUIDUS + 4.0 * SPAN
"""Temperatures of both ends: all metal freezes within the first of four rows of cells."""


def slab(comm, *, inside: bool = True) -> ThermalBody:
    sizes = {"length": 0.04, "width": 0.02, "size": 0.011}
    description = {"model": "plane-strain", "generator": "slab", **sizes}
    mesh = build_mesh(Geometry.model_validate(description), ["casting"], comm)
    body = HeatBody("casting", METAL, LIQUIDUS + 20.0, inside=inside)
    return ThermalBody(mesh.bodies["casting"], mesh.model, body)


def along(body: ThermalBody, cold: float, hot: float) -> np.ndarray:
    """Return the enthalpies of owned nodes whose temperature is linear along the slab [J/m³]."""
    x = body.mesh.points[: body.owned, 0] / 0.04
    return body.curve.enthalpy(cold + (hot - cold) * x)


def stored(comm, body: ThermalBody, enthalpy: np.ndarray) -> float:
    return comm.allreduce(float(body.latent_heat_inside(enthalpy).sum()))


@pytest.mark.ranks
def test_nothing_beside_the_nodes_where_no_metal_freezes(comm):
    body = slab(comm)
    for cold, hot in ((20.0, SOLIDUS - 1.0), (LIQUIDUS + 1.0, LIQUIDUS + 90.0)):
        assert not body.latent_heat_inside(along(body, cold, hot)).any()
    there = along(body, *ACROSS)
    assert np.abs(stored(comm, body, there)) > 1e-3 * LATENT * 0.04 * 0.02
    assert not slab(comm, inside=False).latent_heat_inside(there[: body.owned]).any()


@pytest.mark.ranks
def test_with_the_nodes_it_is_the_latent_heat_of_the_linear_temperature(comm):
    """Against ∫ f_s dx along the slab, of which the temperature is linear."""
    body = slab(comm)
    cold, hot = ACROSS
    enthalpy = along(body, cold, hot)
    body.set_enthalpy(enthalpy)
    at_nodes = comm.allreduce(
        float(body.volumes @ (1.0 - body.solid_fraction.x.array[: body.owned]))
    )
    found = LATENT * at_nodes + stored(comm, body, enthalpy)
    temperatures = np.linspace(cold, hot, 40001)
    liquid = 1.0 - np.interp(temperatures, body.curve.temperatures, body.curve.fractions)
    expected = LATENT * 0.04 * 0.02 * np.trapezoid(liquid, temperatures) / (hot - cold)
    assert found == pytest.approx(expected, rel=2e-3)
    assert LATENT * at_nodes != pytest.approx(expected, rel=5e-3)
    inside = comm.allreduce(body.solid_inside())
    assert LATENT * inside == pytest.approx(-stored(comm, body, enthalpy), rel=1e-12)
    assert slab(comm, inside=False).solid_inside() == 0.0


@pytest.mark.serial
def test_slopes_are_those_of_differences(comm):
    body = slab(comm)
    x = along(body, SOLIDUS - SPAN, LIQUIDUS + 0.5 * SPAN)
    body.set_enthalpy(x)
    data = body.latent_heat_slope(np.ones(body.owned))
    matrix = body.conduction.copy()
    matrix.data = data
    change = 1e-6 * LATENT * np.random.default_rng(1).normal(size=body.owned)
    more, less = (body.latent_heat_inside(x + sign * change) for sign in (1, -1))
    scale = np.abs(data).max() * np.abs(change).max()
    np.testing.assert_allclose(0.5 * (more - less), matrix @ change, atol=1e-4 * scale)
    assert np.abs(more - less).max() > 0.05 * scale
