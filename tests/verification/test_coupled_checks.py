"""The checks without a reference on coupled runs (verification: "Checks without a reference").

1 energy, 2 heat across interfaces, 3 contact forces, 4 turned and moved models and any number of
ranks, 5 symmetry, 6 units. Cases: the cylinder in a mould, axisymmetric and a quarter in space,
whose contact opens; a ring that shrinks onto a core, whose contact closes and conducts by pressure;
a hot block on a cold plate in the plane, with gravity, whose contact opens at the rim.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np
import pytest

from castx.domain.partition import partition
from castx.domain.source import gmsh_session
from castx.meshes.generators.stacked_blocks import stacked_blocks
from tests import coupled_cases
from tests.contact_methods import EXACT
from tests.coupled_cases import ALUMINIUM, STEEL, TIGHT, cylinder, final_state, merged, ring
from tests.partitions import PARTITION

QUARTER: dict[str, Any] = {"model": "3d", "sector": "quarter", "size": 0.01, "height": 0.04}
SHORT = {"time": {"end": 2.0}}
BRIEF = {"time": {"end": 6.0}}


def blocks(*changes, method="condensed", gravity=(0.0, -9.81), **geometry) -> dict:
    """Return a hot block on a cold wider plate; nothing but supports hold the block sideways."""
    data = {
        "geometry": {"generator": "stacked_blocks", "model": "plane-strain",
                     "upper": [0.04, 0.02], "base": [0.08, 0.02], "size": 0.005,
                     "symmetry": False, **geometry},
        "materials": {"aluminium": ALUMINIUM, "steel": STEEL},
        "bodies": [
            {"name": "upper", "material": "aluminium", "temperature": 680.0},
            {"name": "base", "material": "steel", "temperature": 50.0,
             "formulation": "displacement"},
        ],
        "interfaces": [
            {"bodies": ["upper", "base"], "contact": {"method": method},
             "heat": {"law": "series", "closed": 3000.0, "gas_conductivity": 0.05}},
        ],
        "boundaries": [
            {"on": "base/bottom", "displacement": {"normal": 0.0},
             "heat": {"type": "convection", "coefficient": 1000.0, "ambient": 20.0}},
            {"on": "base/side", "displacement": {"normal": 0.0}},
        ],
        "loads": {"gravity": list(gravity)},
        "time": {"end": 8.0, "first_step": 0.1, "largest_step": 2.0, "smallest_step": 1e-4},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data


CASES = {
    "cylinder": cylinder(),
    "quarter": cylinder(SHORT, **QUARTER),
    "ring": ring(),
    "blocks": blocks(),
}


# All that an interface and a surface can have, in one case.
LAWS = cylinder(BRIEF)
LAWS["interfaces"][0]["heat"] = {
    "law": "series", "roughness": [3e-5, 1e-5], "coating": {"thickness": 1e-4, "conductivity": 0.6},
    "gas_conductivity": {"over": "temperature", "table": [[0, 0.025], [1000, 0.08]]},
    "pressure": {"hardness": 1e9, "exponent": 0.8}, "transition": 1e-5,
    "radiation": {"emissivities": [0.3, 0.8]},
    "patches": [
        {"within": {"z": [0.0, 0.02]}, "law": "limited", "gas_conductivity": 0.05,
         "closed": {"over": "temperature", "table": [[200, 1000], [660, 2500]], "of": "mean"}},
        {"within": {"z": [0.05, 0.06]}, "law": "solid-fraction", "closed": 2000, "open": 300},
    ],
}  # fmt: skip
FILM = {"over": "temperature", "table": [[20, 200], [300, 900]]}
LAWS["boundaries"] += [
    {"on": "mould/outside", "heat": [
        {"type": "convection", "coefficient": FILM, "ambient": [[0, 20], [6, 60]]},
        {"type": "radiation", "emissivity": 0.9, "ambient": 20},
    ]},
    {"on": "casting/top", "heat": {"type": "radiation", "emissivity": 0.2, "ambient": 20}},
]  # fmt: skip


@pytest.mark.parametrize("name", [*CASES, "laws"])
@pytest.mark.sampled
def test_energy_and_interface_heat(comm, name):
    """Checks 1 and 2, at the default tolerances."""
    state = final_state(comm, LAWS if name == "laws" else CASES[name])
    (interface,) = state.pairs
    secondary, primary = interface.split("/")
    totals = state.totals
    assert totals["energy_error"] < 1e-6
    crossed = totals[f"{interface}.heat"]
    outside = sum(
        v for k, v in totals.items() if k.startswith(f"{primary}/") and k.endswith(".heat")
    )
    assert crossed > 0
    assert totals[f"{primary}.heat_in"] == pytest.approx(crossed + outside, rel=1e-10)
    lost = sum(v for k, v in totals.items() if k.startswith(f"{secondary}/")
               and k.endswith(".heat") and k != f"{interface}.heat")  # fmt: skip
    assert totals[f"{secondary}.heat_in"] == pytest.approx(lost - crossed, rel=1e-10)


SOLID_BLOCKS = {
    "model": "3d", "upper": [0.04, 0.04, 0.03], "base": [0.06, 0.02, 0.04], "size": 0.01,
    "symmetry": True,
}  # fmt: skip
WEIGHTS = {"upper": 2700 * 9.81, "base": 7800 * 9.81}  # N/m³


def nodal_forces(state, body: str) -> np.ndarray:
    """Return internal minus external forces at the owned nodes of a body, (owned, gdim)."""
    mechanics = state.problem.mechanics.bodies[body]
    return mechanics.residual().reshape(-1, mechanics.block_size)[:, : mechanics.dimension]


def facing_forces(state, interface: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the forces on the secondary and the primary node of each pair, pairs of all ranks."""
    comm, pairs, bodies = state.mesh.comm, state.pairs[interface], state.mesh.bodies
    own = nodal_forces(state, pairs.secondary)[pairs.secondary_local]
    part = bodies[pairs.primary].nodes.dofmap.index_map.local_range
    forces = dict(zip(range(*part), nodal_forces(state, pairs.primary), strict=True))
    both = comm.allgather(forces)
    facing = np.array([next(f[n] for f in both if n in f) for n in pairs.primary_nodes])
    shape = (-1, own.shape[1])
    return tuple(np.concatenate(comm.allgather(f.reshape(shape))) for f in (own, facing))


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("name, options", [("blocks", {}), ("solid blocks", SOLID_BLOCKS)])
@pytest.mark.sampled
def test_contact_forces(comm, name, options, method):
    """Check 3 where a weight rests on a floor: all forces are known."""
    up = 2 if options else 1
    gravity = (0.0,) * up + (-9.81,)
    state = final_state(comm, blocks(TIGHT, SHORT, method=method, gravity=gravity, **options))
    (interface,) = state.pairs
    weight = {
        body: comm.allreduce(state.problem.volumes[body].sum()) * WEIGHTS[body] for body in WEIGHTS
    }
    secondary, primary = facing_forces(state, interface)
    points = np.concatenate(comm.allgather(state.pairs[interface].points))
    for axis in range(up + 1):
        free = slice(None) if axis == up or not options else points[:, axis] > 1e-9
        assert secondary[free, axis] == pytest.approx(
            -primary[free, axis], abs=1e-8 * weight["upper"]
        )
    assert secondary[:, up].sum() == pytest.approx(weight["upper"], rel=1e-8)
    assert state.totals[f"{interface}.force.{'xyz'[up]}"] == pytest.approx(
        weight["upper"], rel=1e-8
    )
    bottom = coupled_cases.places(state, "base")[:, up] < -0.02 + 1e-9
    reaction = comm.allreduce(nodal_forces(state, "base")[bottom, up].sum())
    assert reaction == pytest.approx(weight["upper"] + weight["base"], rel=1e-8)
    assert state.totals["support_force"] < 1e-8 * weight["upper"]
    check_signs(state, interface)
    assert 0 < state.totals[f"{interface}.closed_fraction"] < 1


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.sampled
def test_contact_forces_of_a_shrink_fit(comm, method):
    """Check 3 under pressure: radial forces of all pairs, axial ones away from the held base."""
    state = final_state(comm, ring(TIGHT, BRIEF, method=method))
    (interface,) = state.pairs
    secondary, primary = facing_forces(state, interface)
    largest = np.abs(secondary).max()
    assert secondary[:, 0] == pytest.approx(-primary[:, 0], abs=1e-8 * largest)
    heights = np.concatenate(comm.allgather(state.pairs[interface].points[:, 1]))
    free = heights > 1e-9
    assert secondary[free, 1] == pytest.approx(0.0, abs=1e-8 * largest)
    assert primary[free, 1] == pytest.approx(0.0, abs=1e-8 * largest)
    total = state.totals[f"{interface}.force.r"]
    assert secondary[:, 0].sum() == pytest.approx(total, rel=1e-8)
    check_signs(state, interface)
    assert state.paired(interface, "contact_pressure").max(initial=0.0) < 1e9
    assert total > 1e4


