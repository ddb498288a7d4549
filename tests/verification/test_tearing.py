"""Tearing of the mush and cracks of the solid through runs, against exact values.

Strain in the brittle range: a bar that is stretched at 1e-3/s and passes 0.9 < f < 0.99 in 4 s has
gained 4e-3, whatever its steps are. Margin of Rappaz, Drezet and Gremaud: a strip across which the
isotherms travel with G = 1e4 K/m and v_T = 1e-3 m/s is pulled across the gradient at 0.01/s; the
critical rate of f linear in T, ΔT_f = 50 K, μ = 1e-3, β = 0.06, Δp_c = 2 kPa and λ2 = 50 µm is
0.03162823/s for g_c = 0.02 and 4.957869e-4/s for 0.01. Cold cracks: a bar held at its ends has
σ = E α ΔT.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.cli import execute
from castx.foundry.mush import FreezingPath
from castx.foundry.porosity import Melt
from castx.foundry.suction import CUT_OFFS, MushSuction
from castx.materials.solid_fraction import LinearLaw
from castx.process.simulation import Simulation
from castx.proof.verification.solids.viscoplastic_bars import KINDS, bar
from castx.results.reading import Results
from castx.results.writing import ResultsWriter

pytestmark = pytest.mark.sampled

VISCOPLASTIC = "thermo-elasto-viscoplastic"
ALLOY = {
    "law": "perzyna", "young_modulus": 5e9, "poisson_ratio": 0.3, "expansion": 0.0,
    "yield_stress": 1e6, "viscosity": 1e8, "solidus": 550, "liquidus": 600, "latent_heat": 1.0,
    "liquid": {"viscosity": 1e6, "coherency": 0.7},
}  # fmt: skip


def last_fields(comm, content: dict[str, Any], folder: Path) -> Any:
    """Run a case and return the grid of its casting at the end, whole on all ranks."""
    content = {**content, "output": {**content["output"], "folder": str(folder)}}
    case = read_case(content, folder / "case.toml")
    simulation = Simulation.from_case(case, comm)
    with ResultsWriter(case, simulation.mesh, simulation.pairs) as results:
        for state in simulation:
            results.write(state)
    simulation.destroy()
    comm.Barrier()
    return read(folder)


def toml(value: Any) -> str:
    """Return a value of a case as TOML has it in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, list):
        return f"[{', '.join(map(toml, value))}]"
    return json.dumps(value)


def read(folder: Path) -> Any:
    run = Results(folder)
    return run.grids(run.times[-1])["casting"]


@pytest.mark.parametrize("name", ["generalised", "axisymmetric q1p0", "space"])
def test_a_bar_gains_its_rate_times_the_time_of_passing(comm, shared_tmp_path, name):
    cooling, rate = 4.5 / 4.0, 1e-3
    end = 110.0 / cooling
    alloy = {**ALLOY, "critical_strain": 2e-3}
    cooled, pulled = [[0.0, 610.0], [end, 500.0]], [[0.0, 0.0], [end, rate * end]]
    content = bar(KINDS[name], alloy, VISCOPLASTIC, cooled, pulled, end=end, steps=37)
    content["output"] = {"fields": ["brittle_strain", "brittle_time", "brittle_strain_index"]}
    found = last_fields(comm, content, shared_tmp_path).point_data
    np.testing.assert_allclose(found["brittle_time"], 4.0, rtol=1e-9)
    np.testing.assert_allclose(found["brittle_strain"], 4e-3, rtol=1e-9)
    np.testing.assert_allclose(found["brittle_strain_index"], 2.0, rtol=1e-9)


GRADIENT, SPEED, RATE = 1e4, 1e-3, 0.01
LENGTH, WIDTH, CELLS = 2e-3, 1e-3, 24


def strip() -> dict[str, Any]:
    """Return a strip so conductive that its temperature is linear, pulled across the gradient."""
    cold = 601.0
    fall = 601.0 + GRADIENT * LENGTH - 540.0
    end = fall / (GRADIENT * SPEED)
    wall, far = ([[0.0, start], [end, start - fall]] for start in (cold, cold + GRADIENT * LENGTH))
    alloy = {
        **ALLOY, "density": 1.0, "heat_capacity": 1.0, "conductivity": 1e5,
        "solidification_shrinkage": 0.06 / 1.06, "melt_viscosity": 1e-3, "arm_spacing": 50e-6,
    }  # fmt: skip
    pulled = [[0.0, 0.0], [end, RATE * WIDTH * end]]
    return {
        "geometry": {"generator": "slab", "model": "plane-strain", "length": LENGTH,
                     "width": WIDTH, "size": LENGTH / CELLS},
        "materials": {"alloy": alloy},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": 625,
                    "law": VISCOPLASTIC}],
        "boundaries": [
            {"on": "casting/wall", "heat": {"type": "temperature", "value": wall},
             "displacement": {"x": 0.0}},
            {"on": "casting/far", "heat": {"type": "temperature", "value": far}},
            {"on": "casting/bottom", "displacement": {"y": 0.0}},
            {"on": "casting/top", "displacement": {"y": pulled}},
        ],
        "time": {"end": end, "fixed_step": end / 48},
        "output": {"fields": ["brittle_strain", "brittle_time", "tearing_margin"]},
    }  # fmt: skip


