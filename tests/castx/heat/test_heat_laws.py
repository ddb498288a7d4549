"""Laws of interfaces and surroundings inside the heat problem: Jacobian, balance, mechanisms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.case.heat_transfer import InterfaceHeat
from castx.domain.mesh import build_mesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.heat.body import HeatBody
from castx.heat.interface import HeatExchange
from castx.heat.newton import jacobian, residual
from castx.heat.problem import HeatProblem
from castx.input.variation import Variation
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material
from castx.tables import Table
from castx.transfer.conductance import ConstantConductance
from castx.transfer.pair_state import PairState
from castx.transfer.patched import PatchedLaw
from castx.transfer.radiation import STEFAN_BOLTZMANN
from tests.heat_conditions import surface_heat

ALLOY = {
    "density": 2700.0, "heat_capacity": 1100.0, "conductivity": {"solid": 180.0, "liquid": 90.0},
    "latent_heat": 390e3, "solidus": 560.0, "liquidus": 620.0,
}  # fmt: skip
STEEL = {"density": 7800.0, "heat_capacity": 460.0, "conductivity": 30.0}
FALLING = {"over": "temperature", "table": [[0, 900], [400, 1500], [800, 600]]}
GAS = {"over": "temperature", "table": [[0, 0.025], [1000, 0.07]]}
SERIES = {"law": "series", "closed": {**FALLING, "of": "mean"}, "gas_conductivity": GAS}
SOLID = {"law": "solid-fraction", "closed": {**FALLING, "of": "primary"}, "open": 150}
LAWS = {
    "series": (SERIES, None),
    "radiation": ({"law": "none"}, 0.4),
    "both": (SERIES, 0.4),
    "solid-fraction": (SOLID, 0.4),
}


def material(properties):
    return find_material("m", {"m": MaterialDescription.read(properties)})


def cylinder(comm, size=8e-3):
    arguments = {"radius": 0.03, "height": 0.06, "wall": 0.02, "size": size}
    description = {"model": "axisymmetric", "generator": "cylinder_in_mould", **arguments}
    return build_mesh(Geometry.model_validate(description), ["casting", "mould"], comm)


SURROUNDINGS = (
    surface_heat("mould/outside", "radiation", emissivity=0.8, ambient=30.0),
    surface_heat("mould/outside", "convection", ambient=40.0,
                 coefficient={"over": "temperature", "table": [[0, 10], [500, 80]]}),
    surface_heat("casting/top", "convection", ambient=20.0,
                 coefficient={"over": "temperature", "table": [[0, 10], [900, 80]],
                              "of": "surface"}),
)  # fmt: skip


def problem(mesh, law, radiation=None, surfaces=SURROUNDINGS, **settings) -> HeatProblem:
    pairs = node_pairs(mesh, "casting", "mould")
    grey = None if radiation is None else np.full(len(pairs.areas), radiation)
    law = InterfaceHeat.read(law).conduction_law() if isinstance(law, dict) else law
    exchange = HeatExchange("casting/mould", pairs, "law", law, grey)
    bodies = [
        HeatBody("casting", material(ALLOY), 640.0, Table.constant(2e5)),
        HeatBody("mould", material(STEEL), 250.0),
    ]
    return HeatProblem(mesh, bodies, [exchange], surfaces, **settings)


def open_pairs(mesh, lowest=0.0, highest=2e-4) -> tuple[PairState, PairState]:
    """Return pairs that open over a step, higher ones more."""
    height = node_pairs(mesh, "casting", "mould").points[:, 1] / 0.06
    start = PairState.of(0.2 * lowest * height, np.zeros(len(height)))
    return start, PairState.of(lowest + (highest - lowest) * height, np.zeros(len(height)))


def advanced(heat, mesh, steps, pairs=None, substeps=1):
    time = 0.0
    for step in steps:
        report = heat.advance(time, step, [pairs or open_pairs(mesh)], substeps)
        heat.commit()
        time += step
    return report


@pytest.mark.parametrize("name", LAWS)
def test_jacobian_is_the_derivative_of_the_residual(comm, name):
    """With the columns of U and V where the solid fraction of the casting acts on every pair."""
    mesh = cylinder(comm)
    heat = problem(mesh, *LAWS[name])
    advanced(heat, mesh, [1.0, 1.0])
    system = heat._system
    system.exchanges.set_states([open_pairs(mesh)], 0.7)
    start = system.begin(system.enthalpy(), system.enthalpy(), 3.0, 1.0)
    x, product, plus, minus, direction = (system.residual.duplicate() for _ in range(5))
    x.array[:] = start
    direction.array[:] = 1e3 * np.cos(np.arange(len(start)) + comm.rank)
    x.axpy(1e3, direction)
    jacobian(system, None, x, None, None)
    system.jacobian.matrix.mult(direction, product)
    columns = system.solid_columns(x)
    assert len(columns) == (name == "solid-fraction")
    for u, v in columns:
        assert abs(v.dot(direction)) > 0.0 < u.norm()
        product.axpy(v.dot(direction), u)
    for sign, result in ((1.0, plus), (-1.0, minus)):
        moved = x.copy()
        moved.axpy(sign, direction)
        residual(system, None, moved, result)
    plus.axpy(-1.0, minus)
    plus.scale(0.5)
    assert product.norm() > 0.0
    plus.axpy(-1.0, product)
    assert plus.norm() < 1e-5 * product.norm()


@pytest.mark.parametrize("name", LAWS)
def test_newton_stays_fast_at_large_steps(comm, name):
    mesh = cylinder(comm)
    heat = problem(mesh, *LAWS[name])
    assert advanced(heat, mesh, [60.0, 60.0]).iterations <= 8
    assert heat.totals()["energy_error"] < 1e-9


def test_without_the_columns_the_solid_fraction_slows_newton(comm, monkeypatch):
    """What the correction of the step is for."""
    mesh = cylinder(comm)
    full = advanced(problem(mesh, *LAWS["solid-fraction"]), mesh, [20.0]).iterations
    monkeypatch.setattr("castx.heat.newton.couple_step", lambda columns, y, solver: None)
    assert advanced(problem(mesh, *LAWS["solid-fraction"]), mesh, [20.0]).iterations > full + 2


@pytest.mark.parametrize("name", LAWS)
def test_heat_is_booked_by_mechanism_and_never_lost(comm, name):
    """Lost by one side, gained by the other to 1e-10; parts and powers add up."""
    mesh = cylinder(comm)
    heat = problem(mesh, *LAWS[name])
    before = heat.totals()
    steps = [0.5, 2.0, 5.0]
    energy = dict.fromkeys(before, 0.0)
    time = 0.0
    for step in steps:
        heat.advance(time, step, [open_pairs(mesh)], 2)
        heat.commit()
        time += step
        energy = {key: energy[key] + step * value for key, value in heat.totals().items()}
    totals = heat.totals()
    interface, outside = "casting/mould.heat", "mould/outside.heat"
    parts = {way: totals[f"{interface}.{way}"] for way in ("contact", "gas", "radiation")}
    assert totals[interface] == pytest.approx(sum(parts.values()), rel=1e-12)
    has = {way for way, value in parts.items() if value > 0.0}
    assert has == {
        "series": {"contact", "gas"}, "radiation": {"radiation"},
        "both": {"contact", "gas", "radiation"},
        "solid-fraction": {"contact", "gas", "radiation"},
    }[name]  # fmt: skip
    ways = [totals[f"{outside}.{way}"] for way in ("convection", "radiation")]
    assert max(ways) < 0.0
    assert totals[outside] == pytest.approx(sum(ways), rel=1e-12)
    assert "casting/top.heat.convection" not in totals  # the only one there
    for key in totals:
        if "heat" in key:
            power = key.replace(".heat_in", ".power").replace(".heat", ".power")
            assert energy[power] == pytest.approx(totals[key], rel=1e-9, abs=1e-9), key
    casting = totals["casting.source"] + totals["casting/top.heat"] - totals[interface]
    assert totals["casting.enthalpy"] - before["casting.enthalpy"] == pytest.approx(
        casting, rel=1e-7
    )
    assert totals["mould.heat_in"] == pytest.approx(totals[interface] + totals[outside], rel=1e-10)
    assert totals["energy_error"] < 1e-9


def test_steady_flux_through_gap_and_radiation_is_that_of_the_formula(comm):
    """The sum of h(T) (T₁ − T₂) + φσ(T₁⁴ − T₂⁴) over the pairs, against the ledger's power."""
    mesh = cylinder(comm)
    law = {"law": "limited", "closed": FALLING, "gas_conductivity": 0.04}
    heat = problem(mesh, law, 0.4)
    pairs = open_pairs(mesh, highest=4e-4)
    advanced(heat, mesh, [2.0, 2.0], pairs)
    facing = node_pairs(mesh, "casting", "mould")
    exchange = heat._system.exchanges.under_law[0]
    hot, cold = exchange._faces.secondary.value, exchange._faces.primary.value
    gap = pairs[1].gap
    closed = np.interp(hot, [0, 400, 800], [900, 1500, 600])
    h = np.minimum(closed, 0.04 / np.maximum(gap, 1e-12))
    radiated = 0.4 * STEFAN_BOLTZMANN * ((hot + 273.15) ** 4 - (cold + 273.15) ** 4)
    for way, flux in (("gas", h * (hot - cold) * (gap > 0)), ("radiation", radiated)):
        expected = comm.allreduce(float(facing.areas @ flux))
        assert heat.totals()[f"casting/mould.power.{way}"] == pytest.approx(expected, rel=1e-9)
    assert exchange.coefficient(pairs[1]) == pytest.approx(h)