def check_signs(state, interface: str) -> None:
    """No pair pulls, none penetrates, none does both press and gape."""
    gap, pressure = state.paired(interface, "gap"), state.paired(interface, "contact_pressure")
    assert (pressure >= 0).all()
    assert (gap >= -1e-12).all()
    assert (np.minimum(gap, pressure) <= 1e-12).all()


def turned_file(comm, path, angle: float, shift: tuple[float, float]) -> None:
    """Write the mesh of the blocks, turned about the origin and then moved, in gmsh's format."""
    c, s = math.cos(angle), math.sin(angle)
    if comm.rank == 0:
        with gmsh_session():
            geometry = blocks()["geometry"]
            stacked_blocks(**{k: v for k, v in geometry.items() if k != "generator"})
            gmsh.model.mesh.affineTransform([c, -s, 0, shift[0], s, c, 0, shift[1], 0, 0, 1, 0])
            gmsh.write(str(path))
    comm.Barrier()


def turned_back(state, angle: float, shift: tuple[float, float]) -> dict[str, np.ndarray]:
    """Return the fields in the axes of the mesh before it was turned and moved."""
    comm, c, s = state.mesh.comm, math.cos(angle), math.sin(angle)
    Q = np.array([[c, -s], [s, c]])
    found = {}
    for body in state.mesh.bodies:
        points = (coupled_cases.places(state, body) - shift) @ Q
        for name in ("temperature", "displacement"):
            values = state.nodal(body, name)[: len(points)]
            values = values @ Q if values.ndim > 1 else values
            found[f"{body} {name}"] = coupled_cases.ordered(comm, points, values)
    for name, pairs in state.pairs.items():
        points = (pairs.points - shift) @ Q
        for field in ("gap", "contact_pressure", "heat_transfer_coefficient"):
            found[field] = coupled_cases.ordered(comm, points, state.paired(name, field))
    return found


