"""The record and the tables of a results folder."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.problems import among
from castx.results.files.column_units import unit_of
from castx.results.files.folder import HISTORY, PROBES, RECORD
from castx.results.files.measurements import Deviation, deviation, read_measured
from castx.results.files.run_json import completed, read_record
from castx.results.files.series import read_series
from castx.version import __version__

TIME = "time"

ROUNDING = 1e-9
"""Share of a time by which texts of it may differ."""


def is_newer(version: str) -> bool:
    """Return whether a version, as "0.2.0", is later than this castx."""
    return _numbers(version) > _numbers(__version__)


def _numbers(version: str) -> list[int]:
    return [int(number) for number in re.findall(r"[0-9]{1,9}", version)[:3]]


class Columns(dict[str, FloatArray]):
    """Arrays by name; a missing one is refused with the names of those that exist."""

    def __missing__(self, name: str) -> FloatArray:
        raise CaseError(f"there is no {name!r}; {among(name, list(self), what='there are')}")


class RunTables:
    """Tables and records of a results folder, without fields.

    Attributes:
        folder: the results folder.
        record: run.json: what was run, with what, and how it ended.
        history: columns of history.csv by name, (steps + 1,).
        probes: columns of probes.csv by name, (steps + 1,).
        measured: measured curves by the columns of probes.csv that they belong to.

    Args:
        folder: the results folder.

    Raises:
        CaseError: it is none, or a file is missing or broken.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        try:
            record = completed(read_record(self.folder / RECORD))
            history = read_series(self.folder / HISTORY)
            probes = read_series(self.folder / PROBES)
            self.measured = read_measured(self.folder)
        except (OSError, ValueError) as error:
            raise CaseError(f"{folder} is not a results folder of castx: {error}") from error
        if not record["bodies"] or history.get(TIME, np.empty(0)).size == 0:
            raise CaseError(f"{folder} holds no accepted step of a run of castx")
        if record["model"] is None:
            raise CaseError(f"{self.folder / RECORD} is damaged: it lacks the model")
        self.record: Mapping[str, Any] = record
        self.history, self.probes = Columns(history), Columns(probes)

    @property
    def doubts(self) -> list[str]:
        """Sentences on what the folder does not hold as its run has left it, none as a rule."""
        found = []
        written = self.record["castx"]
        if is_newer(written):
            found.append(
                f"{self.folder / RECORD} was written by castx {written}, this is {__version__}: "
                "what is new there is not understood; read it with that version"
            )
        reached = self.record["time_reached"]
        for name, table in ((HISTORY, self.history), (PROBES, self.probes)):
            last = float(np.max(table.get(TIME, np.empty(0)), initial=0.0))
            if last >= reached * (1.0 - ROUNDING):
                continue
            found.append(
                f"{self.folder / name} ends at t = {last:g} s, but the run reached "
                f"{reached:g} s: its last lines are lost; put a whole copy in its place, or run "
                "the case again"
            )
        return found

    @property
    def deviations(self) -> dict[str, Deviation]:
        """Deviations of the probes from measured curves, by column, where times overlap."""
        time = self.probes[TIME]
        found = {
            name: deviation(time, self.probes[name], curve)
            for name, curve in self.measured.items()
            if name in self.probes
        }
        return {name: apart for name, apart in found.items() if apart is not None}

    def history_unit(self, column: str) -> str:
        """Return the unit of a column of history.csv, "1" of numbers and shares.

        Raises:
            CaseError: there is no such column; with those that exist.
        """
        _ = self.history[column]
        return unit_of(column, self.model)

    @property
    def case(self) -> Mapping[str, Any]:
        """Name, file and digest of the case."""
        case: Mapping[str, Any] = self.record["case"]
        return case

    @property
    def model(self) -> str:
        """The model, such as "axisymmetric" or "3d"."""
        return str(self.record["model"])

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of all bodies, of removed ones too."""
        return tuple(self.record["bodies"])

    @property
    def interfaces(self) -> tuple[str, ...]:
        """Names of all interfaces."""
        return tuple(self.record["interfaces"])

    @property
    def hot_spots(self) -> Sequence[Mapping[str, Any]]:
        """Pools of liquid that were cut off, the worst first, in the words of hot_spots.csv."""
        found: Sequence[Mapping[str, Any]] = self.record.get("hot_spots", [])
        return found

    @property
    def stage_ends(self) -> Sequence[Mapping[str, Any]]:
        """Extremes of stress and distortion of the bodies at the ends of the stages."""
        found: Sequence[Mapping[str, Any]] = self.record.get("stage_ends", [])
        return found

    def stage_end(self, stage: int) -> Mapping[str, Any]:
        """Return the record of the end of a stage: time, and its bodies by name.

        Raises:
            CaseError: it has not ended; with those that have.
        """
        ends = {int(end["stage"]): end for end in self.stage_ends}
        if stage not in ends:
            known = ", ".join(map(str, ends)) or "none"
            raise CaseError(f"no stage {stage} has ended; stages that have: {known}")
        return ends[stage]
