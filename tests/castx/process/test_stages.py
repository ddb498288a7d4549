"""Stages of a process: what goes on, what is gone, what comes back new."""

from __future__ import annotations

import gmsh
import numpy as np
import pytest

from castx.checkpoint.file import Checkpoint
from castx.errors import CaseError
from castx.proof.verification import states as everywhere
from tests.contact_methods import AT_ONCE
from tests.coupled_cases import (
    TIGHT,
    cylinder,
    fields,
    final_state,
    gone_on,
    largest_difference,
    merged,
    nodal,
    simulation,
    states,
)

AIR = {"type": "convection", "coefficient": 50.0, "ambient": 20.0}
RADIANT = {"type": "radiation", "emissivity": 0.8, "ambient": 20.0}
OPENING = {"at": 3.0, "remove": ["mould"]}
BARE = {**OPENING, "boundaries": [{"on": "casting/mould", "heat": AIR}]}
FLOWING = {
    "solidus": 640.0,
    "liquid": {"model": "viscous", "viscosity": 1e6, "coherency": 0.6},
    "yield_stress": [[20.0, 60e6], [640.0, 1e6]],
    "hardening": 500e6,
    "viscosity": 1e8,
}


def short(*stages, method: str = "condensed", **changes) -> dict:
    """Return the coarse cylinder of 5 s with stages; the casting is solid, but hot."""
    time = {"end": 5.0, "first_step": 0.25, "largest_step": 1.0}
    data = cylinder({"time": time, "stages": list(stages)}, changes, method=method, size=0.01)
    data["bodies"][0]["temperature"] = 650.0
    return data


def freezing(*stages, **changes) -> dict:
    """Return the same with a casting that starts as a liquid and creeps."""
    data = merged(short(*stages, **changes), {"materials": {"aluminium": FLOWING}})
    data["bodies"][0] |= {"temperature": 670.0, "law": "thermo-elasto-viscoplastic"}
    return data


def thermal(*stages, **changes) -> dict:
    return short(*stages, coupling={"scheme": "thermal"}, **changes)


@pytest.mark.sampled
@pytest.mark.parametrize(
    "method",
    ["condensed", *(pytest.param(m, marks=pytest.mark.serial) for m in AT_ONCE[1:])],
)
def test_opening(comm, method):
    """The step lands on the stage; what is removed disappears, its totals stay."""
    before, last = None, None
    seen = []
    for state in states(comm, short(BARE, method=method)):
        seen.append((state.time, state.process.stage, tuple(state.mesh.bodies)))
        totals = dict(state.totals)
        assert totals["energy_error"] < 1e-10
        if state.time == 3.0:
            before = totals
        elif state.process.stage == 1:
            last = totals
            assert list(state.pairs) == []
    assert (3.0, 0, ("casting", "mould")) in seen
    assert {bodies for time, stage, bodies in seen if stage == 1} == {("casting",)}
    assert all(stage == (time > 3.0) for time, stage, _ in seen)
    assert before is not None and last is not None and last.keys() == before.keys()
    for axis in "rz":
        assert last[f"casting/mould.force.{axis}"] == 0.0
    for name in ("mould.enthalpy", "mould.heat_in", "casting/mould.heat", "mould.solid_fraction"):
        assert last[name] == before[name], name
    for name in ("mould.power", "casting/mould.power", "casting/mould.closed_fraction"):
        assert last[name] == 0.0, name
    assert np.isnan(last["casting/mould.max_gap"]) and np.isnan(last["casting/mould.mean_gap"])
    lost = before["casting.enthalpy"] - last["casting.enthalpy"]
    assert lost == pytest.approx(-last["casting/mould.surface.heat"], rel=1e-9)
    assert last["casting/mould.surface.power"] < 0.0