@pytest.mark.parametrize("angle, shift", [(math.pi / 2, (0.0, 0.0)), (4.0, (1.0, -2.0))])
@pytest.mark.sampled
def test_turned_and_moved_model(comm, shared_tmp_path, angle, shift):
    """Check 4: nothing depends on the axes."""
    results = []
    for turn, move in ((0.0, (0.0, 0.0)), (angle, shift)):
        file = shared_tmp_path / f"turned{turn}.msh"
        turned_file(comm, file, turn, move)
        down = (9.81 * math.sin(turn), -9.81 * math.cos(turn))
        data = blocks(TIGHT, {"time": {"end": 1.0}}, gravity=down)
        data["geometry"] = {"file": file.name, "model": "plane-strain"}
        results.append(turned_back(final_state(comm, data, shared_tmp_path), turn, move))
    difference, where = coupled_cases.largest_difference(*results)
    assert difference < 1e-8, where


YIELDING = {"yield_stress": [[20.0, 40e6], [660.0, 1e6]], "hardening": 1e9}


def yielding_history(
    comm, path, angle: float = 0.0, *, swapped: bool = False, renumbered: bool = False
) -> list[tuple[float, int, float]]:
    """Return times, numbers of pairs under pressure and largest gaps of a block that yields."""
    turned_file(comm, path, angle, (0.0, 0.0))
    if renumbered and comm.rank == 0:
        with gmsh_session():
            gmsh.open(str(path))
            tags = gmsh.model.mesh.getNodes()[0]
            gmsh.model.mesh.renumberNodes(tags, np.random.default_rng(3).permutation(tags))
            gmsh.write(str(path))
    comm.Barrier()
    down = (9.81 * math.sin(angle), -9.81 * math.cos(angle))
    metal = {"materials": {"aluminium": YIELDING}, "time": {"end": 20.0}}
    data = blocks(TIGHT, metal, gravity=down)
    data["geometry"] = {"file": path.name, "model": "plane-strain"}
    data["bodies"][0]["law"] = "thermo-elasto-plastic"
    if swapped:
        data["bodies"].reverse()
        data["interfaces"][0]["bodies"].reverse()
    found = []
    for state in coupled_cases.simulation(comm, data, path.parent):
        name = next(iter(state.pairs))
        pressing = np.count_nonzero(state.paired(name, "contact_pressure") > 0)
        gap = state.paired(name, "gap").max(initial=0.0)
        found.append(
            (state.time, comm.allreduce(pressing), comm.allreduce(float(gap), op=MPI.MAX))
        )
    return found


