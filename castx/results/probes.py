"""probes.csv: quantities at points of bodies and interfaces, one line per accepted step."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.results.files.series import Series, cut_back
from castx.results.locate import Place, place_below, place_in_body, place_on_surface
from castx.results.states.quantities import CELLWISE, on_secondary_nodes, parts
from castx.results.states.snapshot import Snapshot

if TYPE_CHECKING:
    from castx.case.output import Probe
    from castx.domain.mesh import CastingMesh
    from castx.domain.pairs.node_pairs import NodePairs

INSIDE = 1e-6
"""Distance from a body, in sizes of its cells, at which a point still counts as one of it."""


@dataclass(frozen=True)
class Reading:
    """One quantity at one place: the names of its columns, and how to read it off a snapshot.

    `read` is collective; it returns (columns,), zeros except on the rank that owns the place.
    Readings at bodies that are removed are NaN.
    """

    columns: tuple[str, ...]
    bodies: tuple[str, ...]
    read: Callable[[Snapshot], FloatArray]


class Probes:
    """Writer of probes.csv.

    Args:
        path: the file, written on rank 0.
        probes: their descriptions.
        mesh: the bodies.
        pairs: the node pairs by the names of their interfaces.

    Raises:
        CaseError: a probe lies outside its body or interface; on all ranks.
    """

    def __init__(
        self,
        path: Path,
        probes: Sequence[Probe],
        mesh: CastingMesh,
        pairs: Mapping[str, NodePairs],
    ) -> None:
        self._comm = mesh.comm
        self._readings = [
            reading for probe in probes for reading in readings_of(probe, mesh, pairs)
        ]
        self._path = path
        self._series: Series | None = None

    @property
    def columns(self) -> list[str]:
        """Names of the columns behind the time."""
        return [column for reading in self._readings for column in reading.columns]

    def open(self, kept: int | None = None) -> None:
        """Begin the file; an older one is written over, or keeps its first lines."""
        if self._comm.rank > 0:
            return
        if kept is not None:
            cut_back(self._path, kept)
        self._series = Series(self._path, ["time", *self.columns], resumed=kept is not None)

    def append(self, snapshot: Snapshot) -> None:
        """Write the line of one accepted step; collective."""
        own = [value_of(reading, snapshot) for reading in self._readings]
        row = np.concatenate(own) if own else np.empty(0)
        total = np.empty_like(row)
        self._comm.Reduce(row, total, MPI.SUM, root=0)
        if self._series is not None:
            self._series.append([snapshot.time, *total])

    def sync(self) -> None:
        """Bring all lines to disk; on rank 0."""
        if self._series is not None:
            self._series.sync()

    def close(self) -> None:
        """Close the file."""
        if self._series is not None:
            self._series.close()


def value_of(reading: Reading, snapshot: Snapshot) -> FloatArray:
    """Return the contribution of this rank to a reading, see `Reading`; collective."""
    if set(reading.bodies) <= set(snapshot.mesh.bodies):
        return reading.read(snapshot)
    return np.full(len(reading.columns), np.nan)


def readings_of(probe: Probe, mesh: CastingMesh, pairs: Mapping[str, NodePairs]) -> list[Reading]:
    """Return the readings of one probe."""
    where = f"probe {probe.name!r}"
    if probe.body is not None:
        if probe.below is not None:
            place = buried_place(probe, mesh, pairs)
        else:
            place = place_in_body(mesh.bodies[probe.body], probe.at)
            require_near(place, f"{where} at {point_text(probe.at)}", f"body {probe.body!r}")
        return [
            body_reading(probe.name, probe.body, quantity, place, mesh.model)
            for quantity in probe.quantities
        ]
    name = str(probe.interface)
    secondary = mesh.bodies[pairs[name].secondary]
    place = place_on_surface(secondary, pairs[name].surface, probe.at)
    require_near(place, f"{where} at {point_text(probe.at)}", f"interface {name!r}")
    return [interface_reading(probe.name, name, quantity, place) for quantity in probe.quantities]


def buried_place(probe: Probe, mesh: CastingMesh, pairs: Mapping[str, NodePairs]) -> Place:
    """Return the place of a probe at a depth under a surface of its body; collective.

    Raises:
        CaseError: the surface is far from the point, or the body is thinner than the depth there.
    """
    body, below = mesh.bodies[str(probe.body)], str(probe.below)
    surface = surface_on(body.name, below, pairs)
    where = f"probe {probe.name!r} at {point_text(probe.at)}"
    require_near(place_on_surface(body, surface, probe.at), where, f"the surface {below!r}")
    place = place_below(mesh, body, surface, probe.at, probe.depth)
    if place.distance > INSIDE * place.size:
        raise CaseError(
            f"{where} is {probe.depth:g} m below {below!r}, where body {body.name!r} has ended "
            f"{place.distance:.4g} m before; choose a smaller depth, or another point"
        )
    return place


def surface_on(body: str, below: str, pairs: Mapping[str, NodePairs]) -> str:
    """Return the name that a surface has on a body.

    Args:
        body: the body.
        below: an interface of the body, or "body/surface".
        pairs: of the interfaces.

    Raises:
        CaseError: the interface has two surfaces, of which that of the body is not known.
    """
    found = pairs.get(below)
    if found is None:
        return below.removeprefix(f"{body}/")
    if body == found.secondary:
        return found.surface
    if found.surface != found.primary:
        raise CaseError(
            f"a probe below {below!r}: its bodies have surfaces of their own; name that of "
            f'{body!r}, below = "{body}/SURFACE"'
        )
    return found.secondary


def require_near(place: Place, probe: str, owner: str) -> None:
    """Refuse a probe that lies an element or more away from where it belongs.

    Raises:
        CaseError: with the distance and the nearest point.
    """
    if place.distance >= place.size:
        nearest = point_text([round(float(x), 9) for x in place.foot])
        raise CaseError(
            f"{probe} lies outside {owner}: it is {place.distance:.4g} m away from its nearest "
            f"point, {nearest}, and only points nearer than one element "
            f"({place.size:.4g} m) are moved there; choose a point inside"
        )


def point_text(point: Sequence[float]) -> str:
    """Return the coordinates of a point as text."""
    return f"({', '.join(f'{value:g}' for value in point)}) m"


def body_reading(probe: str, body: str, quantity: str, place: Place, model: str) -> Reading:
    """Return the reading of a nodal quantity, interpolated, or of a cell's, as it is there."""
    suffixes = parts(quantity, model)
    columns = tuple(f"{probe}.{quantity}.{suffix}" for suffix in suffixes)

    def read(snapshot: Snapshot) -> FloatArray:
        if not place.owned:
            return np.zeros(max(1, len(suffixes)))
        if quantity in CELLWISE:
            value = snapshot.cellwise(body, quantity)[place.entity]
        else:
            value = place.interpolate(snapshot.nodal(body, quantity))
        return np.atleast_1d(value)[: len(suffixes) or None]

    return Reading(columns or (f"{probe}.{quantity}",), (body,), read)


def interface_reading(probe: str, interface: str, quantity: str, place: Place) -> Reading:
    """Return the reading of a quantity of pairs, interpolated on the facet of the place."""

    def read(snapshot: Snapshot) -> FloatArray:
        values = on_secondary_nodes(snapshot, interface, quantity)
        return np.atleast_1d(place.interpolate(values))

    bodies = tuple(interface.split("/"))
    return Reading((f"{probe}.{quantity}",), bodies, read)