@pytest.mark.serial
def test_a_stage_that_changes_nothing_changes_nothing(comm):
    """Everything a body remembers goes on: a spray of no coefficient, in the midst of freezing."""
    idle = {"at": 3.0, "boundaries": [{"on": "casting/top", "heat": {"type": "insulated"}}]}
    data = merged(freezing(), TIGHT)
    data["time"] = {"end": 5.0, "fixed_step": 0.5, "heat_substeps": 2}
    plain = final_state(comm, data)
    staged = final_state(comm, merged(data, {"stages": [idle]}))
    difference, where = largest_difference(fields(staged), fields(plain))
    assert difference < 1e-9, where
    assert staged.process.stage == 1
    for name in ("casting.enthalpy", "casting/mould.heat", "casting.dissipation"):
        assert staged.totals[name] == pytest.approx(plain.totals[name], rel=1e-9), name


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize("coefficient", [100.0, 3000.0])
def test_a_spray_cools_as_convection_does(comm, coefficient):
    """By default it cools what the mould has left bare, and by the name of a body all of it."""
    heat = {"type": "convection", "coefficient": coefficient, "ambient": 20.0}
    spray = {"coefficient": coefficient, "ambient": 20.0}
    bare = ({"on": "casting/mould", "heat": heat},)
    around = (*bare, *({"on": f"casting/{name}", "heat": heat} for name in ("base", "top")))
    for wet, on in ((bare, []), (around, ["casting"])):
        by_hand = final_state(comm, thermal({**OPENING, "boundaries": list(wet)}))
        sprayed = final_state(comm, thermal({**OPENING, "spray": {**spray, "on": on}}))
        found = nodal(sprayed, "casting", "temperature")
        np.testing.assert_array_equal(found, nodal(by_hand, "casting", "temperature"))
    dry = nodal(final_state(comm, thermal(OPENING)), "casting", "temperature")
    assert dry.min() - found.min() > (3.0 if coefficient < 1000 else 50.0)


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("first", "stage"),
    [
        ([AIR, RADIANT], {"boundaries": [{"on": "casting/wall", "heat": AIR}]}),
        (AIR, {"boundaries": [{"on": "casting/wall", "heat": [AIR, RADIANT]}]}),
        ([AIR, RADIANT], {"spray": {"coefficient": 2e3, "ambient": 20.0, "on": ["casting/wall"]}}),
        (RADIANT, {"spray": {"coefficient": 2e3, "ambient": 20.0, "on": ["casting/wall"]}}),
    ],
)
def test_heat_by_type_adds_up_to_that_of_a_surface_in_all_stages(comm, first, stage):
    """Whatever the stages change, and in a run that goes on from the middle too."""
    data = {
        "geometry": {
            "generator": "slab", "model": "plane-strain",
            "length": 0.01, "width": 0.01, "size": 5e-3,
        },
        "bodies": [{"name": "casting", "material": "steel-H13", "temperature": 500.0}],
        "boundaries": [{"on": "casting/wall", "heat": first}],
        "coupling": {"scheme": "thermal"},
        "time": {"end": 40.0, "fixed_step": 10.0},
        "stages": [{"at": 20.0, **stage}],
    }  # fmt: skip
    found, restored = gone_on(comm, data)
    assert len({tuple(totals) for totals in found}) == 1
    assert restored == pytest.approx(found[-1], rel=1e-9, abs=1e-9)
    for totals in found[1:]:
        for name in ("casting/wall.heat", "casting/wall.power"):
            parts = [totals[f"{name}.{one}"] for one in ("convection", "radiation")]
            assert totals[name] < 0.0 and sum(parts) == pytest.approx(totals[name], rel=1e-12)


@pytest.mark.parametrize("gravity", [pytest.param(0.0, marks=pytest.mark.serial), 9.81])
def test_a_casting_without_mould_stays_where_it_is(comm, gravity):
    """The support carries its weight and nothing else, and does not let it move."""
    lifted = {
        **BARE,
        "boundaries": [*BARE["boundaries"], {"on": "casting/base", "displacement": "free"}],
    }
    data = merged(short(lifted), {"loads": {"gravity": [0.0, 0.0, -gravity]}})
    heights = {}
    for state in states(comm, data):
        force, weights = state.totals["support_force"], state.problem.volumes["casting"]
        u = state.nodal("casting", "displacement")[: len(weights), 1]
        mean = comm.allreduce(float(weights @ u)) / comm.allreduce(float(weights.sum()))
        heights[state.time] = mean
    volume = comm.allreduce(float(weights.sum()))
    assert force == pytest.approx(2700.0 * gravity * volume, abs=1e-6)
    assert abs(heights[5.0] - heights[3.0]) < 1e-8
    assert abs(heights[3.0]) > 1e-7


CYCLES = {"at": 4.0, "repeat": 3, "renew": ["casting"]}
COOLED = [
    {"on": "mould/outside", "heat": {"type": "convection", "coefficient": 5e4, "ambient": 200.0}}
]


def cycling(*stages, **changes) -> dict:
    data = short(*stages, **changes)
    data["time"]["end"] = 4.0
    data["materials"]["steel"]["stress_free"] = 200.0
    data["boundaries"] = data["boundaries"] + COOLED
    return data


@pytest.mark.serial
def test_what_is_renewed_begins_again(comm):
    """If all bodies are renewed, each cycle is the first one."""
    spray = {"at": 3.0, "remove": ["casting"], "spray": {"coefficient": 2e3, "ambient": 20.0}}
    found = []
    for state in states(comm, cycling(spray, {**CYCLES, "renew": ["casting", "mould"]})):
        if state.time in (3.0, 7.0, 11.0):
            found.append(fields(state))
        assert state.totals["energy_error"] < 1e-10
    assert state.time == 12.0 and len(found) == 3
    for again in found[1:]:
        difference, where = largest_difference(again, found[0])
        assert difference < 1e-6, where
    assert state.totals["casting.renewal"] == pytest.approx(
        -2 * (state.totals["casting.heat_in"] - state.totals["casting.renewal"]) / 3, rel=1e-6
    )