@pytest.mark.sampled
def test_the_same_steps_however_a_block_that_yields_lies(comm, shared_tmp_path):
    """Check 4 at tolerances of rounding: no step is cut, and none is shorter, for rounding.

    The block comes off all of its pairs but one.
    """
    own = np.array(yielding_history(comm, shared_tmp_path / "own.msh"))
    assert own[1, 1] == 2 and own[-1, 1] == 1
    for number, placed in enumerate(
        ({"angle": math.pi / 2}, {"angle": 4.0}, {"swapped": True}, {"renumbered": True})
    ):
        other = np.array(yielding_history(comm, shared_tmp_path / f"{number}.msh", **placed))
        assert other.shape == own.shape, placed
        np.testing.assert_allclose(other[:, 0], own[:, 0], rtol=1e-9, err_msg=str(placed))
        np.testing.assert_array_equal(other[:, 1], own[:, 1], err_msg=str(placed))
        np.testing.assert_allclose(other[:, 2], own[:, 2], atol=1e-9 * own[:, 2].max())


TIGHT_CASES = {
    "cylinder": cylinder(TIGHT, SHORT),
    "multipliers": ring(TIGHT, BRIEF, method="multipliers"),
    "quarter": cylinder(TIGHT, SHORT, **QUARTER),
    "ring": ring(TIGHT, BRIEF),
    "blocks": blocks(TIGHT, SHORT),
    "laws": merged(LAWS, merged(TIGHT, SHORT)),
}


@cache
def on_one_rank(name: str) -> dict[str, np.ndarray]:
    """Return the last fields of a case that the first rank runs alone; collective."""
    found = None
    if MPI.COMM_WORLD.rank == 0:
        found = coupled_cases.fields(final_state(MPI.COMM_SELF, TIGHT_CASES[name]))
    return MPI.COMM_WORLD.bcast(found)


@pytest.mark.ranks
@pytest.mark.parametrize("name", TIGHT_CASES)
def test_any_number_of_ranks(comm, name):
    """Check 4: the same numbers on these ranks and on one alone."""
    if comm.size == 1:
        pytest.skip("compares several ranks with one")
    spread = coupled_cases.fields(final_state(comm, TIGHT_CASES[name]))
    difference, where = coupled_cases.largest_difference(spread, on_one_rank(name))
    assert difference < 1e-8, where