def test_a_factor_multiplies_the_resistance_at_the_end_of_a_step(comm):
    mesh = cylinder(comm)
    end = open_pairs(mesh)[1]
    both = [problem(mesh, ConstantConductance(h), surfaces=()) for h in (800.0, 200.0)]
    quarter = [np.full(len(end.gap), 0.25)]
    for heat, factors in zip(both, (None, quarter), strict=True):
        heat.advance(0.0, 3.0, [(end, end)], factors=factors)
        heat.commit()
    one, other = (heat.totals()["casting/mould.heat"] for heat in both)
    assert one == pytest.approx(other, rel=1e-9)


def test_coefficients_at_the_present_temperatures(comm):
    mesh = cylinder(comm)
    heat = problem(mesh, {"law": "constant", "closed": FALLING})
    state = open_pairs(mesh)[1]
    assert heat.coefficients([state])[0] == pytest.approx(960.0)  # 640 °C
    advanced(heat, mesh, [5.0])
    nodes = node_pairs(mesh, "casting", "mould").secondary_local
    faces = heat.temperature["casting"].x.array[nodes]
    expected = np.interp(faces, [0, 400, 800], [900, 1500, 600])
    assert heat.coefficients([state])[0] == pytest.approx(expected)


def test_parts_of_an_interface_have_their_own_laws(comm):
    mesh = cylinder(comm)
    pairs = node_pairs(mesh, "casting", "mould")
    upper = pairs.points[:, 1] > 0.03
    parts = [np.flatnonzero(~upper), np.flatnonzero(upper)]
    laws = [ConstantConductance(500.0), InterfaceHeat.read(SOLID).conduction_law()]
    heat = problem(mesh, PatchedLaw(list(zip(parts, laws, strict=True))))
    assert heat._system.exchanges.feedback.exchanges
    state = open_pairs(mesh)[1]
    found = heat.coefficients([state])[0]
    assert found[~upper] == pytest.approx(500.0)
    closed = 900.0 + 600.0 * 250.0 / 400.0  # the mould is at 250 °C, nothing is solid
    assert found[upper] == pytest.approx(closed)


