"""Pressure in the mush as runs of case files, beside closed forms.

Column of mush (docs/equations.md): suctions of 910.5686 Pa at a liquid fraction of 0.02 while it
freezes, 1713.5802 Pa while it is stretched by 0.01/s too, to 1 %; so 2 kPa are reached at a rate of
0.01356682/s. Chilled alloy: suctions of the similarity solution do not change in time. Behind a
steady front the pore fraction is s g_cr. Terzaghi's consolidation, mush without drainage, melt at
rest, boxes that are sealed and open.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.foundry.melt_levels import communicating
from castx.process.state import State
from castx.proof.verification.heat.freezing_range import FreezingRange
from castx.proof.verification.heat.neumann import strip_case
from castx.proof.verification.verification import Resolution
from tests.coupled_cases import (
    TIGHT,
    cylinder,
    fields,
    final_state,
    gone_on,
    merged,
    nodal,
    places,
    states,
)
from tests.verification import two_risers
from tests.verification.mush_strips import CONTRACTION, LENGTH, METAL, SPEED, skeleton, strip
from tests.verification.test_rest_and_sealed_boxes import (
    DENSITY,
    GRAVITY,
    SHRINKAGE,
    VOLUME,
    box,
    chilled,
)

pytestmark = pytest.mark.sampled

SHRUNK = SHRINKAGE / (1 - SHRINKAGE)
MUSH = {"materials": {"alloy": {"arm_spacing": 50e-6, "melt_viscosity": 1e-3}}}
RUNNING = {"arm_spacing": {"coefficient": 4e-5}, "liquid": {"coherency": 0.7}}
LEDGER = ("feeding_demand", "fed_volume", "opened_volume", "yielded_volume", "unfed_volume")


def totals(state: State) -> dict[str, float]:
    """Return the ledger of the casting."""
    return {name: state.totals[f"casting.{name}"] for name in LEDGER}


def closes(found: dict[str, float], share: float = 1e-8) -> bool:
    """Return whether the ledger closes to a share of the demand."""
    supplied = found["fed_volume"] + found["opened_volume"] + found["yielded_volume"]
    return abs(found["feeding_demand"] - supplied) <= share * abs(found["feeding_demand"])


def along(state: State, name: str) -> tuple[FloatArray, FloatArray]:
    """Return the places along x of nodes of all ranks, and the means of a field there."""
    comm = state.mesh.comm
    x = np.concatenate(comm.allgather(places(state, "casting")[:, 0]))
    values = np.concatenate(comm.allgather(state.nodal("casting", name)[: _owned(state)]))
    at, which = np.unique(np.round(x, 9), return_inverse=True)
    return at, np.bincount(which, values) / np.bincount(which)


def _owned(state: State) -> int:
    return len(places(state, "casting"))


def suction_of_column(comm, freezing: bool, stretching: float) -> tuple[float, float]:
    """Return the suction at a liquid fraction of 0.02 in a short step, and the largest [Pa]."""
    step, size = 1e-4, LENGTH / 100
    cooling = 10.0 if freezing else 0.0
    data = strip(
        size=size, step=step, end=step, cooling=cooling, ahead=cooling * step + 1e-9,
        stretching=stretching,
    )  # fmt: skip
    for state in states(comm, data):
        x, pressure = along(state, "melt_suction")
        largest = state.totals["casting.melt_suction"]
    return float(np.interp(0.02 * LENGTH, x, pressure)), largest


def test_column_that_freezes_and_is_stretched(comm):
    frozen, largest = suction_of_column(comm, True, 0.0)
    stretched, largest_of_stretched = suction_of_column(comm, False, 0.01)
    assert stretched == pytest.approx(803.0116, rel=0.01)
    assert largest_of_stretched == pytest.approx(1260.9495, rel=0.01)
    both, largest_of_both = suction_of_column(comm, True, 0.01)
    assert frozen == pytest.approx(910.5686, rel=0.01)
    assert both == pytest.approx(1713.5802, rel=0.01)
    assert largest == pytest.approx(1429.1846, rel=0.01)  # at the root
    assert largest_of_both == pytest.approx(2690.1342, rel=0.01)
    rate = (2000.0 - frozen) / (both - frozen) * 0.01
    assert rate == pytest.approx(0.01356682, rel=0.01)


def test_mush_without_drainage(comm):
    """(1 + β f)(1 + u′) stays, and the skeleton carries 4G/3 u′."""
    shut = {"foundry": {"feeders": []}, "materials": {"alloy": {"arm_spacing": 1e-9}},
            "time": {"end": 1.0, "first_step": 0.5, "largest_step": 0.5}}  # fmt: skip
    data = skeleton(shut, elements=3, history=[[0.0, 520.0], [1.0, 510.0]])
    *_, last = states(comm, data)
    strain = (1 + CONTRACTION * 0.8) / (1 + CONTRACTION * 0.9) - 1
    assert strain == pytest.approx(-5.692600e-3, rel=1e-6)
    x, moved = places(last, "casting")[:, 0], last.nodal("casting", "displacement")[:, 0]
    np.testing.assert_allclose(moved[: len(x)], strain * x, rtol=1e-8, atol=1e-16)
    np.testing.assert_allclose(
        last.nodal("casting", "pressure"), -4e6 / 3 * strain, rtol=1e-8
    )  # 7590.133 Pa of suction


@pytest.mark.parametrize(
    ("end", "steps", "settlement", "base"),
    [(2.187, 80, 57.29627e-6, 3707.774), (0.4374, 80, 26.76176e-6, 9493.054),
     (4.374, 160, 69.84448e-6, 1079.770)],
)  # fmt: skip
def test_consolidation(comm, end, steps, settlement, base):
    """The load is a traction on the skeleton, and the melt drains at the same end."""
    step = end / steps
    loaded = {"time": {"end": end, "fixed_step": step, "first_step": step},
              "materials": {"alloy": {"solidification_shrinkage": 0.0}}}  # fmt: skip
    data = skeleton(loaded, elements=20, history=[[0.0, 510.0], [10.0, 510.0]])
    data["boundaries"].append({"on": "casting/far", "traction": [-1e4, 0.0]})
    *_, last = states(comm, data)
    settled = comm.allreduce(
        float(last.nodal("casting", "displacement")[:, 0].min(initial=0.0)), MPI.MIN
    )
    assert -settled == pytest.approx(settlement, rel=0.01)
    assert -along(last, "pressure")[1][0] == pytest.approx(base, rel=0.02)


@pytest.mark.ranks
@pytest.mark.parametrize("lid", [False, True])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_melt_at_rest(comm, lid, model):
    still = {"geometry": {"lid": lid, "size": 0.025}}
    data = box(still, {"solver": {"mechanics_tolerance": 1e-12, "linear": "direct"}}, MUSH,
               {"time": {"end": 0.5}}, model=model)  # fmt: skip
    data["bodies"][0] |= {"temperature_history": [[0.0, 640.0], [1.0, 640.0]], "feeding": "darcy"}
    data["interfaces"][0]["contact"] = {"method": "condensed"}
    *_, last = states(comm, data)
    height = last.mesh.bodies["casting"].points[:, -1]
    depth = comm.allreduce(float(height.max(initial=-1.0)), MPI.MAX) - height
    pressure = last.nodal("casting", "pressure")
    np.testing.assert_allclose(pressure, -DENSITY * GRAVITY * depth, atol=1e-6)
    assert np.abs(last.nodal("casting", "displacement")).max(initial=0.0) < 1e-15


@pytest.mark.ranks
@pytest.mark.parametrize(
    ("model", "changes"),
    [
        ("plane-strain", {"geometry": {"size": 0.01}}),
        ("plane-strain", {"loads": {"gravity": [0.0, 0.0]}}),
        ("3d", {}),
    ],
)
def test_sealed_box(comm, model, changes):
    """A layer of nodes empties under the lid, where the melt has sunk."""
    data = box(changes, MUSH, model=model)
    data["bodies"][0] |= {"feeding": "darcy"}
    for state in states(comm, data):
        found = totals(state)
        assert closes(found)
    assert abs(found["unfed_volume"] - SHRINKAGE * VOLUME[model]) < 1e-8 * VOLUME[model]
    assert found["fed_volume"] == 0.0


def test_sealed_box_that_freezes_from_its_walls(comm):
    data = chilled(MUSH, {"materials": {"alloy": {"cavitation": 10.0}}})
    data["bodies"][0] |= {"feeding": "darcy"}
    for state in states(comm, data):
        found = totals(state)
    volume = VOLUME["plane-strain"]
    assert abs(found["unfed_volume"] - SHRINKAGE * volume) < 1e-8 * volume
    assert closes(found)


def test_open_box(comm):
    """Of coarse arms and a metal so stiff that no suction lets its surface sink."""
    tight = {"solver": {"mechanics_tolerance": 1e-12, "linear": "direct"}}
    coarse = {"materials": {"alloy": {"arm_spacing": 0.01, "young_modulus": 7e14,
                                      "liquid": {"viscosity": 1e12}}}}  # fmt: skip
    data = box({"geometry": {"lid": False}}, MUSH, coarse, tight)
    data["bodies"][0] |= {"feeding": "darcy"}
    for state in states(comm, data):
        found = totals(state)
        assert closes(found)
    volume = VOLUME["plane-strain"]
    assert abs(found["fed_volume"] - SHRUNK * volume) < 1e-8 * volume
    assert found["unfed_volume"] == 0.0


def chilled_alloy(comm, size: float, fractions: tuple[float, ...]) -> FloatArray:
    """Return mean suctions from the liquidus to liquid fractions from 50 to 100 s [Pa]."""
    exact, end = FreezingRange(), 100.0
    metal = exact.material() | {
        "young_modulus": 70e9, "poisson_ratio": 0.33, "expansion": 0.0,
        "solidification_shrinkage": 0.0625 / 1.0625, "melt_viscosity": 1.2e-3,
        "arm_spacing": 20e-6,
    }  # fmt: skip
    at = Resolution(size, 1e3 * size)
    data = strip_case(metal, exact.start, exact.wall, at, length=0.25, end=end)
    data = merged(data, {"coupling": {"scheme": "one-way"}, "solver": {"linear": "direct"}})
    data["bodies"][0] |= {"feeding": "darcy"}
    data["boundaries"][0] |= {"displacement": {"x": 0.0}}
    data["boundaries"] += [
        {"on": f"casting/{side}", "displacement": {"y": 0.0}} for side in ("bottom", "top")
    ]
    found: list[FloatArray] = []
    before: FloatArray = np.zeros(0)
    for state in states(comm, data):
        fraction = along(state, "solid_fraction")[1]
        if state.time > 0.5 * end:
            middle = 0.5 * (fraction + before)  # to which the mean pressure of the step belongs
            suction = along(state, "pressure")[1]
            suction = suction - suction[np.argmax(middle <= 0.0)]
            found.append(np.interp(fractions, 1 - middle, suction))
        before = fraction
    return np.mean(found, axis=0)


@pytest.mark.slow
def test_suction_in_a_chilled_alloy(comm):
    errors = [
        chilled_alloy(comm, size, (0.2, 0.1)) / [438.530, 1361.013] - 1 for size in (1e-3, 0.5e-3)
    ]
    assert abs(errors[1][0]) < 0.05
    assert abs(errors[1][1]) < 0.08
    assert (np.abs(errors[0]) > 1.6 * np.abs(errors[1])).all()


@pytest.mark.parametrize(("depression", "pores"), [(100.0, 3.276485e-3), (300.0, 1.461824e-3)])
def test_pores_behind_a_front(comm, depression, pores):
    """Over the path of the front, 20 elements across the mush and 0.1 of one in a step."""
    size, passed = LENGTH / 20, (1.5e-3, 4e-3)
    data = strip(
        {"materials": {"alloy": {"cavitation": depression}}},
        size=size, step=0.1 * size / SPEED, end=4.2, length=11e-3,
    )  # fmt: skip
    for state in states(comm, data):
        found = totals(state)
        if state.time <= passed[0] / SPEED:
            first = found
        if state.time <= passed[1] / SPEED:
            last = found
    opened = last["unfed_volume"] - first["unfed_volume"]
    assert opened / ((passed[1] - passed[0]) * size) == pytest.approx(pores, rel=0.1)
    assert closes(last)


@pytest.mark.ranks
@pytest.mark.parametrize("lid", [True, False])
def test_pressures_do_not_hang_on_the_ranks(comm, lid):
    """A body that freezes from its walls, on all ranks and on each alone.

    Sealed it opens pores; fed by a free surface its level sinks while its arms coarsen.
    """
    data = chilled({"geometry": {"size": 0.015, "lid": lid}}, MUSH, {"time": {"end": 80.0}})
    data["bodies"][0] |= {"feeding": "darcy"}
    if not lid:
        data = merged(data, {"materials": {"alloy": RUNNING}})
    shared, alone = final_state(comm, data), final_state(MPI.COMM_SELF, data)
    for name in ("pressure", "solid_fraction", "melt_suction"):
        values = nodal(alone, "casting", name)
        np.testing.assert_allclose(
            nodal(shared, "casting", name), values, atol=1e-7 * np.abs(values).max()
        )
    assert alone.totals[f"casting.{'unfed_volume' if lid else 'level_drop.free'}"] > 0.0
    for name, value in alone.totals.items():
        if name.startswith("casting.") and name.split(".")[1] in (*LEDGER, "level_drop"):
            assert shared.totals[name] == pytest.approx(value, rel=1e-6, abs=1e-15), name


@pytest.mark.ranks
def test_walls_let_go_of_mush_alike_on_all_ranks(comm):
    """A cylinder of AlSi7Mg that its top feeds, until its skin has left the mould."""
    data = cylinder({"time": {"end": 24.0}}, TIGHT, size=0.01)
    data["bodies"][0] |= {
        "material": "AlSi7Mg", "law": "thermo-elasto-viscoplastic", "temperature": 640.0,
        "feeding": "darcy",
    }  # fmt: skip
    data |= {"loads": {"gravity": [0.0, -GRAVITY]}, "foundry": {"feeders": ["casting/top"]}}
    shared, alone = final_state(comm, data), final_state(MPI.COMM_SELF, data)
    opened = fields(alone)["casting/mould gap"]
    assert opened.max() > 1e-6
    for name, values in fields(alone).items():
        np.testing.assert_allclose(
            fields(shared)[name], values, atol=1e-6 * np.abs(values).max(), err_msg=name
        )


@pytest.mark.parametrize("gap", [0.0, 10e-3])
def test_feeders_that_communicate(comm, tmp_path, gap):
    """Areas of 4 to 1, levels of 50 and 50, or 40, mm: the narrow one rises in the end.

    Arms of a metre let all flow.
    """
    if comm.rank == 0:
        two_risers.write(tmp_path / "risers.msh", narrow=5 - round(gap / two_risers.GRID))
    folder = comm.bcast(tmp_path)
    demand = 2e-4
    volume = two_risers.volume(5 - round(gap / two_risers.GRID))
    contraction = demand / volume / 0.5
    metal = METAL | {
        "latent_heat": 4e5, "density": DENSITY, "arm_spacing": 1.0,
        "solidification_shrinkage": contraction / (1 + contraction),
    }  # fmt: skip
    data = {
        "geometry": {"file": str(folder / "risers.msh"), "model": "plane-strain"},
        "materials": {"alloy": metal},
        "bodies": [{"name": "casting", "material": "alloy", "feeding": "darcy",
                    "temperature_history": [[0.0, 550.0], [1.0, 525.0]]}],
        "boundaries": [{"on": "casting/wall", "displacement": {"x": 0.0, "y": 0.0}}],
        "loads": {"gravity": [0.0, -GRAVITY]},
        "foundry": {"feeders": ["casting/wide", "casting/narrow"]},
        "time": {"end": 1.0, "first_step": 0.5, "largest_step": 0.5},
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-12},
    }  # fmt: skip
    for state in states(comm, data):
        last = dict(state.totals)
    drops = [last[f"casting.level_drop.{name}"] for name in ("wide", "narrow")]
    levels = np.array([50e-3, 50e-3 - gap])
    level, given = communicating(two_risers.AREAS, levels, demand)
    np.testing.assert_allclose(levels - drops, level, rtol=1e-8)
    np.testing.assert_allclose(np.multiply(drops, two_risers.AREAS), given, rtol=1e-6)
    assert last["casting.fed_volume"] == pytest.approx(demand, rel=1e-8)


@pytest.mark.ranks
def test_a_run_goes_on_as_if_it_had_not_stopped(comm):
    """From the middle of freezing, with pores, arms that coarsen and a level that sinks."""
    data = chilled({"geometry": {"size": 0.02, "lid": False}, "time": {"end": 40.0}}, MUSH,
                   {"materials": {"alloy": RUNNING}})  # fmt: skip
    data["bodies"][0] |= {"feeding": "darcy"}
    found, last = gone_on(comm, data)
    for name in (*LEDGER, "pocket_pressure", "level_drop.free"):
        key = f"casting.{name}"
        assert last[key] == pytest.approx(found[-1][key], rel=1e-9, abs=1e-18), name
    assert last["casting.level_drop.free"] > 0.0