@pytest.mark.ranks
@pytest.mark.parametrize("name", ["laws", "multipliers", "quarter"])
def test_a_rank_without_cells(comm, monkeypatch, name):
    """Small bodies leave ranks without cells or nodes of their own."""
    if comm.size == 1:
        pytest.skip("leaves one of several ranks empty")

    def away_from_first(*arguments):
        return np.maximum(partition(*arguments), 1)

    alone = on_one_rank(name)  # before the partition changes
    monkeypatch.setattr(PARTITION, away_from_first)
    spread = final_state(comm, TIGHT_CASES[name])
    assert (len(spread.mesh.bodies["casting"].points) == 0) == (comm.rank == 0)
    difference, where = coupled_cases.largest_difference(coupled_cases.fields(spread), alone)
    assert difference < 1e-8, where


def test_symmetry(comm):
    """Check 5, and the half model is the half of the whole one."""
    data = blocks(TIGHT, SHORT)
    whole = final_state(comm, data)
    half = final_state(comm, merged(data, {"geometry": {"symmetry": True}}))
    for body in whole.mesh.bodies:
        points, alone = (gathered_places(state, body) for state in (whole, half))
        mirror = order_of(points * (-1.0, 1.0))
        straight, right = order_of(points), points[order_of(points)][:, 0] > -1e-9
        for name in ("temperature", "displacement"):
            values = gathered(whole, body, name)
            sign = (-1.0, 1.0) if name == "displacement" else 1.0
            scale = np.abs(values).max()
            assert values[straight] == pytest.approx((values * sign)[mirror], abs=1e-8 * scale)
            of_half = gathered(half, body, name)[order_of(alone)]
            assert values[straight][right] == pytest.approx(of_half, abs=1e-8 * scale)


def gathered_places(state, body: str) -> np.ndarray:
    return np.concatenate(state.mesh.comm.allgather(coupled_cases.places(state, body)))


def gathered(state, body: str, name: str) -> np.ndarray:
    owned = len(coupled_cases.places(state, body))
    return np.concatenate(state.mesh.comm.allgather(state.nodal(body, name)[:owned]))


def order_of(points: np.ndarray) -> np.ndarray:
    return np.lexsort(np.round(points / np.abs(points).max(), 7).T)


DIMENSIONS = {
    "density": (-3, 1), "heat_capacity": (2, 0), "conductivity": (1, 1), "latent_heat": (2, 0),
    "young_modulus": (-1, 1), "closed": (0, 1), "gas_conductivity": (1, 1), "coefficient": (0, 1),
    "resistance": (0, -1), "hardness": (-1, 1), "gravity": (1, 0), "upper": (1, 0), "base": (1, 0),
    "core_radius": (1, 0), "outer_radius": (1, 0), "radius": (1, 0), "height": (1, 0),
    "wall": (1, 0), "size": (1, 0), "viscosity": (-1, 1),
}  # fmt: skip
"""Exponents of length and mass of what a case has; times and temperatures keep their units."""


def in_units(data, length: float, mass: float, key: str = ""):
    """Return a case in units of which a metre has `length` and a kilogram has `mass`."""
    if isinstance(data, dict):
        return {k: in_units(v, length, mass, key if k in ("solid", "liquid") else k)
                for k, v in data.items()}  # fmt: skip
    if key not in DIMENSIONS:
        return [in_units(v, length, mass) for v in data] if isinstance(data, list) else data
    factor = length ** DIMENSIONS[key][0] * mass ** DIMENSIONS[key][1]
    if not isinstance(data, list):
        return data * factor
    return [[row[0], row[1] * factor] if isinstance(row, list) else row * factor for row in data]


@pytest.mark.parametrize("name", CASES)
@pytest.mark.sampled
def test_other_units(comm, name):
    """Check 6: in millimetres, tonnes and MPa the same iterations and the same steps."""
    counts, ends = [], []
    for length, mass in ((1.0, 1.0), (1e3, 1e-3)):
        data = in_units(CASES[name], length, mass)
        taken = list(counted(coupled_cases.states(comm, data)))
        counts.append([row for row, _ in taken])
        ends.append([row for _, row in taken])
    assert counts[0] == counts[1]
    assert ends[0] == pytest.approx(ends[1], rel=1e-6)


def counted(run):
    """Yield the counters of each step and its time."""
    for state in run:
        c = state.counters
        yield (c.heat_iterations, c.mechanics_iterations, c.contact_changes, c.passes), state.time
