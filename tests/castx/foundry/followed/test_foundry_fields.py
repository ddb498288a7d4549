"""Fields of the foundry of a temperature field that travels, and of a run that goes on again."""

from pathlib import Path

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.output import FrontPlace
from castx.case.reading.read import read_case
from castx.command.run import run
from castx.foundry.alloy import Alloy
from castx.foundry.followed.foundry_fields import (
    FoundryFields,
    Poured,
    chvorinov_constant,
    followed_by,
    is_of_foundry,
    written_names,
)
from castx.foundry.front.gradients import Steepness
from castx.foundry.front.solidification import BodySolidification, Followed, Solidification
from castx.foundry.mush import FreezingPath
from castx.foundry.porosity import CriticalLiquid
from castx.input.toml_text import parse_toml
from castx.materials.solid_fraction import LinearLaw
from castx.results.reading import Results
from tests.castx.fakes import FakeSnapshot, slab_mesh
from tests.castx.foundry.front.means import control_volume_means
from tests.castx.foundry.front.test_solidification import Curve, extremes
from tests.castx.materials.descriptions import alloy

GRADIENT, SPEED, GROWTH = 2000.0, 1e-3, 0.02
RANGES = (0.4, 0.9, 0.99)
POURED, STEP, STEPS = 11.0, 0.2, 125
KEYS = {
    "solidus": 560.0, "liquidus": 615.0, "melt_viscosity": 1.2e-3, "cavitation": 5e4,
    "arm_spacing": {"coefficient": 4e-5}, "solidification_shrinkage": 0.05,
    "strength": {"base": 6e7, "slope": 1e5},
}  # fmt: skip


def temperature(x, time):
    """Return T = 640 + G x - G v (t + t²/2 GROWTH): the fronts go faster and faster."""
    return 640.0 + GRADIENT * (x - SPEED * (time + 0.5 * GROWTH * time**2))


def passing(x, fraction):
    """Return when a solid fraction passes, from the root of a square."""
    way = x + (640.0 - 615.0 + 55.0 * fraction) / GRADIENT
    return (np.sqrt(1.0 + 2.0 * GROWTH * way / SPEED) - 1.0) / GROWTH


def state(mesh, time, step):
    body = mesh.bodies["casting"]
    means = control_volume_means(body, lambda x: Curve().enthalpy(temperature(x[:, 0], time)))
    return FakeSnapshot(time, step, mesh, formulas={"enthalpy": lambda x: means})


def solidified(comm, followed):
    """Follow the field past all nodes, from 11 s on; return x and the fields of the foundry."""
    mesh = slab_mesh(comm, 2.5e-4, 2.5e-3)
    found = Solidification(mesh, {"casting": Curve()}, followed)
    for step in range(STEPS):
        found.update(state(mesh, POURED + STEP * step, step))
    fields = FoundryFields(found, {"casting": Poured(Alloy(alloy(**KEYS)), 3e5)})
    return mesh.bodies["casting"].points[:, 0], fields


@pytest.fixture(scope="module")
def usual():
    return solidified(MPI.COMM_WORLD, Followed(fractions=(0.4, 0.99, 0.25), lasting=RANGES))


@pytest.fixture(scope="module")
def early():
    return solidified(MPI.COMM_WORLD, Followed(at=FrontPlace(temperature=604.0)))


def agree(comm, x, values, exact, tolerance=5e-3):
    inside = (x > 5e-4) & (x < 2e-3)
    low, high = extremes(comm, values[inside] / exact[inside] - 1.0)
    assert -tolerance < low and high < tolerance


