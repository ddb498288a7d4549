"""The solids of CAD files in the current gmsh model, with their labels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.description import MILLIMETRES, CadFile

FORMATS = {"step": "step", "stp": "step", "brep": "brep", "iges": "iges", "igs": "iges"}
"""gmsh's name of a format, by the end of a file's name."""
ALLOWED = "_+- "
LONGEST_NAME = 64
UNNAMED = ("", "SOLID", "Solid", "Open CASCADE STEP translator")
"""Beginnings of labels that programs give by themselves."""
SEWN = 1e-2
"""Distance up to which the edges of lone faces are joined to solids [mm]."""


@dataclass(frozen=True)
class Solid:
    """A solid as read.

    Args:
        tag: of its volume in the model.
        name: of the body it belongs to.
        label: in the file, or "" without one.
        rank: where several solids are, that of the highest rank stays.
    """

    tag: int
    name: str
    label: str
    rank: int = 0


def read_solids(
    files: Sequence[CadFile], names: Mapping[str, str], scratch: str = "sewn.brep"
) -> list[Solid]:
    """Read the solids of CAD files into the current gmsh model, in millimetres.

    Args:
        files: to be read.
        names: body of a label or of `solid-1`, `solid-2`, … where it is not the label. Without
            both, the only solid of a file is called like the file.
        scratch: a BREP file to write if surfaces have to be sewn to solids.

    Raises:
        ValueError: a file cannot be read or has no solid, or a name fits no solid.
    """
    found: list[tuple[CadFile, int, str]] = []
    known = []
    for file in files:
        tags = _import(file, scratch)
        labels = [label_of(tag) for tag in tags]
        found += [(file, tag, label) for tag, label in zip(tags, labels, strict=True)]
        known += [stem_of(file.path)] if labels == [""] else labels
    solids, used = [], set()
    for index, (file, tag, label) in enumerate(found):
        keys = (label, f"solid-{index + 1}")
        given = [key for key in keys if key and key in names]
        used.update(given)
        if given:
            name = names[given[0]]
        else:
            name = file.body or numbered(known, index)
        solids.append(Solid(tag, name, label))
    _refuse_unknown([key for key in names if key not in used], solids)
    return solids


def numbered(labels: Sequence[str], index: int) -> str:
    """Return the name of a solid: its label, with a number if several have it, or its order."""
    name = clean(labels[index])
    if not name:
        return f"solid-{index + 1}"
    cleaned = [clean(label) for label in labels]
    if cleaned.count(name) == 1:
        return name
    return f"{name}-{cleaned[: index + 1].count(name)}"


def stem_of(path: str) -> str:
    """Return the name of a file without its folder and its end."""
    return path.replace("\\", "/").rpartition("/")[2].rpartition(".")[0]


def clean(label: str) -> str:
    """Return a label as the name of a body: other characters become hyphens."""
    name = "".join(c if c.isalnum() or c in ALLOWED else "-" for c in label).strip()
    return name[:LONGEST_NAME].strip()


def label_of(tag: int) -> str:
    """Return the label of a volume, or "" if no person has given it."""
    label = str(gmsh.model.getEntityName(3, tag)).rpartition("/")[2].strip()
    alone = label in UNNAMED or label.startswith(UNNAMED[-1])
    return "" if alone else label


def _import(file: CadFile, scratch: str) -> list[int]:
    """Return the tags of the solids of a file."""
    kind = FORMATS[file.path.rpartition(".")[2].lower()]
    _refuse_other_files(file.path, kind)
    solids = [tag for dim, tag in _new_shapes(file.path, kind) if dim == 3]
    if not solids:
        gmsh.model.occ.remove(_faces_without_solid(), recursive=True)
        gmsh.model.occ.synchronize()
        _sew(file.path, kind, scratch)
        solids = [tag for dim, tag in _new_shapes(scratch, "brep") if dim == 3]
    factor = file.unit * MILLIMETRES
    if kind == "brep" and factor != 1.0:
        gmsh.model.occ.dilate([(3, tag) for tag in solids], 0, 0, 0, factor, factor, factor)
        gmsh.model.occ.synchronize()
    return solids


def _new_shapes(path: str, kind: str) -> list[tuple[int, int]]:
    """Import a file and return its shapes of highest dimension."""
    before = set(gmsh.model.getEntities())
    # Millimetres are OpenCASCADE's own unit; the readers of other formats know no option for it.
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM" if kind == "step" else "")
    try:
        gmsh.model.occ.importShapes(path, highestDimOnly=True, format=kind)
    except Exception as error:  # gmsh raises nothing more special
        raise ValueError(
            f"{path} cannot be read: {error}; it is damaged or incomplete, export it again"
        ) from None
    gmsh.model.occ.synchronize()
    return [entity for entity in gmsh.model.getEntities() if entity not in before]


def _faces_without_solid() -> list[tuple[int, int]]:
    faces = gmsh.model.getEntities(2)
    return [face for face in faces if not len(gmsh.model.getAdjacencies(*face)[0])]


def _refuse_other_files(path: str, kind: str) -> None:
    try:
        with open(path, "rb") as file:
            start = file.read(4096)
    except OSError as error:
        raise ValueError(
            f"cannot read the CAD file {path}: {error.strerror}; a file of STEP, IGES or BREP is "
            "needed there, or another path"
        ) from None
    if not start.strip():
        raise ValueError(f"{path} is empty; export it again")
    right = {
        "step": b"ISO-10303-21" in start,
        "brep": b"DBRep_DrawableShape" in start or b"CASCADE Topology" in start,
        "iges": start[72:73] == b"S",
    }
    if not right[kind]:
        raise ValueError(
            f"{path} is no {kind.upper()} file: it begins with {start[:20]!r}; export the part as "
            "STEP, and do not rename files"
        )


def _sew(path: str, kind: str, scratch: str) -> None:
    """Write the solids that the surfaces of a file enclose, sewn in a model of their own.

    OpenCASCADE sews all that there is, so that one model would join the surfaces of all files.
    """
    outside = gmsh.model.getCurrent()
    gmsh.model.add("sewing")
    try:
        count = sum(dim == 2 for dim, _ in _new_shapes(path, kind))
        if not count:
            raise ValueError(f"{path} has no solids; export the part as solids (STEP, AP214)")
        gmsh.model.occ.healShapes(
            [], SEWN, fixDegenerated=False, fixSmallEdges=False, fixSmallFaces=False,
            sewFaces=True, makeSolids=True,
        )  # fmt: skip
        gmsh.model.occ.synchronize()
        solids = gmsh.model.getEntities(3)
        if not solids or min(gmsh.model.occ.getMass(*solid) for solid in solids) <= 0.0:
            raise ValueError(
                f"{path} has {count} surfaces and no solid, and they enclose none one by one: "
                "close the gaps between them, or export each part as a solid (STEP)"
            )
        gmsh.model.occ.remove(_faces_without_solid(), recursive=True)
        gmsh.model.occ.synchronize()
        gmsh.write(scratch)
    finally:
        gmsh.model.remove()
        gmsh.model.setCurrent(outside)


def _refuse_unknown(names: Sequence[str], solids: Sequence[Solid]) -> None:
    if names:
        raise ValueError(f"no solid has the label {names[0]!r}; there are:\n{solid_list(solids)}")


def solid_list(solids: Sequence[Solid]) -> str:
    """Return a line of text for each solid: name, label, volume and place."""
    lines = []
    for index, solid in enumerate(solids):
        volume = gmsh.model.occ.getMass(3, solid.tag) / MILLIMETRES**3
        place = place_text(centre_of(3, solid.tag))
        label = f"label {solid.label!r}" if solid.label else "without label"
        size = f"{1e6 * volume:.6g} cm³"
        lines.append(f"  solid-{index + 1}: {solid.name}, {label}, {size} at {place}")
    return "\n".join(lines)


def centre_of(dim: int, tag: int) -> FloatArray:
    """Return the centre of mass of an entity [m]."""
    return np.array(gmsh.model.occ.getCenterOfMass(dim, tag)) / MILLIMETRES


def place_text(point: FloatArray) -> str:
    """Return a point [m] as text."""
    return f"({', '.join(f'{round(float(x), 9) + 0.0:.4g}' for x in point)}) m"
