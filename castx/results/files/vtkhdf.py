"""One body of a run as a VTKHDF file: its mesh once, and its fields at every moment.

Kitware, VTK file formats, VTKHDF 2.0, UnstructuredGrid with Steps.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray
from castx.results.files.grown_file import (
    COMPRESSION,
    append_block,
    grown,
    is_grown,
    need_room,
    opened,
    set_step,
    step_numbers,
)
from castx.results.files.vtu import Piece, vtk_columns

ROOT, STEPS, COUNT = "VTKHDF", "Steps", "NSteps"
TIMES = "Values"
VERSION = (2, 0)
SLACK = 2**20
"""Room for what stands beside the fields [bytes]."""
SAME_MESH = {
    "PartOffsets": 0, "NumberOfParts": 1, "PointOffsets": 0, "CellOffsets": [0],
    "ConnectivityIdOffsets": [0],
}  # fmt: skip
"""What says that the mesh of a step is the one mesh of the file."""


@dataclass(frozen=True, eq=False)
class BodyFile:
    """The file of a body, to which the fields of one moment after the other are appended.

    Args:
        path: of the file.
        name: of the body.
        number: of the body; a cell array `body` holds it.
        whole: the mesh of the body.
        units: of the fields by name.
    """

    path: Path
    name: str
    number: int
    whole: Piece
    units: Mapping[str, str]

    def append(
        self, time: float, nodal: Mapping[str, FloatArray], cellwise: Mapping[str, FloatArray]
    ) -> None:
        """Append the fields of a later moment.

        Args:
            time: [s].
            nodal: fields at the points, (points,) or (points, gdim).
            cellwise: fields of the cells, (cells,), a symmetric tensor (cells, 6) as in `Snapshot`.

        Raises:
            OSError: the disk does not take it.
        """
        wanted = {
            "Point": {name: vtk_columns(values) for name, values in nodal.items()},
            "Cell": {name: vtk_columns(values) for name, values in cellwise.items()},
        }
        sizes = [values.nbytes for fields in wanted.values() for values in fields.values()]
        need_room(self.path.parent, sum(sizes) + self.whole.connectivity.nbytes + SLACK)
        if not self.path.exists():
            self._create()
        with opened(self.path, "r+") as file:
            steps = file[ROOT][STEPS]
            step = counted_steps(steps)
            for kind, fields in wanted.items():
                self._append(file[ROOT], kind, step, fields)
            for name, entry in SAME_MESH.items():
                set_step(steps[name], step, entry)
            file.flush()
            steps.attrs.modify(COUNT, step + 1)
            file.flush()
            set_step(steps[TIMES], step, time)

    def _append(
        self, root: h5py.Group, kind: str, step: int, fields: Mapping[str, npt.NDArray[Any]]
    ) -> None:
        """Append the fields of the points or cells; a field that is lacking has no numbers."""
        rows = len(self.whole.points) if kind == "Point" else self.whole.cells
        data, offsets = root[f"{kind}Data"], root[STEPS][f"{kind}DataOffsets"]
        for name in [*data, *(name for name in fields if name not in data)]:
            if name == "body":
                set_step(offsets[name], step, 0)
                continue
            values = fields.get(name)
            if name not in data:
                self._begin(data, offsets, name, fields[name], step)
            append_block(data[name], offsets[name], step, values, rows)

    def _begin(
        self,
        data: h5py.Group,
        offsets: h5py.Group,
        name: str,
        values: npt.NDArray[Any],
        step: int,
    ) -> None:
        """Begin a field, without numbers at the steps before."""
        field = grown(data, name, len(values), values)
        if name in self.units:
            field.attrs["units"] = self.units[name]
        numbers = step_numbers(offsets, name, 0)
        for earlier in range(step):
            append_block(field, numbers, earlier, None, len(values))

    def keep(self, times: Sequence[float]) -> None:
        """Keep the moments up to the last of some, or remove the file where there is none.

        Args:
            times: of the moments to keep, ascending [s].

        Raises:
            OSError: the file is damaged, or the disk does not take it.
        """
        if not self.path.exists():
            return
        if not times:
            self.path.unlink()
            return
        with damage_named(self.path), opened(self.path, "r+") as file:
            need_whole(file)
            self._need_own(file[ROOT])
            steps = file[ROOT][STEPS]
            kept = int(np.searchsorted(steps[TIMES][: counted_steps(steps)], times[-1], "right"))
            steps[TIMES].resize(kept, axis=0)
            file.flush()
            steps.attrs.modify(COUNT, kept)

    def _need_own(self, root: h5py.Group) -> None:
        """Refuse the file of another body or mesh, to which fields of this one do not belong."""
        name, points = root.attrs.get("name"), len(root.get("Points", ()))
        if (name, points) != (self.name, len(self.whole.points)):
            raise OSError(
                errno.EIO,
                f"it holds {points} points of {name!r}, not the {len(self.whole.points)} of "
                f"{self.name!r}",
            )

    def _create(self) -> None:
        """Write the file without a step, as a whole."""
        new = self.path.with_name(f".{self.path.name}.{os.getpid()}")
        try:
            with opened(new, "w") as file:
                self._write_mesh(file.create_group(ROOT))
            new.replace(self.path)
        finally:
            new.unlink(missing_ok=True)

    def _write_mesh(self, root: h5py.Group) -> None:
        mesh = self.whole
        root.attrs["Version"] = np.array(VERSION, dtype=np.int64)
        root.attrs["Type"] = np.bytes_("UnstructuredGrid")
        root.attrs["name"], root.attrs["number"] = self.name, self.number
        counts = {
            "NumberOfPoints": len(mesh.points),
            "NumberOfCells": mesh.cells,
            "NumberOfConnectivityIds": mesh.connectivity.size,
        }
        for name, count in counts.items():
            root[name] = np.array([count], dtype=np.int64)
        width = mesh.connectivity.size // mesh.cells
        arrays: dict[str, npt.NDArray[Any]] = {
            "Points": mesh.points,
            "Connectivity": mesh.connectivity,
            "Offsets": np.arange(0, mesh.connectivity.size + 1, width, dtype=np.int64),
            "Types": np.full(mesh.cells, mesh.kind, dtype=np.uint8),
            "CellData/body": np.full(mesh.cells, self.number, dtype=np.int32),
        }
        for name, array in arrays.items():
            root.create_dataset(name, data=array, **COMPRESSION)
        steps = root.create_group(STEPS)
        steps.attrs[COUNT] = 0
        for name, entry in {TIMES: 0.0, **SAME_MESH}.items():
            step_numbers(steps, name, entry)
        root.create_group("PointData")
        steps.create_group("PointDataOffsets")
        step_numbers(steps.create_group("CellDataOffsets"), "body", 0)


@contextmanager
def damage_named(path: Path) -> Iterator[None]:
    """Say of a file that is no VTKHDF file any more how the run goes on without it.

    Raises:
        OSError: it is damaged, or the disk does not take it.
    """
    try:
        yield
    except OSError as error:
        if error.errno != errno.EIO:
            raise
        text = f"it is damaged ({error.strerror}); move it away, and the restart begins a new one"
        raise OSError(errno.EIO, text, str(path)) from error


def need_whole(file: h5py.File) -> None:
    """Refuse a file that lacks what a further step needs.

    Raises:
        OSError: with the name of what is missing or no longer of its kind.
    """
    steps, found = f"{ROOT}/{STEPS}", file.get(f"{ROOT}/{STEPS}")
    if not isinstance(found, h5py.Group) or COUNT not in found.attrs:
        raise OSError(errno.EIO, f"{steps} is missing")
    if not is_grown(found.get(TIMES)):
        raise OSError(errno.EIO, f"{steps}/{TIMES} is missing")
    count = counted_steps(found)
    wanted = {f"{steps}/{name}": count for name in SAME_MESH}
    for kind in ("Point", "Cell"):
        fields, offsets = f"{ROOT}/{kind}Data", f"{steps}/{kind}DataOffsets"
        if not all(isinstance(file.get(group), h5py.Group) for group in (fields, offsets)):
            raise OSError(errno.EIO, f"{fields} is missing")
        names = {*file[fields], *file[offsets]}
        wanted |= {f"{offsets}/{name}": count for name in names}
        wanted |= {f"{fields}/{name}": 0 for name in names if name != "body"}
    for name, rows in wanted.items():
        if not is_grown(file.get(name), rows):
            raise OSError(errno.EIO, f"{name} is missing")


def counted_steps(steps: h5py.Group) -> int:
    """Return the number of steps that are whole.

    The time of a step is written last. VTK 9.3 reads all times that there are into room for
    `NSteps` of them, so that they may never be more.
    """
    return min(int(steps.attrs[COUNT]), len(steps[TIMES]))
