"""Bars clamped by a machine of force F and stiffness k, heated and pressed: exact stresses.

A bar of length L, held at one end and clamped at the other, has u = L (σ/E' + e), with E' and e by
its sides: free, held in one direction, or in both. Its stress is that of two springs in series,

    σ A = -(F + k u)   so that   σ = -(F/A + k L e/A)/(1 + k L/(E' A)),

for F = 0 and free sides σ = -E α ΔT/(1 + E A/(k L)).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.proof.verification.solids.viscoplastic_bars import KINDS, LENGTH, Kind, bar
from tests import coupled_cases
from tests.coupled_cases import merged

YOUNG, POISSON, EXPANSION = 70e9, 0.33, 2e-5
HEATING = 100.0
METAL = {"young_modulus": YOUNG, "poisson_ratio": POISSON, "expansion": EXPANSION}
AREA = {"3d": 1e-4, "axisymmetric": np.pi * 1e-4}
"""Of the bars in space and of the rod; the others have 0.01 m² for a metre of depth."""
SIDES = {
    "free": (YOUNG, EXPANSION * HEATING),
    "held in one direction": (YOUNG / (1 - POISSON**2), (1 + POISSON) * EXPANSION * HEATING),
    "held": (
        YOUNG * (1 - POISSON) / (1 + POISSON) / (1 - 2 * POISSON),
        (1 + POISSON) / (1 - POISSON) * EXPANSION * HEATING,
    ),
}
"""Modulus E' along a bar and its free elongation e, by what its sides may do."""


def area_of(kind: Kind) -> float:
    return AREA.get(kind.model, 0.01)


def clamped(kind: Kind, clamp: Any, *changes: Any, heating: float = HEATING) -> dict[str, Any]:
    """Return a bar that is heated in one step, with a clamp in place of its moved end."""
    warm = [[0.0, 20.0], [1.0, 20.0 + heating]]
    case = bar(kind, METAL, "thermo-elastic", warm, [[0.0, 0.0]], end=1.0, steps=1)
    *held, end = case["boundaries"]
    case["boundaries"] = [*held, {"on": end["on"], "clamp": clamp}]
    for change in changes:
        case = merged(case, change)
    return case


def last(comm: Any, case: dict[str, Any]) -> tuple[FloatArray, dict[str, float]]:
    """Run a case and return the stresses of all cells and the totals at its end."""
    state = coupled_cases.final_state(comm, case)
    assert state.counters.cutbacks == 0
    owned = state.mesh.bodies["casting"].cell_numbering.owned
    stress = state.cellwise("casting", "stress")[:owned]
    return np.concatenate(comm.allgather(stress)), dict(state.totals)


def expected(kind: Kind, force: float, stiffness: float, sides: str) -> tuple[float, float]:
    """Return stress and elongation of a clamped bar."""
    (modulus, strain), area = SIDES[sides], area_of(kind)
    stress = -(force + stiffness * LENGTH * strain) / area
    stress /= 1 + stiffness * LENGTH / (modulus * area)
    return stress, LENGTH * (stress / modulus + strain)


def compare(comm: Any, kind: Kind, case: dict[str, Any], exact: tuple[float, float]) -> None:
    stress, elongation = exact
    end = case["boundaries"][-1]["on"]
    found, totals = last(comm, case)
    along = found[:, 1 if kind.model == "axisymmetric" else 0]
    np.testing.assert_allclose(along, stress, rtol=1e-6)
    assert totals[f"{end}.clamp_force"] == pytest.approx(-stress * area_of(kind), rel=1e-6)
    assert totals[f"{end}.clamp_displacement"] == pytest.approx(elongation, rel=1e-6)
    assert totals["casting.force_error"] < 1e-6
    assert totals["support_force"] < 1e-6 * abs(stress) * area_of(kind)


def direction(kind: Kind) -> str:
    return "z" if kind.model == "axisymmetric" else "x"


STIFFNESS = 0.7 * YOUNG * 0.01 / LENGTH
"""Of the machine behind a metre of depth: 0.7 times that of the bar."""


@pytest.mark.serial  # ranks agree in the test of force and stiffness together
@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_a_heated_bar_against_the_machine(comm, kind):
    """σ = -E α ΔT/(1 + E A/(k L)), by the normal and by the axis, in every formulation."""
    stiffness = STIFFNESS * area_of(kind) / 0.01
    stress = -YOUNG * EXPANSION * HEATING / (1 + YOUNG * area_of(kind) / (stiffness * LENGTH))
    exact = expected(kind, 0.0, stiffness, "free")
    assert exact[0] == pytest.approx(stress, rel=1e-12)
    compare(comm, kind, clamped(kind, {"stiffness": stiffness}), exact)


@pytest.mark.sampled
@pytest.mark.parametrize("name", ["generalised q1p0", "axisymmetric", "space", "plane stress"])
def test_force_and_stiffness_together(comm, name):
    kind = KINDS[name]
    force, stiffness = 60e6 * area_of(kind), STIFFNESS * area_of(kind) / 0.01
    clamp = {"force": force, "stiffness": stiffness, "direction": direction(kind)}
    compare(comm, kind, clamped(kind, clamp), expected(kind, force, stiffness, "free"))


CONFINED = {
    "plane strain": (Kind("plane-strain"), "held in one direction", ()),
    "plane strain q1p0": (
        Kind("plane-strain", "q1p0", cells="quadrilaterals"), "held in one direction", ()
    ),
    "rod in a tube": (Kind("axisymmetric", "displacement"), "held", ("far",)),
    "space": (Kind("3d", stabilisation="gls"), "held", ("top", "front")),
}  # fmt: skip
"""Bars with held sides: model, what the sides do, and the sides that are held besides."""


@pytest.mark.serial  # ranks agree in the test of force and stiffness together
@pytest.mark.parametrize("kind, sides, held", CONFINED.values(), ids=CONFINED)
def test_held_sides(comm, kind, sides, held):
    force, stiffness = 30e6 * area_of(kind), STIFFNESS * area_of(kind) / 0.01
    case = clamped(kind, {"force": force, "stiffness": stiffness})
    fixed = [{"on": f"casting/{side}", "displacement": {"normal": 0.0}} for side in held]
    case["boundaries"] = [*fixed, *case["boundaries"]]
    compare(comm, kind, case, expected(kind, force, stiffness, sides))


@pytest.mark.serial  # ranks agree in the test of force and stiffness together
def test_every_number_of_the_clamp_counts(comm):
    """Force, stiffness and direction change the answer, and a table is followed in time."""
    kind = KINDS["generalised displacement"]
    force, stiffness = 50e6 * area_of(kind), STIFFNESS
    for clamp in (
        {"force": force},
        {"force": force, "stiffness": stiffness},
        {"force": 2 * force, "stiffness": stiffness},
        {"force": force, "stiffness": 2 * stiffness},
    ):
        exact = expected(kind, clamp["force"], clamp.get("stiffness", 0.0), "free")
        compare(comm, kind, clamped(kind, clamp), exact)
    halfway = clamped(kind, {"force": [[0.0, 0.0], [2.0, f"{2 * force / 1e3} kN"]]})
    compare(comm, kind, halfway, expected(kind, force, 0.0, "free"))
