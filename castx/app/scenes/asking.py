"""Scenes as the page asks for them: each from a process of its own, one of a sort at a time."""

from __future__ import annotations

import json
import threading
from collections.abc import Mapping
from pathlib import Path
from subprocess import STDOUT, TimeoutExpired
from tempfile import TemporaryDirectory
from typing import Any

from castx.errors import CaseError, MeshError
from castx.input.child_process import REFUSED, end_of, run_apart

Answer = dict[str, Any]
MESH, MOMENT = "mesh", "moment"
"""Sorts of scenes."""
PATIENCE: Mapping[str, float] = {MESH: 120.0, MOMENT: 60.0}
"""Time that a scene may take [s]."""
CURE: Mapping[str, str] = {
    MESH: "choose larger sizes, or mesh it by castx check, which waits longer",
    MOMENT: "write its report, which takes the time that it needs",
}
LONGEST = 8000
"""Characters of a refusal that are shown."""


class Scenes:
    """Draws scenes, and refuses a second one of a sort as long as the first one is drawn."""

    def __init__(self) -> None:
        self._locks = {sort: threading.Lock() for sort in PATIENCE}

    def mesh(self, text: str, path: Path) -> Answer:
        """Return the mesh of a case.

        Args:
            text: of the case file.
            path: of the case file.

        Raises:
            CaseError: another mesh is being made.
            MeshError: the case makes no mesh, or it takes too long.
        """
        return self._drawn({"scene": MESH, "text": text, "path": str(path)})

    def moment(self, folder: Path, field: str) -> Answer:
        """Return the last moment of a run.

        Args:
            folder: of its results.
            field: that is shown.

        Raises:
            CaseError: another one is being drawn.
            MeshError: there are no fields yet, or reading them takes too long.
        """
        return self._drawn({"scene": MOMENT, "path": str(folder), "field": field})

    def _drawn(self, asked: Mapping[str, str]) -> Answer:
        sort = asked["scene"]
        if not self._locks[sort].acquire(blocking=False):
            raise CaseError(f"the last {sort} that was asked for is still being made: wait for it")
        try:
            return answered(asked)
        finally:
            self._locks[sort].release()


def answered(asked: Mapping[str, str]) -> Answer:
    """Return the answer of the process that draws a scene.

    Args:
        asked: the request.

    Raises:
        MeshError: it refuses, dies, or takes too long.
    """
    sort = asked["scene"]
    with TemporaryDirectory() as folder:
        request, answer = Path(folder, "request"), Path(folder, "answer")
        request.write_text(json.dumps(asked))
        arguments = ["-m", "castx.app.scenes.child", str(request), str(answer), str(REFUSED)]
        try:
            ended = run_apart(arguments, PATIENCE[sort], errors=STDOUT)
        except TimeoutExpired:
            raise MeshError(
                f"the {sort} took more than {PATIENCE[sort]:.0f} s: {CURE[sort]}"
            ) from None
        if ended.returncode == REFUSED:
            raise MeshError(answer.read_text(errors="replace")[:LONGEST])
        if ended.returncode != 0 or not answer.is_file():
            raise MeshError(
                f"no {sort}: {end_of('process', ended.returncode, ended.stdout)}; {CURE[sort]}"
            )
        found: Answer = json.loads(answer.read_text())
        return found
