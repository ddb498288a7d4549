"""Heat conditions on surfaces: fluxes, their derivatives, means over a step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.errors import CaseError
from castx.heat.boundaries import SurfaceFlux
from castx.input.variation import Variation
from castx.tables import Table
from castx.transfer.conditions.registry import heat_conditions
from castx.transfer.radiation import STEFAN_BOLTZMANN
from tests.castx.heat.heat_cases import (
    SERIES,
    advanced,
    balance_under_law,
    cylinder,
    largest,
    problem_under_law,
)
from tests.heat_conditions import surface_heat


def test_radiation_to_the_surroundings(comm):
    """A thin shell that only radiates follows ρcV dT/dt = −εσA (T⁴ − T_a⁴), implicit Euler."""
    mesh = cylinder(comm)
    warming = Table.from_points([[0, 30], [100, 400]])
    radiating = surface_heat("mould/outside", "radiation", emissivity=0.8, ambient=warming)
    heat = problem_under_law(mesh, {"law": "none"}, surfaces=[radiating])
    start = heat.totals()["mould.enthalpy"]
    advanced(heat, mesh, [40.0])
    outside = heat.temperature["mould"].x.array[mesh.bodies["mould"].surface_nodes("outside")]
    spread = max(comm.allgather(float(np.abs(outside - outside.mean()).max(initial=0.0))))
    assert spread < 20.0
    totals = heat.totals()
    area = 2 * np.pi * 0.05 * 0.06
    mean = np.mean(np.concatenate(comm.allgather(outside)))
    ambient = 30.0 + 0.5 * 148.0  # the mean over the step
    flux = 0.8 * STEFAN_BOLTZMANN * ((ambient + 273.15) ** 4 - (mean + 273.15) ** 4)
    assert totals["mould/outside.heat"] == pytest.approx(40.0 * area * flux, rel=0.02)
    assert totals["mould.enthalpy"] - start == pytest.approx(totals["mould/outside.heat"], rel=1e-7)


def test_short_bursts_are_not_missed(comm):
    """Heat that is on for less than a step: a source, a flux and a coolant, all of it counts."""
    burst = Table.from_points([[1, 0], [1.1, 5e6], [1.3, 5e6], [1.4, 0]])
    coolant = Table.from_points([[2, 0], [2.001, 400], [3.001, 400], [3.002, 0]])
    mesh = cylinder(comm)
    surfaces = [
        surface_heat("casting/top", "flux", value=burst),
        surface_heat("mould/outside", "convection", coefficient=coolant, ambient=50.0),
    ]
    heat = problem_under_law(mesh, {"law": "none"}, surfaces=surfaces, source=burst)
    advanced(heat, mesh, [5.0, 5.0])
    totals = heat.totals()
    volume = np.pi * 0.03**2 * 0.06
    assert totals["casting.source"] == pytest.approx(volume * 5e6 * 0.3, rel=1e-9)
    assert totals["casting/top.heat"] == pytest.approx(np.pi * 0.03**2 * 5e6 * 0.3, rel=1e-9)
    cooled = 2 * np.pi * 0.05 * 0.06 * 400.0 * 200.0  # 1 s from 250 to 50 °C
    assert totals["mould/outside.heat"] == pytest.approx(-cooled, rel=0.1)


@pytest.mark.parametrize("of, h", [("film", 57.5), ("surface", 75.0)])
def test_coefficient_over_film_or_surface_temperature(comm, of, h):
    mesh = cylinder(comm)
    table = Table.from_points([[0, 40], [500, 110]])
    coefficient = Variation(table, "temperature", of)
    condition = surface_heat("mould/outside", "convection", coefficient=coefficient, ambient=0.0)
    heat = problem_under_law(mesh, {"law": "none"}, surfaces=[condition])
    advanced(heat, mesh, [1e-4])
    area = 2 * np.pi * 0.05 * 0.06
    assert heat.totals()["mould/outside.power"] == pytest.approx(-area * h * 250.0, rel=1e-4)


@pytest.mark.parametrize("kind", heat_conditions().values(), ids=lambda kind: kind.name)
def test_every_condition_acts_in_a_heat_problem(comm, kind):
    """The power is that of the flux at the temperature of the surface at the end of the step."""
    mesh = cylinder(comm)
    condition = surface_heat("mould/outside", **kind.example())
    heat = problem_under_law(mesh, {"law": "none"}, surfaces=[condition])
    advanced(heat, mesh, [1e-4])
    totals, given = heat.totals(), condition.condition.given
    assert totals["energy_error"] < 1e-7
    if kind.insulates:
        assert "mould/outside.power" not in totals
        return
    outside = heat.temperature["mould"].x.array[mesh.bodies["mould"].surface_nodes("outside")]
    everywhere = np.concatenate(comm.allgather(outside))
    if kind.temperature is not None:
        assert np.abs(everywhere - kind.temperature(given)(0.0)).max() < 1e-9
        return
    flux, _ = kind.flux(given)(0.0, 1e-4, np.array([everywhere.mean()]))
    expected = 2 * np.pi * 0.05 * 0.06 * flux[0]
    assert totals["mould/outside.power"] == pytest.approx(expected, rel=0.01)


def test_nodes_share_a_surface_by_their_areas(comm):
    balance = balance_under_law(cylinder(comm, size=8e-3), SERIES)
    flux = SurfaceFlux(balance.bodies[1], surface_heat("mould/outside", "flux", value=7.0))
    heat, slope = flux.evaluate(0.0, 1.0)
    assert comm.allreduce(heat.sum()) == pytest.approx(7.0 * 2 * np.pi * 0.05 * 0.06)
    assert not slope.any()


@pytest.mark.ranks
def test_a_flux_by_place_and_time(comm):
    """2e4 t (1 + z) into the outside of the mould, by a formula and by a table."""
    mesh = cylinder(comm)
    area = 2 * np.pi * 0.05 * 0.06
    grid = [[z, t, 2e4 * t * (1.0 + z)] for z in (0.0, 0.06) for t in (0.0, 3.0)]
    for value in ({"formula": "2e4*t*(1 + z)"}, {"along": ["z", "t"], "table": grid}):
        heating = surface_heat("mould/outside", "flux", value=value)
        heat = problem_under_law(mesh, {"law": "none"}, surfaces=[heating])
        advanced(heat, mesh, [1.0, 2.0])
        totals = heat.totals()
        assert totals["mould/outside.heat"] == pytest.approx(area * 2e4 * 1.03 * 4.5, rel=1e-9)
        assert totals["energy_error"] < 1e-7


@pytest.mark.ranks
def test_a_temperature_by_place_and_time(comm):
    """Of two surfaces that share an edge the first one counts there."""
    mesh = cylinder(comm)
    held = [
        surface_heat("mould/outside", "temperature", value={"formula": "100 + 1e3*z + 2*t"}),
        surface_heat("mould/top", "temperature", value=300.0),
    ]
    heat = problem_under_law(mesh, {"law": "none"}, surfaces=held)
    advanced(heat, mesh, [1.0, 2.0])
    body = mesh.bodies["mould"]
    nodes = body.surface_nodes("outside")
    found = heat.temperature["mould"].x.array[nodes]
    assert largest(comm, found - (106.0 + 1e3 * body.points[nodes, 1])) < 1e-9
    top = np.setdiff1d(body.surface_nodes("top"), nodes)
    assert largest(comm, heat.temperature["mould"].x.array[top] - 300.0) < 1e-9


@pytest.mark.ranks
@pytest.mark.parametrize(
    "kind, formula, text",
    [
        ("flux", "1/(z - 0.06)", r"the flux is not finite at 1 s, by 1/\(z - 0.06\);"),
        ("temperature", "-1e4*z", "mould/outside: a temperature is none at"),
        ("temperature", "1/z", "mould/outside: a temperature is none at"),
    ],
)
def test_numbers_that_are_none_are_refused_on_all_ranks(comm, kind, formula, text):
    mesh = cylinder(comm)
    wrong = surface_heat("mould/outside", kind, value={"formula": formula})
    with pytest.raises(CaseError, match=text):
        advanced(problem_under_law(mesh, {"law": "none"}, surfaces=[wrong]), mesh, [1.0])


def test_totals_of_a_surface_towards_a_body_have_a_name_of_their_own():
    condition = surface_heat("casting/mould", "flux", value=1.0)
    assert (condition.place, condition.gives_flux) == ("casting/mould", True)
    bare = replace(condition, bare=True)
    assert (bare.name, bare.place) == ("casting/mould", "casting/mould.surface")
    assert surface_heat("casting/top", "temperature", value=20).gives_temperature