@pytest.fixture(scope="module")
def pulled_strip(tmp_path_factory):
    folder = MPI.COMM_WORLD.bcast(tmp_path_factory.mktemp("strip"))
    return last_fields(MPI.COMM_WORLD, strip(), folder)


def test_the_margin_of_a_strip_pulled_across_the_gradient(pulled_strip):
    """Off the ends, where the speed of the front is seen from one side."""
    inside = np.abs(pulled_strip.points[:, 0] - 0.5 * LENGTH) < 1.5 * LENGTH / CELLS
    path = FreezingPath(LinearLaw(), 550.0, 600.0)
    place = np.array(GRADIENT), np.array(SPEED), np.array(50e-6)
    for cut_off in CUT_OFFS:
        critical = MushSuction.of(path, cut_off).critical_rate(*place, Melt(1e-3, 0.06, 2e3))
        found = pulled_strip.point_data[f"tearing_margin_{cut_off!r}"][inside]
        np.testing.assert_allclose(found, RATE / critical, rtol=0.01)
    found = pulled_strip.point_data["tearing_margin_0.02"][inside]
    np.testing.assert_allclose(found, RATE / 0.03162823, rtol=5e-3)


def test_what_shrinks_while_it_freezes_is_strained_in_the_brittle_range(pulled_strip):
    """Held in the third direction and at its sides, it cannot follow: ε̇ t + s Δf/3.

    An element spans a sixth of the range, and behind the solidus it shrinks no more: the part of
    the shrinkage, a quarter of the whole, is 4 % low here, 9 % with 8 elements.
    """
    exact = RATE * 0.45 + 0.06 / 1.06 * 0.09 / 3.0
    inside = np.abs(pulled_strip.points[:, 0] - 0.5 * LENGTH) < 1.5 * LENGTH / CELLS
    found = pulled_strip.point_data["brittle_strain"][inside]
    np.testing.assert_allclose(found.mean(), exact, rtol=0.015)


def test_fields_go_on_after_a_restart_and_on_any_ranks(comm, shared_tmp_path, pulled_strip):
    content = strip()
    file = shared_tmp_path / "strip.toml"
    if comm.rank == 0:
        file.write_text("\n".join(f"{key} = {toml(value)}" for key, value in content.items()))
    comm.Barrier()
    half = 30 * content["time"]["fixed_step"]
    folder = shared_tmp_path / "parts"
    arguments = ["run", str(file), "--output", str(folder)]
    assert execute([*arguments, "--set", f"time.end={half!r}"], comm) == 0
    assert execute([*arguments, "--restart"], comm) == 0
    alone = shared_tmp_path / "alone"
    if comm.rank == 0 and comm.size > 1:
        last_fields(MPI.COMM_SELF, content, alone)
    comm.Barrier()
    for other in [folder] + [alone] * (comm.size > 1):
        found = read(other)
        order, own = (np.lexsort(grid.points.T.round(9)) for grid in (found, pulled_strip))
        for name, values in pulled_strip.point_data.items():
            np.testing.assert_allclose(found.point_data[name][order], values[own], rtol=1e-5)


@pytest.mark.parametrize("name", ["plane stress", "space"])
def test_the_cold_crack_index_of_a_bar_held_at_its_ends(comm, shared_tmp_path, name):
    """Cooled by 200 K, then warmed: the largest ratio stays that of the coldest instant."""
    metal = {"young_modulus": 70e9, "poisson_ratio": 0.33, "expansion": 2.4e-5,
             "tensile_strength": [[20.0, 200e6], [600.0, 20e6]]}  # fmt: skip
    history = [[0.0, 500.0], [10.0, 300.0], [20.0, 350.0]]
    content = bar(KINDS[name], metal, "thermo-elastic", history, [[0.0, 0.0]], end=20.0, steps=8)
    content["output"] = {"fields": ["cold_crack_index", "largest_principal_stress"]}
    found = last_fields(comm, content, shared_tmp_path).cell_data
    strength = 20e6 + 180e6 * (600.0 - 300.0) / 580.0
    np.testing.assert_allclose(found["cold_crack_index"], 70e9 * 2.4e-5 * 200 / strength, rtol=1e-8)
    np.testing.assert_allclose(found["largest_principal_stress"], 70e9 * 2.4e-5 * 150, rtol=1e-8)