@pytest.mark.parametrize(("which", "fraction"), [("usual", 0.9), ("early", 0.2)])
def test_the_front_can_be_chosen(comm, which, fraction, request):
    x, fields = request.getfixturevalue(which)
    speed = SPEED * (1.0 + GROWTH * passing(x, fraction))
    agree(comm, x, fields.nodal("casting", "front_speed"), speed)
    agree(comm, x, fields.nodal("casting", "cooling_rate"), GRADIENT * speed)
    agree(comm, x, fields.nodal("casting", "niyama"), np.sqrt(GRADIENT / speed))
    spacing = 4e-5 * (GRADIENT * speed) ** (-1.0 / 3.0)
    agree(comm, x, fields.nodal("casting", "arm_spacing"), spacing)
    agree(comm, x, fields.nodal("casting", "yield_strength"), 6e7 + 1e5 / np.sqrt(spacing))
    drag = 1.2e-3 * (0.05 / 0.95) * 55.0 * GRADIENT * speed
    dimensionless = spacing * GRADIENT * np.sqrt(5e4 / drag)
    agree(comm, x, fields.nodal("casting", "dimensionless_niyama"), dimensionless)
    pores = 0.05 * CriticalLiquid(FreezingPath(LinearLaw(), 560.0, 615.0))(dimensionless)
    agree(comm, x, fields.nodal("casting", "pore_fraction"), pores, 1e-2)


def test_times_of_any_solid_fraction_count_from_pouring(comm, usual):
    x, fields = usual
    for fraction in (0.25, 0.4, 0.99, 1.0):
        values = fields.nodal("casting", f"passing_time_{fraction!r}")
        agree(comm, x, values, passing(x, fraction) - POURED)
    modulus = np.sqrt((passing(x, 1.0) - POURED) / 3e5)
    agree(comm, x, fields.nodal("casting", "modulus"), modulus)


def test_the_ratio_of_clyne_and_davies(comm, usual):
    x, fields = usual
    t = {fraction: passing(x, fraction) for fraction in (0.4, 0.9, 0.99)}
    exact = (t[0.99] - t[0.9]) / (t[0.9] - t[0.4])
    agree(comm, x, fields.nodal("casting", "clyne_davies"), exact, 2e-2)


@pytest.mark.ranks
def test_a_body_without_data_has_none(comm):
    mesh = slab_mesh(comm, 1e-3, 3e-3)
    fields = FoundryFields(Solidification(mesh, {"casting": Curve()}), {})
    assert np.isnan(fields.nodal("casting", "pore_fraction")).all()
    fields = FoundryFields(Solidification(mesh, {}), {})
    assert np.isnan(fields.nodal("casting", "passing_time_0.5")).all()


def test_a_history_goes_on_with_the_levels_that_it_had(comm):
    """Half of the history, then a new object with other levels that takes it over."""
    mesh = slab_mesh(comm, 5e-4, 3e-3)
    body = mesh.bodies["casting"]

    def follow(found, steps):
        for step in steps:
            found.update(state(mesh, POURED + STEP * step, step), "casting")
        return found

    whole = follow(BodySolidification(body, Curve()), range(STEPS))
    half = follow(BodySolidification(body, Curve()), range(59))
    second = BodySolidification(body, Curve(), followed=Followed(fractions=(0.5,)))
    second.restore({name: saved.values.copy() for name, saved in half.saved().items()})
    follow(second, range(59, STEPS))
    for quantity in ("solidification_time", "gradient", "niyama"):
        np.testing.assert_array_equal(getattr(second, quantity)(), getattr(whole, quantity)())
    at_break = POURED + STEP * 58
    times = second.passing_time(0.5) + POURED
    gone = passing(body.points[:, 0], 0.5) < at_break - 0.3
    to_come = passing(body.points[:, 0], 0.5) > at_break + 0.3
    assert np.isnan(times[gone]).all()
    np.testing.assert_allclose(times[to_come], passing(body.points[:, 0], 0.5)[to_come], rtol=2e-2)
    assert comm.allreduce(int(gone.sum())) > 3 and comm.allreduce(int(to_come.sum())) > 3


CASE = """
[geometry]
generator = "slab"
model = "plane-strain"
length = 0.008
width = 2e-3
size = 1e-3
[[bodies]]
name = "casting"
material = "AlSi7Mg"
temperature = 640
[[boundaries]]
on = "casting/wall"
heat = { type = "temperature", value = 300 }
[time]
end = 0.4
fixed_step = 0.02
first_step = 0.02
largest_step = 0.02
[coupling]
scheme = "thermal"
[output]
fields = [
    "dimensionless_niyama", "pore_fraction", "clyne_davies", "passing_times", "modulus",
    "front_speed",
]
checkpoint = 0.2
[foundry]
passing_times = [0.5]
modulus_mould = { material = "sand-silica", temperature = 20 }
"""


