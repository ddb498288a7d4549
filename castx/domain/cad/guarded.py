"""A mesh of CAD files, made by a process of its own."""

from __future__ import annotations

import json
import os
import pickle
import re
import signal
import subprocess
import sys
from pathlib import Path

from castx.errors import MeshError
from castx.input.printable import printable
from castx.meshes.cad.description import CadPart
from castx.meshes.cad.report import Report

REFUSED = 3
"""Exit code of the mesher after a refusal in words."""
PATIENCE = 3600.0
"""Time that it may take [s]."""
SHOWN = 300
"""Characters of its last line that are shown when it dies."""
LONGEST = 8000
"""Characters of a refusal that are shown."""
CROSSING = re.compile(r"intersect at point \(([-+.\de]+),([-+.\de]+),([-+.\de]+)\)")
"""What gmsh prints of faces that cross each other."""
OF_MPI = ("OMPI_", "PMIX_", "PRTE_", "PMI_")
"""Beginnings of the variables by which a process takes itself for a rank."""


def meshed_apart(part: CadPart, mesh: Path) -> Report:
    """Mesh CAD files and write the mesh; call it on one rank only.

    Args:
        part: what is to be meshed.
        mesh: the gmsh file to write, in a folder for this purpose alone.

    Raises:
        MeshError: the mesher refuses the files, dies, or takes too long.
    """
    source = ", ".join(file.path for file in part.files)
    request, answer, words = (mesh.with_suffix(end) for end in (".request", ".answer", ".words"))
    request.write_bytes(pickle.dumps(part))
    kept = {key: value for key, value in os.environ.items() if not key.startswith(OF_MPI)}
    command = [sys.executable, "-P", "-m", "castx.domain.cad.child"]
    try:
        # Files and no pipes: PETSc ends a process that writes to a reader which has died.
        with words.open("wb") as output:
            ended = subprocess.run(
                [*command, str(request), str(mesh), str(answer), str(REFUSED)],
                stdin=subprocess.DEVNULL, stdout=output, stderr=output, env=kept,
                timeout=PATIENCE, check=False,
            )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise MeshError(
            f"{source} cannot be meshed: it took more than {PATIENCE:.0f} s; choose larger sizes"
        ) from None
    if ended.returncode == REFUSED:
        text = answer.read_text(errors="replace")[:LONGEST]
        text += place_in(words)
        raise MeshError(text if source in text else f"{source}: {text}")
    if ended.returncode != 0 or not answer.is_file():
        raise MeshError(
            f"{source} cannot be meshed: {end_of(ended.returncode, words)}; the part is damaged, "
            "repair it in CAD and export it again"
        )
    return Report.of_data(json.loads(answer.read_text()))


def place_in(words: Path) -> str:
    """Return where faces cross each other, if gmsh has said so in millimetres.

    Args:
        words: the file with what the mesher has said.
    """
    found = CROSSING.findall(words.read_text(errors="replace"))
    if not found:
        return ""
    place = ", ".join(f"{float(x) / 1e3:.4g}" for x in found[0])
    return f" (faces cross at ({place}) m)"


def end_of(code: int, words: Path) -> str:
    """Return a text on the end of the mesher.

    Args:
        code: with which it has ended.
        words: the file with what it has said.
    """
    said = words.read_text(errors="replace") if words.is_file() else ""
    lines = [line for line in said.splitlines() if line.strip()]
    last = printable(lines[-1])[:SHOWN] if lines else "no word"
    how = f"by {signal.Signals(-code).name}" if code < 0 else f"with exit code {code}"
    return f"its mesher ended {how} ({last})"
