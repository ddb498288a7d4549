"""The geometry of a case from CAD files."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, PlainValidator, StrictStr

from castx.case.cad.mould import CadMould, symmetry_planes
from castx.case.cad.selectors import FaceSelector
from castx.case.cad.sizes import LocalSize
from castx.errors import CaseError
from castx.input.entries import Description, EntryName, Name, Quantity, Whole
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import LENGTH, PURE_NUMBER, number

SUFFIXES = (".step", ".stp", ".brep", ".iges", ".igs")
"""Ends of the names of CAD files."""
_MOST_FILES = 100
_MOST_SURFACES = 1000


def is_cad_file(value: Any) -> bool:
    """Return whether a path ends like a CAD file."""
    return isinstance(value, str | Path) and str(value).lower().endswith(SUFFIXES)


def _cad_file(value: Any) -> Path:
    if not is_cad_file(value) or "\0" in str(value):
        known = ", ".join(SUFFIXES)
        raise CaseError(f"the path of a CAD file is needed, relative to the case file ({known})")
    return Path(value)


def _files(value: Any) -> tuple[Path, ...]:
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= _MOST_FILES:
        raise CaseError(f"a list of 1 to {_MOST_FILES} CAD files is needed")
    files = []
    for index, entry in enumerate(value):
        try:
            files.append(_cad_file(entry))
        except CaseError as error:
            raise refuse(str(error), index) from None
    return tuple(files)


def _surfaces(value: Any) -> dict[str, FaceSelector]:
    if not isinstance(value, dict) or len(value) > _MOST_SURFACES:
        raise CaseError('a table is needed: { top = { normal = "+z" }, … }')
    surfaces = {}
    for name, selector in value.items():
        try:
            surfaces[Name().read(name)] = FaceSelector.read(selector)
        except Refusal as error:
            raise error.inside(name) from None
        except CaseError as error:
            raise refuse(str(error), name) from None
    return surfaces


def _interface_size(value: Any) -> float | None:
    if value == "auto":
        raise CaseError(
            "a length is needed: generators alone find it themselves; castx new writes one, and "
            "castx check says which is fine enough"
        )
    return None if value is None else Quantity(LENGTH, above=0.0).read(value)


def _size_map(value: Any) -> Path | None:
    if value is None:
        return None
    if not isinstance(value, str | Path) or not str(value).endswith(".vtu") or "\0" in str(value):
        raise CaseError(
            "the path of a VTU file with sizes is needed, relative to the case file; "
            "castx run --adapt writes some"
        )
    return Path(value)


def _unit(value: Any) -> float:
    if not isinstance(value, str):
        raise CaseError('a unit of length is needed: "mm", "inch", …')
    return number(f"1 {value}", LENGTH)


class CadGeometry(Description):
    """Solids of CAD files, their surfaces, and how they are meshed.

    Attributes:
        file: of an assembly or a part, relative to the case file, after loading absolute.
        files: several of them.
        parts: the file of each body.
        unit: of the numbers of BREP files [m]; STEP and IGES files carry their own.
        names: body of a label of the CAD file, or of `solid-1`, … in their order.
        tolerance: gaps and overlaps of solids up to it are closed [m].
        narrowest: faces that are narrower are taken out with what they bound: grooves, threads,
            letters, roundings; the faces round them grow together [m].
        size: largest element size [m].
        curvature: elements round a full circle.
        across: cells across a wall; 0: as many as the other sizes make.
        interface_size: size on faces that two bodies share [m]; None: as elsewhere.
        growth: by how much sizes grow over a distance, as a share of it.
        sizes: at places.
        size_map: file with sizes over space, as `castx run --adapt` writes them, relative to the
            case file, after loading absolute; the least of all sizes holds.
        refinement: by which all sizes are divided, those by walls and curvature too.
        most_cells: that the mesh may have.
        mould: made round the solids.
        symmetry: axis and place of planes that cut everything [m], and whether what is above stays.
        surfaces: selectors of faces by the names of surfaces; all other free faces are `outside`.
    """

    file: Annotated[Path | None, PlainValidator(_cad_file)] = None
    files: Annotated[tuple[Path, ...], PlainValidator(_files)] = ()
    parts: dict[EntryName, Annotated[Path, PlainValidator(_cad_file)]] = Field(
        {}, max_length=_MOST_FILES
    )
    unit: Annotated[float, PlainValidator(_unit)] = 1e-3
    names: dict[StrictStr, EntryName] = Field({}, max_length=_MOST_SURFACES)
    tolerance: Annotated[float, Quantity(LENGTH, least=0.0)] = 1e-6
    narrowest: Annotated[float, Quantity(LENGTH, least=0.0)] = 0.0
    size: Annotated[float, Quantity(LENGTH, above=0.0)]
    curvature: Annotated[float, Quantity(PURE_NUMBER, least=3.0, most=1000.0)] = 16.0
    across: Annotated[int, Whole(0, 20)] = 2
    interface_size: Annotated[float | None, PlainValidator(_interface_size)] = None
    growth: Annotated[float, Quantity(PURE_NUMBER, least=0.05, most=2.0)] = 0.4
    sizes: tuple[LocalSize, ...] = Field((), max_length=_MOST_SURFACES)
    size_map: Annotated[Path | None, PlainValidator(_size_map)] = None
    refinement: Annotated[float, Quantity(PURE_NUMBER, least=0.1, most=20.0)] = 1.0
    most_cells: Annotated[float, Quantity(PURE_NUMBER, least=1.0, most=1e9)] = 2e6
    mould: CadMould | None = None
    symmetry: Annotated[tuple[tuple[int, float, bool], ...], PlainValidator(symmetry_planes)] = ()
    surfaces: Annotated[dict[str, FaceSelector], PlainValidator(_surfaces)] = Field({})

    @property
    def sources(self) -> list[tuple[Path, str | None]]:
        """The files, each with the body that all its solids make, or None."""
        single = [self.file] if self.file is not None else []
        plain: list[tuple[Path, str | None]] = [(path, None) for path in (*single, *self.files)]
        return plain + [(path, body) for body, path in self.parts.items()]

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield sources that exclude each other, and values that change nothing."""
        given = [key for key in ("file", "files", "parts") if getattr(self, key)]
        if len(given) != 1:
            yield Problem((), "give one of file, files and parts")
        size = self.size / self.refinement
        if self.tolerance > size / 2:
            text = f"must be at most half of size, {size:g} m: it would close what is meshed"
            yield Problem(("tolerance",), text)
        if self.interface_size is not None and self.interface_size > self.size:
            yield Problem(("interface_size",), f"must not exceed size, {self.size:g} m")
        for index, local in enumerate(self.sizes):
            if local.size > self.size:
                yield Problem(("sizes", index, "size"), f"must not exceed size, {self.size:g} m")
            if local.surface is not None and local.surface not in self.surfaces:
                known = among(local.surface, list(self.surfaces), what="surfaces")
                yield Problem(("sizes", index, "surface"), f"no such surface; {known}")
        brep = any(str(path).lower().endswith(".brep") for path, _ in self.sources)
        if "unit" in self.model_fields_set and not brep:
            yield Problem(("unit",), "STEP and IGES files carry their own unit; leave it out")

    def relative_to(self, folder: Path) -> Self:
        """Return the geometry with files in a folder [absolute paths]."""
        return self.model_copy(
            update={
                "file": None if self.file is None else folder / self.file,
                "files": tuple(folder / path for path in self.files),
                "parts": {body: folder / path for body, path in self.parts.items()},
                "size_map": None if self.size_map is None else folder / self.size_map,
            }
        )