def test_a_run_that_goes_on_ends_like_one_that_was_not_stopped(comm, shared_tmp_path):
    path = shared_tmp_path / "case.toml"
    if comm.rank == 0:
        path.write_text(CASE)
    comm.Barrier()
    whole = Results(run(path, output=shared_tmp_path / "whole"))
    run(path, ["time.end=0.2"], output=shared_tmp_path / "parts")
    parts = Results(run(path, output=shared_tmp_path / "parts", restart=True))
    assert whole.record["front"] == "f_s = 0.9"
    names = ["dimensionless_niyama", "pore_fraction", "clyne_davies", "front_speed", "modulus"]
    for name in [*names, "passing_time_0.5"]:
        values = whole.field(name, "casting").values
        assert np.isfinite(values).sum() > 6, name
        np.testing.assert_allclose(parts.field(name, "casting").values, values, rtol=1e-6)


STAGED = """
[[stages]]
at = 0.2
[[stages.boundaries]]
on = "casting/wall"
heat = { type = "temperature", value = 200 }
"""


def test_the_last_state_of_a_stage_knows_nothing_of_what_passes_later(comm, shared_tmp_path):
    path = shared_tmp_path / "staged.toml"
    if comm.rank == 0:
        path.write_text(CASE + STAGED)
    comm.Barrier()
    results = Results(run(path, output=shared_tmp_path / "staged"))
    assert {0.0, 0.2, 0.4} <= set(results.times)
    first, last = (results.field("passing_time_0.5", "casting", t).values for t in (0.2, 0.4))
    assert np.nanmax(first) <= 0.2 < np.nanmax(last)
    next_step = (last > 0.2) & (last <= 0.22)
    assert next_step.any() and np.isnan(first[next_step]).all()


@pytest.mark.ranks
def test_the_speed_of_the_front_is_found_once_for_all_that_ask_for_it(comm, monkeypatch):
    calls = []
    found = Steepness.at_nodes
    monkeypatch.setattr(Steepness, "at_nodes", lambda *given: calls.append(1) or found(*given))
    _, fields = solidified(comm, Followed(lasting=RANGES))
    for name in ("niyama", "cooling_rate", "arm_spacing", "pore_fraction", "front_speed"):
        fields.nodal("casting", name)
    assert len(calls) == 1


def test_names_stand_for_fields():
    case = read_case(parse_toml(CASE), Path("case.toml"))
    assert written_names("modulus", case) == ["modulus"]
    names = written_names("passing_times", case)
    assert names == ["passing_time_0.5"]
    assert all(is_of_foundry(name) for name in [*names, "niyama", "pore_fraction"])
    assert not is_of_foundry("temperature")
    assert followed_by(case).fractions == (0.5,)
    assert followed_by(case).lasting == (0.4, 0.9, 0.99)


def test_the_constant_of_the_modulus_follows_from_the_mould():
    """By hand, of a mould and a metal with constant data, poured 25 K above its liquidus."""
    content = parse_toml(CASE)
    content["materials"] = {
        "metal": {
            "density": 2500, "heat_capacity": {"solid": 1000, "liquid": 1080}, "conductivity": 100,
            "latent_heat": 3.92e5, "solidus": 560, "liquidus": 615,
        },
        "sand": {"density": 1600, "heat_capacity": 1000, "conductivity": 0.7},
    }  # fmt: skip
    content["bodies"][0]["material"] = "metal"
    content["foundry"]["modulus_mould"]["material"] = "sand"
    content["output"]["fields"] = ["modulus"]
    case = read_case(content, Path("case.toml"))
    metal = alloy(density=2500, heat_capacity={"solid": 1000, "liquid": 1080}, latent_heat=3.92e5,
                  solidus=560, liquidus=615)  # fmt: skip
    constant = chvorinov_constant(case, case.bodies[0], metal)
    assert constant == pytest.approx(2.389176e6, rel=1e-6)
