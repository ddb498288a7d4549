"""The faces of the CAD files of a case, for the view of the page and for selectors."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import permutations
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from castx.app.selectors import TOLERANCE, surfaces_of
from castx.app.text.editing import content_of
from castx.app.text.on_surfaces import lost_surfaces
from castx.app.workplace import Workplace, digest_of
from castx.case.cad.geometry import CadGeometry, is_cad_file
from castx.case.geometry import Geometry
from castx.domain.cad.description import part_of
from castx.domain.cad.guarded import seen_apart
from castx.errors import CaseError
from castx.meshes.cad.description import CadFile, CadPart
from castx.meshes.cad.faces import Face
from castx.meshes.cad.seen import SeenPart
from castx.report.packing import packed

PATIENCE = 300.0
"""Time that reading a part may take [s]."""
KEPT = 4
"""Parts that are kept."""
REST = "outside"
"""Name of the free faces without another one."""
Stamps = tuple[tuple[str, int, int], ...]


class PartViews:
    """Reads CAD files once, and again when they or what is made round them change.

    Args:
        workplace: the folder.
    """

    def __init__(self, workplace: Workplace) -> None:
        self._workplace = workplace
        self._lock = threading.Lock()
        self._kept: list[tuple[CadPart, Stamps, SeenPart]] = []

    def of(self, name: str, text: str) -> SeenPart:
        """Return the faces of a CAD file, or of the CAD files of a case.

        Args:
            name: of either.
            text: of the case file.

        Raises:
            CaseError: it has none, or they lie outside the folder.
            MeshError: they cannot be read.
        """
        part = self._part(name, text)
        stamps = tuple(stamp(file.path) for file in part.files)
        with self._lock:
            for known, then, seen in self._kept:
                if known == part and then == stamps:
                    return seen
            with TemporaryDirectory() as folder:
                seen = seen_apart(part, Path(folder), PATIENCE)
            self._kept = [(part, stamps, seen), *self._kept[: KEPT - 1]]
            return seen

    def _part(self, name: str, text: str) -> CadPart:
        if is_cad_file(name):
            return CadPart((CadFile(str(self._workplace.path(name))),), inf)
        cad = cad_of(text).relative_to(self._workplace.case_path(name).parent)
        for path, _ in cad.sources:
            self._workplace.name_of(path)
        # What surfaces are called and how fine cells are changes nothing that is seen.
        return replace(
            part_of(cad, None), selectors=(), rules=(), size=inf, interface_size=None, across=0,
        )  # fmt: skip

    def view(self, name: str, text: str) -> dict[str, Any]:
        """Return faces, triangles and named surfaces, for JSON.

        Args:
            name: of a CAD file or a case file.
            text: of the case file.

        Raises:
            CaseError, MeshError: as in `of`.
        """
        seen = self.of(name, text)
        counts = np.array([len(corners) for corners in seen.triangles], dtype=np.uint32)
        points = np.concatenate(seen.triangles).astype(np.float32).reshape(-1)
        return {
            "bodies": bodies_of(seen.faces, {} if is_cad_file(name) else content_of(text)),
            "faces": [
                {"bodies": list(face.bodies), "text": face.text} for face in seen.faces
            ],
            "extents": extents_of(seen),
            "counts": packed(counts),
            "points": packed(points),
            **self.surfaces(name, text),
        }  # fmt: skip

    def surfaces(self, name: str, text: str) -> dict[str, Any]:
        """Return the faces of the named surfaces by their numbers, for JSON.

        Args:
            name: of a CAD file or a case file.
            text: of the case file.

        Raises:
            CaseError, MeshError: as in `of`.
        """
        seen = self.of(name, text)
        selectors = {} if is_cad_file(name) else selectors_of(text)
        tolerance = tolerance_of(text) if selectors else TOLERANCE
        named, wrong = surfaces_of(selectors, seen.made, seen.faces, tolerance)
        taken = {number for found in named.values() for number in found}
        rest = [i for i, f in enumerate(seen.faces) if len(f.bodies) == 1 and i not in taken]
        known = known_surfaces(seen.faces, {**named, REST: [*named.get(REST, ()), *rest]})
        content = {} if is_cad_file(name) else content_of(text)
        wrong |= {} if wrong else lost_surfaces(content, known)
        return {
            "surfaces": named, "wrong": wrong, "rest": rest, "known": known,
            "drawing": self._drawing(name, text),
        }  # fmt: skip

    def _drawing(self, name: str, text: str) -> str:
        """Return a name of what is drawn, which changes when the faces may have changed."""
        part = self._part(name, text)
        stamps = [stamp(file.path) for file in part.files]
        return digest_of(repr((part, stamps)).encode())


def cad_of(text: str) -> CadGeometry:
    """Return the CAD files of the text of a case, whatever else is wrong in it.

    Raises:
        CaseError: it has none.
    """
    given = content_of(text).get("geometry")
    cad = Geometry.read(given).cad if isinstance(given, dict) else None
    if cad is None:
        raise CaseError("this case has no CAD file, whose faces could be shown and named")
    return cad


def selectors_of(text: str) -> dict[str, Any]:
    """Return keys and values of the selectors of a case by the names of their surfaces."""
    given = content_of(text).get("geometry", {})
    found = given.get("surfaces", {}) if isinstance(given, dict) else {}
    return dict(found) if isinstance(found, dict) else {}


def tolerance_of(text: str) -> float:
    """Return the tolerance of lengths of a case [m]."""
    try:
        return cad_of(text).tolerance
    except CaseError:
        return TOLERANCE


def known_surfaces(
    faces: Sequence[Face], named: Mapping[str, Sequence[int]]
) -> dict[str, list[int]]:
    """Return the faces of surfaces by "body/surface", and those that a body shares by the other.

    Args:
        faces: of the part.
        named: faces of surfaces by their names.
    """
    found: dict[str, list[int]] = {}
    for surface, numbers in named.items():
        for number in numbers:
            for body in faces[number].bodies:
                found.setdefault(f"{body}/{surface}", []).append(number)
    for number, face in enumerate(faces):
        for body, other in permutations(face.bodies, 2):
            found.setdefault(f"{body}/{other}", []).append(number)
    return found


def extents_of(seen: SeenPart) -> dict[str, list[float]]:
    """Return the lengths of the box round each body along x, y and z [m].

    Args:
        seen: the part.
    """
    found = {}
    for body in bodies_of(seen.faces, {}):
        corners = [
            triangles.reshape(-1, 3)
            for face, triangles in zip(seen.faces, seen.triangles, strict=True)
            if body in face.bodies
        ]
        found[body] = [float(f"{x:.6g}") for x in np.ptp(np.concatenate(corners), axis=0)]
    return found


def bodies_of(faces: Sequence[Face], content: Mapping[str, Any]) -> list[str]:
    """Return the names of the bodies that have faces, first those of a case in its order.

    So bodies have the same colours here and in the view of the mesh.

    Args:
        faces: of the part.
        content: of the case file, whatever is wrong in it; empty: there is none.
    """
    given = content.get("bodies")
    entries = given if isinstance(given, list) else []
    names = [entry.get("name") for entry in entries if isinstance(entry, Mapping)]
    found = list(dict.fromkeys(body for face in faces for body in face.bodies))
    return sorted(found, key=lambda name: names.index(name) if name in names else len(names))


def stamp(path: str) -> tuple[str, int, int]:
    """Return path, time and size of a file, by which a change of it shows.

    Raises:
        CaseError: there is none.
    """
    try:
        found = Path(path).stat()
    except OSError as error:
        raise CaseError(f"cannot read the CAD file {path}: {error.strerror}") from None
    return path, found.st_mtime_ns, found.st_size
