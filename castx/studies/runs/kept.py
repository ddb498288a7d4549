"""A run of a study as it is kept: what was changed, how it ended, and what it has answered."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

from castx.errors import CaseError
from castx.results.files.folder import store_text
from castx.results.files.reason import Reason

KEPT = "kept.json"
RESULTS = "results"
LOG = "log.txt"
FINISHED, NOT_CONVERGED = Reason.FINISHED.value, Reason.NOT_CONVERGED.value
REFUSED, OUT_OF_TIME, BROKEN = "refused", "out of time", "broken"
BY_CODE = {0: FINISHED, 2: REFUSED, 3: NOT_CONVERGED, 130: OUT_OF_TIME}
"""How a run has ended by the exit code of castx; by all others it is broken."""


class KeptRun(BaseModel):
    """A run that has ended, in whatever way.

    Attributes:
        digest: of its case and of the version of castx.
        changes: values by their paths in the case file.
        ended: one of the words of this module.
        said: why it failed; "" if it has not.
        seconds: wall clock time [s].
        processor_seconds: time of processors [s].
        folder: of the run, relative to that of the study.
    """

    model_config = ConfigDict(frozen=True)

    digest: str
    changes: Mapping[str, Any]
    ended: str
    said: str
    seconds: float
    processor_seconds: float
    folder: str

    @property
    def is_finished(self) -> bool:
        """Whether its results are whole."""
        return self.ended == FINISHED


def read_kept(folder: Path) -> KeptRun | None:
    """Return the run of a folder; None where none has ended.

    Raises:
        CaseError: its file is broken.
    """
    path = folder / KEPT
    if not path.is_file():
        return None
    try:
        return KeptRun.model_validate_json(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise CaseError(f"{path} is broken; delete {folder}") from None


def write_kept(folder: Path, run: KeptRun) -> None:
    """Write the file of a run that has ended."""
    text = json.dumps(run.model_dump(mode="json"), indent=2, ensure_ascii=False)
    store_text(folder / KEPT, text + "\n")
