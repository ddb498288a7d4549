"""Latent heat inside cells: what it stores beside the nodes, and its slopes."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.heat.body import HeatBody, ThermalBody
from castx.heat.latent_heat import kinks
from castx.materials.material import Material
from tests.castx.heat.heat_cases import ALLOY, material
from tests.partitions import PARTITION, on_the_last

METAL = material(ALLOY)
LATENT = METAL.density * METAL.latent_heat
SOLIDUS, LIQUIDUS = float(METAL.solidus or 0.0), float(METAL.liquidus or 0.0)
SPAN = LIQUIDUS - SOLIDUS
ACROSS = SOLIDUS - 0.3 * SPAN, LIQUIDUS + 4.0 * SPAN
"""Temperatures of both ends: all metal freezes within the first of four rows of cells."""


def slab(comm, *, inside: bool = True, metal: Material = METAL) -> ThermalBody:
    sizes = {"length": 0.04, "width": 0.02, "size": 0.011}
    description = {"model": "plane-strain", "generator": "slab", **sizes}
    mesh = build_mesh(Geometry.model_validate(description), ["casting"], comm)
    body = HeatBody("casting", metal, LIQUIDUS + 20.0, inside=inside)
    return ThermalBody(mesh.bodies["casting"], mesh.model, body)


def bent_metal(fractions: list[list[float]]) -> Material:
    """Return the alloy with a table of its solid fraction, and a heat capacity that varies."""
    rest = {name: ALLOY[name] for name in ALLOY if name not in ("solidus", "liquidus")}
    capacity = {"solid": [[0, 900], [570, 1300]], "liquid": 1200}
    return material(rest | {"solid_fraction": fractions, "heat_capacity": capacity})


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
def test_nothing_beside_the_nodes_where_the_fraction_is_linear(comm):
    """Mush from end to end, of a fraction that bends in the middle alone."""
    body = slab(comm, metal=bent_metal([[560, 1.0], [585, 0.3], [620, 0.0]]))
    for cold, hot in ((561.0, 584.0), (586.0, 619.0)):
        body.set_enthalpy(along(body, cold, hot))
        assert not body.present_latent_heat_inside().any()
        assert not body.latent_heat_slope(np.ones(body.owned)).any()
    assert np.abs(stored(comm, body, along(body, 561.0, 619.0))) > 1e-4 * LATENT * 0.04 * 0.02


@pytest.mark.serial
def test_kinks_are_the_knots_at_which_the_fraction_bends():
    bends = [[560, 1.0], [580, 0.5], [600, 0.25], [610, 0.125], [620, 0.0]]
    curve = bent_metal(bends).enthalpy
    at, fractions = kinks(curve)
    np.testing.assert_allclose(at, [560, 580, 620], rtol=1e-15)
    np.testing.assert_allclose(fractions, [1.0, 0.5, 0.0], atol=1e-15)
    assert len(curve.temperatures) > 2 * len(at)


@pytest.mark.ranks
def test_what_is_known_of_a_state_is_found_once(comm, monkeypatch):
    """Ranks without a cell know all states of theirs; what the last one does not is found anew."""
    monkeypatch.setattr(PARTITION, on_the_last)
    body = slab(comm)
    assert body._inside is not None
    found = []
    find = body._inside.found
    monkeypatch.setattr(body._inside, "found", lambda *state: found.append(state) or find(*state))
    first, second = along(body, *ACROSS), along(body, ACROSS[0], ACROSS[1] - 9.0)
    before, other = body.latent_heat_inside(first), body.latent_heat_inside(second)
    assert len(found) == 2 and (comm.allreduce(np.abs(before - other).max(initial=0.0))) > 0.0
    np.testing.assert_array_equal(body.latent_heat_inside(first), before)
    assert len(found) == 2
    changed = first + 1e-3 * LATENT
    after = body.latent_heat_inside(changed)
    assert len(found) == 3
    fresh = slab(comm)
    np.testing.assert_array_equal(after, fresh.latent_heat_inside(changed))
    body.set_enthalpy(changed)
    np.testing.assert_array_equal(body.present_latent_heat_inside(), after)


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