@pytest.mark.ranks
def test_a_new_casting_fits_into_the_mould_as_it_is(comm):
    """The mould keeps temperature and displacement; the gaps of the new casting begin at zero."""
    data = cycling({"at": 3.0, "remove": ["casting"]}, {**CYCLES, "repeat": 2})
    data["time"]["first_step"] = 0.01
    for state in states(comm, data):
        if state.step == 1:
            first = state.totals["casting/mould.max_gap"]
        if state.time == 4.0:
            moved = nodal(state, "mould", "displacement")
            hot = nodal(state, "mould", "temperature")
        if state.time > 4.0:
            break
    assert np.abs(moved).max() > 1e-5 and hot.max() > 210.0
    # Of the casting's own thermal strain, not of the mould's motion.
    assert abs(state.totals["casting/mould.max_gap"] - first) < 0.02 * np.abs(moved).max()
    assert np.abs(nodal(state, "mould", "displacement") - moved).max() < 0.05 * np.abs(moved).max()
    assert np.abs(nodal(state, "mould", "temperature") - hot).max() < 10.0
    assert nodal(state, "casting", "temperature").min() > 600.0


@pytest.mark.ranks
def test_a_mould_that_comes_back_is_as_it_left(comm):
    for state in states(comm, cycling(OPENING, {**CYCLES, "repeat": 2})):
        if state.time == 3.0:
            left = {name: nodal(state, "mould", name) for name in ("temperature", "displacement")}
            heat = state.totals["mould.enthalpy"]
        if state.time == 4.0:
            assert state.totals["mould.enthalpy"] == heat
        if state.time > 4.0:
            break
    assert state.process.renewed == {"casting"} and list(state.mesh.bodies) == ["casting", "mould"]
    assert state.totals["mould.heat_in"] > heat - state.totals["mould.enthalpy"]
    change = np.abs(nodal(state, "mould", "temperature") - left["temperature"])
    assert change.min() < 1.0 and change.max() < 60.0
    assert np.abs(left["displacement"]).max() > 1e-6


@pytest.mark.serial
def test_tables_count_from_the_start_of_the_cycle(comm):
    """A heat source that works in the first second of each cycle."""
    data = thermal({"at": 2.0, "repeat": 3})
    data["bodies"][0]["heat_source"] = [[0.0, 1e8], [1.0, 1e8], [1.001, 0.0]]
    data["time"] = {"end": 2.0, "fixed_step": 0.25}
    given = {}
    for state in states(comm, data):
        given[state.time] = state.totals["casting.source"]
    assert given[3.0] - given[2.0] == pytest.approx(given[1.0], rel=2e-3)
    assert given[6.0] - given[5.0] < 1e-3 * given[1.0]


@pytest.mark.serial
def test_rigid_moulds_may_be_all_that_is_left(comm):
    """Nothing deforms then; the rigid body still heats and cools, and the casting comes back."""
    spray = {"at": 3.0, "remove": ["casting"], "spray": {"coefficient": 2e3, "ambient": 20.0}}
    data = cycling(spray, {**CYCLES, "repeat": 2})
    data["bodies"][1] = {"name": "mould", "material": "steel", "temperature": 200.0, "law": "rigid"}
    seen = set()
    for state in states(comm, data):
        seen.add((state.process.cycle, state.process.stage))
        assert state.totals["energy_error"] < 1e-10
        assert not state.nodal("mould", "displacement").any()
        assert not state.cellwise("mould", "von_mises").any()
    assert seen == {(1, 0), (1, 1), (2, 0), (2, 1)} and state.time == 8.0
    assert state.totals["mould/casting.surface.heat"] < 0.0


LAWS = {
    "opening": (short(BARE), 4.0),
    "before": (short(BARE), 3.0),
    "cycle": (cycling({"at": 3.0, "remove": ["casting"]}, CYCLES), 4.5),
    "away": (cycling(OPENING, CYCLES), 7.5),
    "floating": (
        merged(
            short({**OPENING, "boundaries": [{"on": "casting/base", "displacement": "free"}]}),
            {"loads": {"gravity": [0.0, 0.0, -9.81]}},
        ),
        4.0,
    ),
    "thermal": (thermal(BARE), 4.0),
    "freezing": (merged(freezing(BARE), {"geometry": {"cells": "quadrilaterals"}}), 4.0),
}


