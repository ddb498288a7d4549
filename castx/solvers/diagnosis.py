"""Explanation of a failed run: the cause, its number of failures, and the usual cure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from castx.errors import ConvergenceError

HEAT, MECHANICS, COUPLING = "the heat problem", "the mechanical equilibrium", "the interfaces"
"""Problems that can fail, by the names that messages have for them."""
CIRCLING = "interfaces that open and close again"
"""Likewise, where more passes change nothing."""

ADVICE = {
    HEAT: (
        "look at what the case gives over time or temperature near this moment and place: a jump "
        "in a table needs small steps",
        "allow more iterations: solver.heat = { snes_max_it = 100 }",
    ),
    MECHANICS: (
        "look at the place named above: what holds the body there, and is the mesh fine enough "
        "where it freezes or bends?",
        "let a cold law be reached more gently: a higher yield stress near the melting point, a "
        "coherency below 1, a larger liquid viscosity",
        'another contact.method, or a linear solver that is exact: solver.linear = "direct"',
        "allow more iterations: solver.mechanics = { snes_max_it = 100 }",
    ),
    COUPLING: (
        "allow more passes (coupling.passes), or agree less exactly (coupling.tolerance)",
        "let the heat transfer depend on the contact pressure more gently: a smaller exponent or a "
        "larger resistance",
    ),
    CIRCLING: (
        "look for a body that may lean on one wall or on another: friction in its contact, a "
        "support, or finer cells where it freezes",
        "agree less exactly (coupling.tolerance)",
        "let the heat transfer depend on gap and contact pressure more gently: a larger resistance "
        "of what is closed",
    ),
    "": (),
}
EVERYWHERE = (
    "smaller steps before this moment (time.largest_step, time.temperature_change) or still "
    "smaller ones here (time.smallest_step)",
)


@dataclass(frozen=True)
class FailedTry:
    """A step that failed.

    Attributes:
        step: its size [s].
        error: why it failed.
    """

    step: float
    error: ConvergenceError


def diagnosis(time: float, tries: Sequence[FailedTry]) -> str:
    """Return a text on the steps tried from the last accepted state, and the usual cure.

    Args:
        time: of the last accepted state [s].
        tries: at least one, in their order.
    """
    counts = Counter(failed.error.problem for failed in tries)
    failed = ", ".join(
        f"{problem or 'another problem'} {count}×" for problem, count in counts.most_common()
    )
    steps = [f"{failed.step:.3g}" for failed in tries]
    if len(steps) > 6:
        steps[2:-2] = ["…"]
    advice = [*ADVICE[tries[-1].error.problem], *EVERYWHERE]
    return "\n".join(
        [
            f"the last accepted state is that of t = {time:g} s",
            f"tried from there: steps of {', '.join(steps)} s; what failed: {failed}",
            "what usually helps:",
            *(f"- {text}" for text in advice),
        ]
    )
