"""Estimates whether a mesh fits into memory before it is made.

Elements are counted on a coarse mesh of the same geometry, with all sizes scaled alike; those of a
file follow from its length.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from math import prod
from pathlib import Path

from mpi4py import MPI

from castx.case.geometry import GENERATORS, Geometry
from castx.domain.source import named_mesh, source_of
from castx.errors import MeshError

log = logging.getLogger(__name__)

MAKING = {(2, True): 1100.0, (2, False): 1500.0, (3, True): 1300.0, (3, False): 2500.0}
"""Bytes per element of making and distributing a mesh, by dimension and whether simplicial."""
SOLVING = {(2, True): 6500.0, (2, False): 13_000.0, (3, True): 5000.0, (3, False): 25_000.0}
"""Bytes per element of a coupled run with the solvers that are chosen by size."""
FILE = 40.0
"""Bytes per element of a gmsh file."""
SAMPLE = 4000
"""Elements of the coarse mesh in a box round the geometry."""
MOST_FULL = 20.0
"""Upper bound of the elements of a generator per cube of the element size in that box."""

_SIZES = ("size", "interface_size")


def refuse_too_large(
    geometry: Geometry, body_names: Sequence[str], comm: MPI.Intracomm, *, solved: bool
) -> None:
    """Refuse a mesh that cannot fit into the free memory; collective.

    Args:
        geometry: to be meshed.
        body_names: names of its bodies.
        comm: ranks among which the solution is divided; the first one makes the mesh alone.
        solved: whether the run itself has to fit, or only the mesh.

    Raises:
        MeshError: names the estimate, the free memory and a size that would fit; on all ranks.
    """
    computers = comm.Split_type(MPI.COMM_TYPE_SHARED)
    count = comm.allreduce(int(computers.rank == 0))
    computers.Free()
    refusal = None
    if comm.rank == 0:
        refusal = _refusal(geometry, body_names, available_memory(), count if solved else 0)
    refusal = comm.bcast(refusal)
    if refusal is not None:
        raise MeshError(refusal)


def _refusal(
    geometry: Geometry, body_names: Sequence[str], free: float, computers: int
) -> str | None:
    """Return why a mesh does not fit into memory, or None.

    Args:
        geometry: of the mesh.
        body_names: names of its bodies.
        free: memory [bytes].
        computers: number of computers that solve together; 0: only the mesh is made, on one.
    """
    if geometry.cad is not None:  # its mesher keeps a budget
        return None
    kind = (geometry.gdim, geometry.arguments.get("cells", "simplices") == "simplices")
    need = SOLVING[kind] / computers if computers else MAKING[kind]
    if geometry.file is None and _most_elements(geometry) * need < free:
        return None
    elements = estimated_elements(geometry, body_names)
    if elements * need < free:
        return None
    purpose = "solving with them" if computers else "the mesh alone"
    text = (
        f"{source_of(geometry)}: about {elements:.1e} elements; {purpose} needs about "
        f"{_amount(elements * need)} of memory, and {_amount(free)} are free"
    )
    if geometry.file is not None:
        return f"{text}; use a coarser mesh" + (" or more computers" if computers else "")
    size = geometry.arguments["size"]
    fitting = size * (1.5 * elements * need / free) ** (1 / geometry.gdim)
    rest = ", interface_size in proportion," if "interface_size" in geometry.arguments else ""
    return f"{text}; geometry.size of {fitting:.2g} m instead of {size:g} m{rest} would fit"


def _box(geometry: Geometry, size: float) -> float:
    """Return the number of cubes of a size in a box round a generated geometry."""
    extents = GENERATORS[str(geometry.generator)].outer_dimensions(geometry.arguments)
    extents += [max(extents)] * (geometry.gdim - len(extents))
    return prod(max(extent / size, 1.0) for extent in extents)


def _most_elements(geometry: Geometry) -> float:
    sizes = [geometry.arguments[key] for key in _SIZES if key in geometry.arguments]
    return MOST_FULL * _box(geometry, min(sizes))


def estimated_elements(geometry: Geometry, body_names: Sequence[str]) -> float:
    """Return an estimate of the number of elements of a geometry."""
    if geometry.file is not None:
        return _length(geometry.file) / FILE
    sizes = {key: geometry.arguments[key] for key in _SIZES if key in geometry.arguments}
    factor = (_box(geometry, min(sizes.values())) / SAMPLE) ** (1 / geometry.gdim)
    if factor <= 1.0:
        return _most_elements(geometry)
    coarse = {key: factor * size for key, size in sizes.items()}
    sample = geometry.model_copy(update={"arguments": {**geometry.arguments, **coarse}})
    try:
        counted = len(named_mesh(sample, body_names).cells)
    except Exception as error:  # of gmsh or of a check: too coarse for some detail
        log.debug("no coarse mesh to count elements on: %s", error)
        return _box(geometry, min(sizes.values()))
    return float(counted * factor**geometry.gdim)


def _length(file: Path) -> int:
    try:
        return file.stat().st_size
    except OSError:  # said better when it is opened
        return 0


def available_memory() -> float:
    """Return the free memory of this computer [bytes]."""
    found = [float("inf")]
    for line in _lines(Path("/proc/meminfo")):
        if line.startswith("MemAvailable:"):
            found.append(1024.0 * float(line.split()[1]))
    groups = Path("/sys/fs/cgroup")
    limit, used = (_lines(groups / f"memory.{name}") for name in ("max", "current"))
    if limit and used and limit[0].isdecimal():
        found.append(float(limit[0]) - float(used[0]))
    return min(found)


def _lines(file: Path) -> list[str]:
    try:
        return file.read_text().splitlines()
    except OSError:
        return []


def _amount(size: float) -> str:
    return f"{size / 1e9:.3g} GB"
