"""Ends runs whose temperatures nothing can have, and warns of doubtful ones and heat balances.

Newton's method solves for temperatures below absolute zero as for any other, where a flux or a sink
draws more heat than there is; and where terms cancel that are 1e12 times as large as their sum,
such as conduction in a mistaken unit, rounding is taken for a solution. Cells that are large beside
the depth to which heat has come have nodes that get colder than anything there is; and melt beside
a skin in its first cells gets a part of their latent heat, where that is found inside the cells.
"""

from __future__ import annotations

import logging
import math

from mpi4py import MPI

from castx.case.case import Case
from castx.command.watches.ranges import (
    coldest_possible,
    hottest_possible,
    temperature_range,
)
from castx.errors import ConvergenceError
from castx.input.units import ABSOLUTE_ZERO, HOTTEST, seconds_text
from castx.results.states.snapshot import Snapshot

_log = logging.getLogger(__name__)

OFF = 0.05
"""Error of the heat balance, as a share of the heat that has moved, that is told."""
BELOW = 0.01
"""By what rounding may lie below absolute zero [K]."""
BEYOND = 0.01
"""By which share of the temperatures of a case a body may be beyond all of them, untold."""
LEAST_BEYOND = 1.0
"""The least that a body may be beyond them [K]: heat of plastic work is less, and rounding is far
less, whereas a case of one temperature has no share of its temperatures to go by."""


class TemperatureWatch:
    """Looks at the temperatures and the heat balance of a run; the first rank warns.

    Args:
        case: what is run.
        comm: ranks of the run.
    """

    def __init__(self, case: Case, comm: MPI.Intracomm) -> None:
        self._bodies, self._comm = [body.name for body in case.bodies], comm
        self._is_told = False
        self._bounds, self._beyond = (-math.inf, math.inf), set[tuple[str, str]]()
        if all(body.temperature.bounds is not None for body in case.bodies):
            self._bounds = coldest_possible(case), hottest_possible(case)
        low, high = temperature_range(case)
        self._margin = max(LEAST_BEYOND, BEYOND * (high - low))

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
            coldest, hottest = self._bounds
            if low < coldest - self._margin:
                self._tell(snapshot, body, low, "colder", coldest)
            if high > hottest + self._margin:
                self._tell(snapshot, body, high, "hotter", hottest)
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

    def _tell(self, snapshot: Snapshot, body: str, value: float, how: str, bound: float) -> None:
        if self._comm.rank == 0 and (body, how) not in self._beyond:
            _log.warning(
                "at t = %s %s is at %.4g °C, %s than all that the case has, %.4g °C: its cells are "
                "too large for the heat that enters or leaves it, which is off there; make them "
                "smaller (interface_size, or sizes of %s; said once for each body)",
                seconds_text(snapshot.time), body, value, how, bound, body,
            )  # fmt: skip
        self._beyond.add((body, how))

    def _end(self, snapshot: Snapshot, body: str, value: float, limit: str, heat: str) -> None:
        raise ConvergenceError(
            f"at t = {seconds_text(snapshot.time)} {body} is at {value:.5g} °C, {limit}: look at "
            f"fluxes, heat sources and coefficients of {body} and what it touches, which give it "
            f"{heat} heat than it can have, and at its heat capacity and density (W, m, J, kg)"
        )
