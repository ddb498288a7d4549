"""A die pressed onto its mould by a machine of force F and stiffness k, and blown off by a fluid.

Two blocks of the same breadth with free sides, heights h and H, pressed together at the top. A
fluid of force P fills the joint on both sides. As long as they touch, both blocks bear

    S = F/(1 + k (h + H)/(E' A)),

of which the joint bears R = S - P. Beyond P = S it opens: the die has then moved by (P - F)/k and
the gap is (P - F)/k + P (h + H)/(E' A).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from castx.command.cli import execute
from castx.results.reading import Results
from tests import coupled_cases
from tests.castx.mutations import toml
from tests.contact_methods import AT_ONCE, IN_THE_LIMIT, sharp
from tests.coupled_cases import merged

YOUNG, POISSON, HEIGHT, HALF = 70e9, 0.33, 0.02, 0.01
PRESSURE = 20e6  # of the clamp at rest


class Press(NamedTuple):
    """A model of the press: formulation of the die, area, modulus along it, vertical axis."""

    model: str
    formulation: str
    cells: str
    area: float
    modulus: float
    up: str

    @property
    def stiffness(self) -> float:
        """Half of that of both blocks together [N/m]."""
        return 0.5 * self.modulus * self.area / (2 * HEIGHT)


MODELS = (
    ("plane-strain", HALF, YOUNG / (1 - POISSON**2), "y"),
    ("axisymmetric", np.pi * HALF**2, YOUNG, "z"),
    ("3d", HALF**2, YOUNG, "z"),
)
KINDS = {"mixed": "simplices", "displacement": "simplices", "q1p0": "quadrilaterals"}
PRESSES = {
    f"{model} {formulation}": Press(model, formulation, cells, area, modulus, up)
    for model, area, modulus, up in MODELS
    for formulation, cells in KINDS.items()
}


def case(press: Press, clamp: Any, fluid: Any = 0.0, *changes: Any, **contact: Any) -> Any:
    """Return the case of three steps, at default settings of the solvers."""
    depth = [2 * HALF] if press.model == "3d" else []
    size = [2 * HALF, HEIGHT, *depth]
    metal = {"young_modulus": YOUNG, "poisson_ratio": POISSON, "expansion": 1e-5, "density": 1.0}
    same = {"material": "metal", "temperature": 20.0, "formulation": press.formulation,
            "stabilisation": "gls"}  # fmt: skip
    data = {
        "geometry": {"generator": "stacked_blocks", "model": press.model, "cells": press.cells,
                     "upper": size, "base": size, "size": 0.01},
        "materials": {"metal": metal},
        "bodies": [{"name": "upper", **same}, {"name": "base", **same}],
        "interfaces": [{"bodies": ["upper", "base"], "contact": contact}],
        "boundaries": [
            {"on": "upper/top", "clamp": clamp},
            {"on": "base/bottom", "displacement": {"normal": 0.0}},
            {"on": "upper/base", "pressure": fluid},
            {"on": "base/upper", "pressure": fluid},
        ],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": 3.0, "fixed_step": 1.0},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data


def results(comm: Any, data: Any) -> list[dict[str, float]]:
    """Return the totals after each step."""
    found = []
    for state in coupled_cases.states(comm, data):
        assert state.counters.cutbacks == 0
        found.append(dict(state.totals))
    return found[1:]


FLUID = [[0.0, 0.0], [1.0, 8e6], [2.0, 30e6], [3.0, 5e6]]
"""Its pressure over time [Pa]: the joint stays closed, opens and closes again."""


def check(comm: Any, press: Press, data: Any) -> None:
    """Compare a press that opens and closes with the exact answer."""
    clamp = data["boundaries"][0]["clamp"]
    force, k = float(clamp["force"]), float(clamp["stiffness"])
    area = press.area
    yielding = 2 * HEIGHT / (press.modulus * area)
    opened = []
    for found, (_, pressure) in zip(results(comm, data), FLUID[1:], strict=True):
        fluid, closed = pressure * area, force / (1 + k * yielding)
        opens = fluid > closed
        opened.append(opens)
        borne = fluid if opens else closed
        moved = (borne - force) / k
        scale = abs(moved) + force / k
        assert found["upper/top.clamp_force"] == pytest.approx(borne, rel=1e-6)
        assert found["upper/top.clamp_displacement"] == pytest.approx(moved, abs=1e-6 * scale)
        joint = found[f"upper/base.force.{press.up}"]
        assert joint == pytest.approx(max(closed - fluid, 0.0), abs=1e-6 * force)
        gap = moved + fluid * yielding if opens else 0.0
        for name in ("mean_gap", "max_gap"):
            assert found[f"upper/base.{name}"] == pytest.approx(gap, rel=1e-6, abs=1e-6 * scale)
        assert found["upper/base.closed_fraction"] == (0.0 if opens else 1.0)
        assert max(found["upper.force_error"], found["base.force_error"]) < 1e-6
        assert found["support_force"] < 1e-6 * force
    assert opened == [False, True, False]


SHARED = ("3d mixed", "axisymmetric q1p0", "plane-strain displacement")
"""Presses that several ranks share."""


def clamp_of(press: Press) -> dict[str, float]:
    return {"force": PRESSURE * press.area, "stiffness": press.stiffness}


@pytest.mark.ranks
@pytest.mark.sampled
@pytest.mark.parametrize(
    "press",
    [
        pytest.param(press, id=name, marks=() if name in SHARED else pytest.mark.serial)
        for name, press in PRESSES.items()
    ],
)
def test_a_fluid_opens_a_press(comm, press):
    check(comm, press, case(press, clamp_of(press), FLUID))


@pytest.mark.serial  # ranks agree in the test above
@pytest.mark.parametrize("method", sharp(IN_THE_LIMIT))
@pytest.mark.parametrize("linear", ["direct", "iterative"])
def test_every_contact_method_and_linear_solver(comm, method, linear):
    press = PRESSES["3d mixed"]
    exact = {"solver": {"linear": linear, "mechanics_tolerance": 1e-8}}
    check(comm, press, case(press, clamp_of(press), FLUID, exact, method=method))


@pytest.mark.serial  # the resultant of the joint; ranks agree in the first test
@pytest.mark.parametrize("method", AT_ONCE)
def test_contact_bears_a_dead_load(comm, method):
    """Whatever the blocks and the method yield, the joint bears F."""
    press = PRESSES["plane-strain mixed"]
    exact = {"solver": {"mechanics_tolerance": 1e-8}}
    force = PRESSURE * press.area
    for found in results(comm, case(press, {"force": force}, 0.0, exact, method=method)):
        assert found["upper/base.force.y"] == pytest.approx(force, rel=1e-6)
        assert found["upper/top.clamp_force"] == pytest.approx(force, rel=1e-12)


@pytest.mark.serial
def test_a_dead_load_on_a_rigid_mould(comm):
    press = PRESSES["axisymmetric mixed"]
    data = case(press, {"force": [[0.0, 0.0], [3.0, "9 kN"]]}, 0.0, method="rigid")
    data["bodies"][1] = {"name": "base", "material": "metal", "temperature": 20.0, "law": "rigid"}
    data["boundaries"] = [b for b in data["boundaries"] if "pressure" not in b]
    joint = [found["upper/base.force.z"] for found in results(comm, data)]
    assert joint == pytest.approx([3e3, 6e3, 9e3], rel=1e-6)


WHOLE = ("upper/top.clamp_force", "upper/base.force.z")
"""Totals of which a quarter has a fourth."""


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize("kind", ["displacement", "mixed"])
def test_a_quarter_takes_a_quarter_of_the_clamp(comm, kind):
    """A bottom that sticks makes stresses and the motion of the top uneven."""
    press = PRESSES[f"3d {kind}"]
    held = {"on": "base/bottom", "displacement": {"all": 0.0}}
    found = {}
    for symmetry, share in ((True, 1.0), (False, 4.0)):
        force, stiffness = clamp_of(press).values()
        clamp = {"force": share * force, "stiffness": share * stiffness}
        exact = {"solver": {"linear": "direct", "mechanics_tolerance": 1e-10},
                 "geometry": {"symmetry": symmetry, "upper": [0.02, 0.02, 0.02],
                              "base": [0.04, 0.02, 0.04]}}  # fmt: skip
        data = case(press, clamp, 0.0, exact)
        data["boundaries"][1] = held
        *_, found[symmetry] = results(comm, data)
    quarter, full = found[True], found[False]
    moved = quarter["upper/top.clamp_displacement"]
    assert full["upper/top.clamp_displacement"] == pytest.approx(moved, rel=1e-6)
    for name in WHOLE:
        assert full[name] == pytest.approx(4 * quarter[name], rel=1e-6)
    assert quarter["upper/top.clamp_force"] < 0.9 * force
    assert quarter["upper/base.force.z"] == pytest.approx(quarter[WHOLE[0]], rel=1e-6)


@pytest.mark.serial
def test_a_press_closes_and_opens_by_stages(comm):
    """Open, clamped, a softer clamp, open: free again, and columns from the start."""
    press = PRESSES["plane-strain mixed"]
    force, stiffness = clamp_of(press).values()
    stages = [
        {"at": time, "boundaries": [{"on": "upper/top", "clamp": clamp}]}
        for time, clamp in (
            (1.0, {"force": force, "stiffness": stiffness}),
            (2.0, {"force": force / 2}),
            (3.0, "free"),
        )
    ]
    data = case(press, None, 0.0, {"stages": stages, "time": {"end": 4.0}})
    del data["boundaries"][0]
    found = results(comm, data)
    assert len({frozenset(totals) for totals in found}) == 1
    yielding = 2 * HEIGHT / (press.modulus * press.area)
    closed = force / (1 + stiffness * yielding)
    expected = [0.0, closed, force / 2, 0.0]
    for name in ("upper/top.clamp_force", "upper/base.force.y"):
        assert [t[name] for t in found] == pytest.approx(expected, rel=1e-6, abs=1e-6 * force)
    moved = [totals["upper/top.clamp_displacement"] for totals in found]
    expected = [-borne * yielding for borne in expected]
    assert moved == pytest.approx(expected, rel=1e-6, abs=1e-6 * force * yielding)


@pytest.mark.serial
def test_a_rigid_plate_of_the_machine(comm):
    """With a uniform displacement the top stays plane, where a soft one bulges; F stays F."""
    press = PRESSES["plane-strain mixed"]
    bulges = []
    for plate in ({}, {"displacement": {"normal": "uniform"}}):
        data = case(press, {"force": PRESSURE * press.area}, 0.0,
                    {"geometry": {"base": [0.04, HEIGHT]}})  # fmt: skip
        data["boundaries"] = [{**data["boundaries"][0], **plate}, *data["boundaries"][1:2]]
        state = coupled_cases.final_state(comm, data)
        assert state.totals["upper/base.force.y"] == pytest.approx(2e5, rel=1e-6)
        points = coupled_cases.places(state, "upper")
        top = state.nodal("upper", "displacement")[: len(points)][points[:, 1] > 0.999 * HEIGHT]
        heights = np.concatenate(comm.allgather(top[:, 1]))
        bulges.append(np.ptp(heights) / np.abs(heights).max())
    assert bulges[0] > 1e-2 and bulges[1] < 1e-9


WEIGHT = 7800.0 * 9.81 * np.pi * HALF**2 * HEIGHT
"""Of the die in the next test [N]."""


def hot_press(clamp: Any) -> dict[str, Any]:
    """Return a heavy die on a casting that cools on its foot, at default settings."""
    data = case(PRESSES["axisymmetric mixed"], clamp)
    data["materials"] = {"aluminium": {**coupled_cases.ALUMINIUM, "stress_free": 400.0},
                         "steel": coupled_cases.STEEL}  # fmt: skip
    die, casting = data["bodies"]
    data["bodies"] = [
        {**die, "material": "steel", "temperature": 150.0, "formulation": "displacement"},
        {**casting, "material": "aluminium", "temperature": 400.0},
    ]
    data["interfaces"][0]["heat"] = {"law": "limited", "closed": 2000.0, "gas_conductivity": 0.05}
    data["loads"] = {"gravity": [0.0, 0.0, -9.81]}
    del data["coupling"], data["boundaries"][2:]
    data["time"] = {"end": 2.0, "first_step": 0.5, "largest_step": 1.0}
    return data


def test_a_run_of_the_command_line_at_default_settings(comm, shared_tmp_path):
    """The joint bears clamp and weight at every step; a casting that shrinks eases the clamp."""
    file, folder = shared_tmp_path / "press.toml", shared_tmp_path / "out"
    force, stiffness = 2e3, 5e7
    if comm.rank == 0:
        file.write_text(toml(hot_press({"force": force, "stiffness": stiffness})))
    comm.Barrier()
    assert execute(["run", str(file), "--output", str(folder)], comm) == 0
    history = Results(folder).history
    pressed, moved = (history[f"upper/top.clamp_{n}"][1:] for n in ("force", "displacement"))
    joint = history["upper/base.force.z"][1:]
    assert len(joint) > 1
    np.testing.assert_allclose(joint, pressed + WEIGHT, rtol=1e-6)
    np.testing.assert_allclose(pressed, force + stiffness * moved, rtol=1e-9)
    assert pressed.max() < 0.95 * force
    assert max(history["upper.force_error"][-1], history["base.force_error"][-1]) < 1e-6


@pytest.mark.serial
def test_a_ring_squeezed_along_an_axis(comm):
    """Along x its ends on x come nearer and those on y part; along y it is the mirror image."""
    ring = {
        "geometry": {"generator": "core_in_ring", "model": "plane-strain", "core_radius": 0.03,
                     "outer_radius": 0.04, "height": 0.01, "size": 0.005,
                     "cells": "quadrilaterals"},
        "materials": {"metal": {"young_modulus": YOUNG, "poisson_ratio": POISSON}},
        "bodies": [{"name": name, "material": "metal", "temperature": 20.0, "law": law}
                   for name, law in (("casting", "thermo-elastic"), ("core", "rigid"))],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": 1.0, "fixed_step": 1.0},
    }  # fmt: skip
    ends, totals = {}, {}
    for axis in "xy":
        clamp = {"force": "20 kN", "stiffness": "0.1 MN/mm", "direction": axis}
        state = coupled_cases.final_state(
            comm, {**ring, "boundaries": [{"on": "casting/outside", "clamp": clamp}]}
        )
        places = ((0.04, 0.0), (0.0, 0.04))
        moved = [coupled_cases.value_at(state, "casting", "displacement", *p) for p in places]
        ends[axis], totals[axis] = [float(u[i]) for i, u in enumerate(moved)], state.totals
    assert ends["x"][0] < 0.0 < ends["x"][1]
    assert ends["y"] == pytest.approx(ends["x"][::-1], rel=1e-6)
    for name in ("clamp_force", "clamp_displacement"):
        mirrored = totals["y"][f"casting/outside.{name}"]
        assert totals["x"][f"casting/outside.{name}"] == pytest.approx(mirrored, rel=1e-6)
    assert totals["x"]["casting/outside.clamp_force"] < 0.99 * 20e3