@pytest.mark.parametrize("linear", ["direct", "iterative"])
def test_linear_solvers_agree_where_a_whole_body_is_felt(comm, linear):
    mesh = cylinder(comm)
    heat, reference = problem(mesh, SOLID, linear=linear), problem(mesh, SOLID)
    advanced(heat, mesh, [2.0, 10.0])
    advanced(reference, mesh, [2.0, 10.0])
    heats = [h.totals()["casting/mould.heat"] for h in (heat, reference)]
    assert heats[0] == pytest.approx(heats[1], rel=1e-7)


def test_radiation_to_the_surroundings(comm):
    """A thin shell that only radiates follows ρcV dT/dt = −εσA (T⁴ − T_a⁴), implicit Euler."""
    mesh = cylinder(comm)
    warming = Table.from_points([[0, 30], [100, 400]])
    radiating = surface_heat("mould/outside", "radiation", emissivity=0.8, ambient=warming)
    heat = problem(mesh, {"law": "none"}, surfaces=[radiating])
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
    heat = problem(mesh, {"law": "none"}, surfaces=surfaces)
    heat._system.bodies[0].description = replace(
        heat._system.bodies[0].description, heat_source=burst
    )
    advanced(heat, mesh, [5.0, 5.0])
    totals = heat.totals()
    volume = comm.allreduce(float(heat._system.bodies[0].volumes.sum()))
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
    heat = problem(mesh, {"law": "none"}, surfaces=[condition])
    advanced(heat, mesh, [1e-4])
    area = 2 * np.pi * 0.05 * 0.06
    assert heat.totals()["mould/outside.power"] == pytest.approx(-area * h * 250.0, rel=1e-4)
