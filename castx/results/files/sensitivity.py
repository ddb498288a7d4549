"""sensitivity.json: what a run and runs with another coherency have given."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from castx.input.units import seconds_text
from castx.results.files.folder import SENSITIVITY
from castx.results.files.json_contents import JsonContents, read_json, write_json
from castx.results.files.reason import Reason

MICRO = 1e6


class VariedRun(JsonContents):
    """Results of one of the runs.

    Attributes:
        folder: its results, relative to those of the run itself.
        coherency: of each body that has one.
        ended: why it ended, "finished" or "not converged".
        reached: time up to which it went [s].
        frozen: when the last liquid of each casting was solid [s]; None: not at the end.
        gaps: largest gap of each interface [m].
    """

    folder: str
    coherency: Mapping[str, float]
    ended: str
    reached: float
    frozen: Mapping[str, float | None]
    gaps: Mapping[str, float]

    def number(self, body: str = "") -> str:
        """Return the coherency of a body as text; of all bodies without a name."""
        found = self.coherency.values() if body not in self.coherency else [self.coherency[body]]
        return ", ".join(dict.fromkeys(f"{value:.4g}" for value in found))

    def freezing_text(self, body: str) -> str:
        """Return when a casting was all solid, or that it was not."""
        time = self.frozen.get(body)
        if time is not None:
            return seconds_text(time)
        finished = self.ended == Reason.FINISHED
        stopped = "at the end" if finished else f"when it stopped ({self.ended})"
        return f"not frozen {stopped}, {seconds_text(self.reached)}"

    def gap_text(self, interface: str) -> str:
        """Return the largest gap of an interface."""
        gap = self.gaps.get(interface)
        return "none" if gap is None else f"{MICRO * gap:.4g} µm"


class Sensitivity(JsonContents):
    """How answers hang on a number.

    Attributes:
        of: name of the number.
        runs: with the number from the smallest to the largest.
    """

    of: str
    runs: tuple[VariedRun, ...]

    @property
    def castings(self) -> list[str]:
        """Names of the castings."""
        return list(dict.fromkeys(name for run in self.runs for name in run.frozen))

    @property
    def interfaces(self) -> list[str]:
        """Names of the interfaces with a gap."""
        return list(dict.fromkeys(name for run in self.runs for name in run.gaps))


def write_sensitivity(folder: Path, found: Sensitivity) -> None:
    """Write the file into the results folder of the run itself."""
    write_json(folder / SENSITIVITY, found)


def read_sensitivity(folder: Path) -> Sensitivity | None:
    """Return the contents of the file in a results folder; None where there is none.

    Raises:
        CaseError: the file is broken.
    """
    return read_json(folder / SENSITIVITY, Sensitivity)
