"""V16: two blocks pressed together (M. Chiumenti, section 10.1).

E 1000 MPa on 10000 MPa, plane strain, ν 0.3, the top displaced by d, so that the reaction is an
answer. For equal widths b and free sides the blocks are springs in series, under a penalty ε with
its layer: F = d b/((1 − ν²)(H1/E1 + H2/E2) + 1/ε). A wider base has no closed form: there methods
that let nothing penetrate have one reaction.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.proof.verification.contact.stacked import over_penalties, stacked_case
from castx.proof.verification.states import pair_areas, paired, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Outcome,
    Resolution,
    Verification,
)

YOUNG = {"upper": 1000e6, "base": 10000e6}
HEIGHT = {"upper": 0.03, "base": 0.02}
POISSON, PUSH = 0.3, 1e-4
HALF_WIDTH, WIDER = 0.01, 0.04
"""Half of the upper block, whose middle is a plane of symmetry; whole width of a wider base [m]."""
PENALTIES = (1e12, 1e13, 1e14)


def reaction(penalty: float = np.inf) -> float:
    """Return the force per depth on half of equal blocks [N/m]; without end for no penetration."""
    layers = sum(HEIGHT[name] / YOUNG[name] for name in YOUNG)
    return PUSH * HALF_WIDTH / ((1 - POISSON**2) * layers + 1 / penalty)


def pressed_case(size: float, width: float, contact: Mapping[str, Any]) -> dict[str, Any]:
    """Return the case of an upper block that is pushed onto a base of a width [m]."""
    blocks = {"upper": (2 * HALF_WIDTH, HEIGHT["upper"]), "base": (width, HEIGHT["base"])}
    return stacked_case(size, blocks, YOUNG, POISSON, PUSH, contact)


def found_reaction(comm: MPI.Intracomm, size: float, width: float, **contact: Any) -> float:
    """Return the sum of the contact forces per depth [N/m]."""
    for state in states(comm, pressed_case(size, width, contact)):
        forces = paired(state, "upper/base", "contact_pressure") * pair_areas(state, "upper/base")
    return float(forces.sum())


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Press blocks of equal and of different widths by all methods."""
    equal = 2 * HALF_WIDTH
    answers = [
        Answer.relative(f"reaction of equal blocks, {method}",
                        found_reaction(comm, at.size, equal, method=method), reaction(), "N/m",
                        1e-9)
        for method in ("condensed", "multipliers")
    ]  # fmt: skip
    soft = [
        found_reaction(comm, at.size, equal, method="penalty", penalty=value) for value in PENALTIES
    ]
    answers += [
        Answer.relative(f"reaction of equal blocks, penalty {value:g} Pa/m", found,
                        reaction(value), "N/m", 1e-8)
        for value, found in zip(PENALTIES, soft, strict=True)
    ]  # fmt: skip
    exact = found_reaction(comm, at.size, WIDER, method="multipliers")
    answers += [
        Answer.relative(f"reaction on a wider base, {method}, beside multipliers",
                        found_reaction(comm, at.size, WIDER, method=method), exact, "N/m", 1e-10)
        for method in ("condensed", "augmented-lagrangian")
    ]  # fmt: skip
    curve = over_penalties("equal blocks", PENALTIES, soft, reaction, 1e-3)
    return Outcome(
        tuple(answers),
        max(answer.error for answer in answers),
        Comparison("log10 of the penalty [Pa/m]", "reaction [kN/m]", (curve,)),
    )


VERIFICATION = Verification(
    number="V16",
    title="Two blocks pressed together by all methods",
    formula="F = d b/((1 − ν²)(H1/E1 + H2/E2) + 1/ε) for equal widths; on a wider base one "
    "reaction of all methods that let nothing penetrate",
    source="after M. Chiumenti, section 10.1; springs in series",
    run=compare,
    levels=(Resolution(0.0025),),
    quick=(Resolution(0.005),),
    refined="nothing",
)
