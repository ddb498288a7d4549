"""The verdict on a verification: its runs at all levels, and whether tolerances are met."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from itertools import pairwise

from mpi4py import MPI

from castx.errors import CaseError, ConvergenceError, MeshError
from castx.proof.verification.verification import (
    LEAST_FALL,
    Answer,
    Outcome,
    Resolution,
    Verification,
)

LEAST_ORDER = math.log2(LEAST_FALL)


@dataclass(frozen=True)
class Run:
    """A run at one level.

    Attributes:
        level: how fine.
        outcome: what it gave.
        seconds: of wall clock time.
        order: with which the error has fallen since the level before; None at the first.
    """

    level: Resolution
    outcome: Outcome
    seconds: float
    order: float | None


@dataclass(frozen=True)
class Verdict:
    """Result of a verification.

    Attributes:
        verification: what was verified.
        runs: from coarse to fine.
        failure: why there are not all runs, or "".
    """

    verification: Verification
    runs: tuple[Run, ...]
    failure: str = ""

    @property
    def seconds(self) -> float:
        """Wall clock time of all runs."""
        return sum(run.seconds for run in self.runs)

    @property
    def allowance(self) -> float:
        """Factor on the tolerances at the finest level."""
        return self.verification.allowance(self.runs[-1].level)

    @property
    def answers(self) -> tuple[Answer, ...]:
        """Answers of the finest level."""
        return self.runs[-1].outcome.answers if self.runs else ()

    def meets(self, answer: Answer) -> bool:
        """Return whether an answer of the finest level is within its tolerance."""
        return answer.error <= answer.tolerance * self.allowance

    @property
    def worst(self) -> Answer | None:
        """The answer nearest to its tolerance, or farthest beyond it; None without runs."""
        shares = [answer.error / answer.tolerance for answer in self.answers]
        return self.answers[shares.index(max(shares))] if shares else None

    @property
    def order(self) -> float | None:
        """The observed order at the finest level; None where the runs are exact on any mesh."""
        return self.runs[-1].order if self.runs else None

    @property
    def falls(self) -> bool:
        """Whether the error falls as it has to, where there is one."""
        return self.verification.refined == "nothing" or (self.order or 0.0) >= LEAST_ORDER

    @property
    def met(self) -> bool:
        """Whether all tolerances are met and the error falls."""
        return not self.failure and self.falls and all(map(self.meets, self.answers))


def verified(verification: Verification, comm: MPI.Intracomm, *, quick: bool = False) -> Verdict:
    """Run a verification at its levels; collective.

    A run that is refused or does not converge is a failure of the verification, no end of all.

    Args:
        verification: the exact solution and what is compared with it.
        comm: the ranks.
        quick: take the coarser levels.
    """
    done: list[tuple[Resolution, Outcome, float]] = []
    failure = ""
    for level in verification.quick if quick else verification.levels:
        begin = time.perf_counter()
        try:
            outcome = verification.run(level, comm)
        except (CaseError, MeshError, ConvergenceError) as error:
            failure = str(error)
            break
        done.append((level, outcome, comm.bcast(time.perf_counter() - begin)))
    orders = [None, *(_order(verification, a, b) for a, b in pairwise(done))]
    runs = tuple(Run(*each, order) for each, order in zip(done, orders, strict=False))
    return Verdict(verification, runs, failure)


def _order(
    verification: Verification,
    coarse: tuple[Resolution, Outcome, float],
    fine: tuple[Resolution, Outcome, float],
) -> float | None:
    if verification.refined == "nothing":
        return None
    sizes = [verification.measure(level) for level, *_ in (coarse, fine)]
    errors = [outcome.norm for _, outcome, _ in (coarse, fine)]
    return math.log(errors[0] / errors[1]) / math.log(sizes[0] / sizes[1])
