"""Warnings of steps in which the forces on a body balance less well than was asked."""

from __future__ import annotations

import logging
from types import TracebackType
from typing import Self

from mpi4py import MPI

from castx.case.case import Case
from castx.input.units import seconds_text
from castx.results.states.snapshot import Snapshot

_log = logging.getLogger(__name__)

COLUMN = ".force_error"


class ForceWatch:
    """Warns at the first step with unbalanced forces, and at the end with the number of such steps.

    Args:
        case: what is run.
        comm: ranks of the run; the first one warns.
    """

    def __init__(self, case: Case, comm: MPI.Intracomm) -> None:
        self._allowed, self._warns = case.solver.mechanics_tolerance, comm.rank == 0
        self._steps = self._exceeded = 0
        self._largest, self._where = 0.0, ""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._exceeded and self._warns:
            _log.warning(
                "in %d of %d steps the forces balance less well than solver.mechanics_tolerance "
                "asks; worst: %s", self._exceeded, self._steps, self._where,
            )  # fmt: skip

    def check(self, snapshot: Snapshot) -> None:
        """Compare the force errors after an accepted step with the requested tolerance."""
        errors = {
            name.removesuffix(COLUMN): value
            for name, value in snapshot.totals.items()
            if name.endswith(COLUMN)
        }
        if snapshot.step == 0 or not errors:
            return
        self._steps += 1
        body, error = max(errors.items(), key=lambda item: item[1])
        if error <= self._allowed:
            return
        self._exceeded += 1
        text = f"{error:.2g} of the forces on {body} at t = {seconds_text(snapshot.time)}"
        if error > self._largest:
            self._largest, self._where = error, text
        if self._exceeded == 1 and self._warns:
            _log.warning(
                "%s are missing, %.2g is allowed (solver.mechanics_tolerance; columns force_error "
                "of history.csv; said once, and at the end)", text, self._allowed,
            )  # fmt: skip
