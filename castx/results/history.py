"""history.csv: effort of every accepted step, totals of bodies and interfaces."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from castx.results.files.series import Series, cut_back
from castx.results.states.snapshot import Snapshot
from castx.solvers.counters import StepCounters

COUNTERS = tuple(field.name for field in dataclasses.fields(StepCounters))
BODY_TOTALS = (
    "solid_fraction", "min_temperature", "mean_temperature", "max_temperature", "enthalpy",
    "heat_in", "support_force", "support_moment", "force_error", "power",
    "feeding_demand", "fed_volume", "opened_volume", "yielded_volume", "unfed_volume",
    "pocket_pressure", "melt_suction", "pipe_volume", "feeder_level",
    "level_drop",
)  # fmt: skip
INTERFACE_TOTALS = (
    "heat", "power", "mean_gap", "min_gap", "max_gap", "closed_fraction", "suction",
    "force", "ejection_force",
)  # fmt: skip
NOTHING = MappingProxyType[str, float]({})
RUN_TOTALS = (
    "energy_error", "temperature_error", "gap_error", "strain_error", "support_force",
    "largest_pull", "cycle", "stage",
)  # fmt: skip


def ordered_totals(
    names: Iterable[str], bodies: Sequence[str], interfaces: Sequence[str]
) -> list[str]:
    """Return the names of totals in the order of the columns: bodies, interfaces, the whole run.

    Within a body or an interface the quantities come in the order of the tuples above, each with
    its parts (`casting/mould.force.z`) in alphabetical order; unknown ones follow.
    """

    def position(name: str) -> tuple[int, int, int, str]:
        owner, _, quantity = name.partition(".")
        for group, (owners, known) in enumerate(
            ((bodies, BODY_TOTALS), (interfaces, INTERFACE_TOTALS))
        ):
            if quantity and owner in owners:
                return group, list(owners).index(owner), rank(quantity, known), name
        return 2, 0, rank(name, RUN_TOTALS), name

    return sorted(names, key=position)


def rank(quantity: str, known: Sequence[str]) -> int:
    """Return the place of a quantity, or of the one it is a part of, in an order."""
    whole = quantity.partition(".")[0]
    return known.index(whole) if whole in known else len(known)


class History:
    """Writer of history.csv; used on rank 0 only, since its values are equal on all ranks.

    The first snapshot fixes the columns.

    Args:
        path: the file.
        bodies: names of the bodies in their order.
        interfaces: names of the interfaces in their order.
    """

    def __init__(self, path: Path, bodies: Sequence[str], interfaces: Sequence[str]) -> None:
        self._path = path
        self._bodies = tuple(bodies)
        self._interfaces = tuple(interfaces)
        self._totals: list[str] = []
        self._series: Series | None = None
        self._resumed = False

    def resume(self, rows: int) -> None:
        """Go on behind the first lines of an older file."""
        cut_back(self._path, rows)
        self._resumed = True

    def append(self, snapshot: Snapshot, followed: Mapping[str, float] = NOTHING) -> None:
        """Write the line of one accepted step.

        Args:
            snapshot: the state after it.
            followed: further totals by the name of their column, which are followed elsewhere.
        """
        known = {**snapshot.totals, **followed}
        if self._series is None:
            self._totals = ordered_totals(known, self._bodies, self._interfaces)
            columns = ("time", *COUNTERS, *self._totals)
            self._series = Series(self._path, columns, resumed=self._resumed)
        counters = dataclasses.astuple(snapshot.counters)
        totals = [known[name] for name in self._totals]
        self._series.append([snapshot.time, *counters, *totals])

    def sync(self) -> None:
        """Bring all lines to disk."""
        if self._series is not None:
            self._series.sync()

    def close(self) -> None:
        """Close the file."""
        if self._series is not None:
            self._series.close()
