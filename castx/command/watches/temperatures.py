"""Ends runs whose temperatures nothing can have, and warns of doubtful ones and heat balances.

Newton's method solves for temperatures below absolute zero as for any other, where a flux or a sink
draws more heat than there is; and where terms cancel that are 1e12 times as large as their sum,
such as conduction in a mistaken unit, rounding is taken for a solution. Cells that are large beside
the depth to which heat has come have nodes that get colder than anything there is.
"""

from __future__ import annotations

import logging
import math

from mpi4py import MPI

from castx.case.case import Case
from castx.command.watches.ranges import coldest_possible, temperature_range
from castx.errors import ConvergenceError
from castx.input.units import ABSOLUTE_ZERO, HOTTEST, seconds_text
from castx.results.states.snapshot import Snapshot

_log = logging.getLogger(__name__)

OFF = 0.05
"""Error of the heat balance, as a share of the heat that has moved, that is told."""
BELOW = 0.01
"""By what rounding may lie below absolute zero [K]."""
COLDER = 0.01
"""By which share of the temperatures of a case a body may be colder than all of them, untold."""


class TemperatureWatch:
    """Looks at the temperatures and the heat balance of a run; the first rank warns.

    Args:
        case: what is run.
        comm: ranks of the run.
    """

    def __init__(self, case: Case, comm: MPI.Intracomm) -> None:
        self._bodies, self._comm = [body.name for body in case.bodies], comm
        self._is_told = False
        self._coldest, self._too_cold = -math.inf, set[str]()
        if all(body.temperature.bounds is not None for body in case.bodies):
            self._coldest = coldest_possible(case)
        low, high = temperature_range(case)
        self._least = self._coldest - COLDER * (high - low)

    def check(self, snapshot: Snapshot) -> None:
        """Look at the totals after an accepted step, which are the same on all ranks.

        Raises:
            ConvergenceError: a body is below absolute zero, or hotter than any metal can be.
        """
        for body in self._bodies:
            low = snapshot.totals.get(f"{body}.min_temperature", math.inf)
            high = snapshot.totals.get(f"{body}.max_temperature", -math.inf)
            if low < ABSOLUTE_ZERO - BELOW:
                self._end(snapshot, body, low, f"below absolute zero, {ABSOLUTE_ZERO} °C", "less")
            if high > HOTTEST:
                self._end(snapshot, body, high, f"above {HOTTEST:g} °C, where it is vapour", "more")
            if low < self._least:
                self._tell_cold(snapshot, body, low)
        error = abs(snapshot.totals.get("energy_error", 0.0))
        if error > OFF and not self._is_told:
            self._is_told = True
            if self._comm.rank == 0:
                _log.warning(
                    "at t = %s the heat balance is off by %.3g %% of the heat that has moved: the "
                    "temperatures are not to be trusted; look at conductivities, densities, heat "
                    "capacities and coefficients: is one in a mistaken unit, and so large that the "
                    "others drown in its rounding? (said once)",
                    seconds_text(snapshot.time), 100.0 * error,
                )  # fmt: skip

    def _tell_cold(self, snapshot: Snapshot, body: str, value: float) -> None:
        if self._comm.rank == 0 and body not in self._too_cold:
            _log.warning(
                "at t = %s %s is at %.4g °C, colder than all that the case has, %.4g °C: its cells "
                "are too large for the heat that enters it, which is off there; make them smaller "
                "(interface_size, or sizes of %s; said once for each body)",
                seconds_text(snapshot.time), body, value, self._coldest, body,
            )  # fmt: skip
        self._too_cold.add(body)

    def _end(self, snapshot: Snapshot, body: str, value: float, limit: str, heat: str) -> None:
        raise ConvergenceError(
            f"at t = {seconds_text(snapshot.time)} {body} is at {value:.5g} °C, {limit}: look at "
            f"fluxes, heat sources and coefficients of {body} and what it touches, which give it "
            f"{heat} heat than it can have, and at its heat capacity and density (W, m, J, kg)"
        )