ON_ALL_RANKS = ("away", "freezing")


@pytest.mark.sampled
@pytest.mark.parametrize(
    "name",
    [n if n in ON_ALL_RANKS else pytest.param(n, marks=pytest.mark.serial) for n in LAWS],
)
def test_runs_go_on_in_any_stage(name, comm, shared_tmp_path):
    data, at = LAWS[name]
    data = merged(data, TIGHT)
    checkpoint, header = Checkpoint(shared_tmp_path, comm), {}
    run = simulation(comm, data)
    for state in run:
        if state.time >= at and not header:
            header = run.notes()
            checkpoint.write(run.saved(), header)
    whole, totals = fields(state), dict(state.totals)
    events = state.process.events
    run.destroy()
    again = simulation(comm, data)
    found = checkpoint.read_header()
    again.prepare(found)
    again.restore(checkpoint.read(found, again.saved()))
    *_, last = again
    difference, where = largest_difference(fields(last), whole)
    assert difference < 1e-9, where
    for key, value in totals.items():
        assert last.totals[key] == pytest.approx(value, rel=1e-8, abs=1e-6, nan_ok=True), key
    assert [event["time"] for event in last.process.events] == [event["time"] for event in events]
    again.destroy()


@pytest.mark.serial
def test_another_length_of_the_cycles_is_refused(comm):
    data = cycling({**CYCLES, "at": 3.0, "remove": ["casting"]})
    run, other = (simulation(comm, merged(data, {"time": {"end": end}})) for end in (4.0, 5.0))
    for state in run:
        if state.time > 4.0:
            break
    assert run.notes()["start"] == 4.0
    with pytest.raises(CaseError, match=r"began at 4 s\); undo the change of time\.end"):
        other.prepare(run.notes())
    run.destroy()
    other.destroy()


def draw_three_blocks() -> None:
    """Draw a mould on the left, and a core upon a chill on the right."""
    occ, squares = gmsh.model.occ, ((0, 0, 2), (1, 0, 1), (1, 1, 1))
    made = [(2, occ.addRectangle(x, y, 0, 1, high)) for x, y, high in squares]
    occ.fragment(made, [])
    occ.synchronize()
    for tag, name in zip((1, 2, 3), ("mould", "chill", "core"), strict=True):
        gmsh.model.addPhysicalGroup(2, [tag], name=name)
    for name, high in (("base", 0.0), ("top", 2.0)):
        edges = [
            tag for _, tag in gmsh.model.getEntities(1)
            if np.allclose(gmsh.model.getBoundingBox(1, tag)[1:5:3], high, atol=1e-6)
        ]  # fmt: skip
        gmsh.model.addPhysicalGroup(1, edges, name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
    gmsh.model.mesh.generate(2)


@pytest.mark.ranks
def test_a_tied_node_that_leaves_one_body_holds_on_to_another(comm):
    """A chill is tied to a mould and a core, and one of its nodes to both."""
    metal = {"young_modulus": 1e7, "poisson_ratio": 0.3, "expansion": 0.0, "density": 7000.0}
    tied = {"method": "tied"}
    data = {
        "geometry": {"file": "mesh.msh", "model": "plane-strain"},
        "materials": {"metal": metal},
        "bodies": [
            {"name": name, "material": "metal", "temperature": 20.0}
            for name in ("mould", "chill", "core")
        ],
        "interfaces": [
            {"bodies": ["chill", "mould"], "contact": tied},
            {"bodies": ["chill", "core"], "contact": tied},
        ],
        "boundaries": [
            {"on": "mould/base", "displacement": {"all": 0.0}},
            {"on": "core/top", "displacement": {"all": 0.0}},
        ],
        "loads": {"gravity": [0.0, -9.81]},
        "time": {"end": 2.0, "fixed_step": 0.5},
        "stages": [{"at": 1.0, "remove": ["mould"]}],
        "coupling": {"scheme": "mechanical"},
    }  # fmt: skip
    hung, stages = {}, []
    with everywhere.drawn_mesh(comm, draw_three_blocks) as folder:
        for state in states(comm, data, folder):
            stages.append(state.process.stage)
            values = {}
            for body in ("chill", "core"):
                at = everywhere.places(state, body)
                high = np.isclose(at[:, 1], 1.0)
                order = np.argsort(at[high, 0])
                values[body] = everywhere.nodal(state, body, "displacement")[high][order]
            if state.process.stage == 1:
                assert at[high, 0].min() == pytest.approx(1.0)
                np.testing.assert_allclose(values["chill"], values["core"], atol=1e-15)
                hung[state.time] = values["chill"]
    assert stages[-1] == 1 and 0 in stages
    assert all((u[:, 1] < -1e-4).all() for u in hung.values())
