"""A mesh of CAD files, made by a process of its own."""

from __future__ import annotations

import json
import pickle
import re
import signal
from pathlib import Path
from subprocess import STDOUT, TimeoutExpired
from typing import Any

from castx.errors import MeshError
from castx.input.child_process import REFUSED, end_of, run_apart
from castx.meshes.cad.description import NO_CELLS, CadPart
from castx.meshes.cad.report import Report
from castx.meshes.cad.seen import SeenPart

PATIENCE = 3600.0
"""Time that it may take [s]."""
LONGEST = 8000
"""Characters of a refusal that are shown."""
DAMAGED = "the part is damaged, repair it in CAD and export it again"
STOPPED = (
    "something else stopped it, as the system does when memory runs out: choose larger sizes, or "
    "run it alone"
)
FROM_OUTSIDE = (-signal.SIGKILL, -signal.SIGTERM)
"""Exit codes of a process that did not end by itself."""
CROSSING = re.compile(r"intersect at point \(([-+.\de]+),([-+.\de]+),([-+.\de]+)\)")
"""What gmsh prints of faces that cross each other."""


class SizesError(MeshError):
    """Sound solids make no mesh of these sizes; others may make one."""


def meshed_apart(part: CadPart, mesh: Path, patience: float | None = None) -> Report:
    """Mesh CAD files and write the mesh; call it on one rank only.

    Args:
        part: what is to be meshed.
        mesh: the gmsh file to write, in a folder for this purpose alone.
        patience: time that it may take [s]; None: `PATIENCE`.

    Raises:
        MeshError: the mesher refuses the files or dies.
        SizesError: it refuses the sizes of cells, or takes too long.
    """
    return Report.of_data(_answered(part, mesh, patience))


def seen_apart(part: CadPart, folder: Path, patience: float | None = None) -> SeenPart:
    """Return the faces of CAD files; call it on one rank only.

    Args:
        part: what is to be seen.
        folder: for this purpose alone.
        patience: time that it may take [s]; None: `PATIENCE`.

    Raises:
        MeshError: the files are refused, the process dies, or it takes too long.
    """
    return SeenPart.of_data(_answered(part, folder / "faces.msh", patience, "faces"))


def _answered(part: CadPart, mesh: Path, patience: float | None, *wanted: str) -> Any:
    """Return the answer of the process that meshes, or gives what is wanted beside."""
    patience = PATIENCE if patience is None else patience
    source = ", ".join(file.path for file in part.files)
    request, answer = mesh.with_suffix(".request"), mesh.with_suffix(".answer")
    # Whoever can write this file can run code in the child, and its folder is private to this run.
    request.write_bytes(pickle.dumps(part))
    files = [str(request), str(mesh), str(answer)]
    try:
        ended = run_apart(
            ["-m", "castx.domain.cad.child", *files, str(REFUSED), *wanted], patience, errors=STDOUT
        )
    except TimeoutExpired:
        raise SizesError(
            f"{source} cannot be meshed: it took more than {patience:.0f} s; choose larger "
            "sizes, or leave out what is narrow, geometry.narrowest"
        ) from None
    if ended.returncode in (REFUSED, NO_CELLS):
        text = answer.read_text(errors="replace")[:LONGEST]
        text += place_in(ended.stdout.decode(errors="replace"))
        kind = SizesError if ended.returncode == NO_CELLS else MeshError
        raise kind(text if source in text else f"{source}: {text}")
    if ended.returncode != 0 or not answer.is_file():
        cure = STOPPED if ended.returncode in FROM_OUTSIDE else DAMAGED
        raise MeshError(
            f"{source} cannot be meshed: {end_of('mesher', ended.returncode, ended.stdout)}; {cure}"
        )
    return json.loads(answer.read_text())


def place_in(said: str) -> str:
    """Return where faces cross each other, if gmsh has said so in millimetres."""
    found = CROSSING.findall(said)
    if not found:
        return ""
    place = ", ".join(f"{float(x) / 1e3:.4g}" for x in found[0])
    return f" (faces cross at ({place}) m)"
