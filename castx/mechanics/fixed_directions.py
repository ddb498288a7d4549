"""Directions in which the displacement of nodes is prescribed, or common to all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.measures import bounding_box, nodal_area_vectors
from castx.domain.mesh import BodyMesh
from castx.errors import CaseError
from castx.mechanics.rigid_modes import rigid_motions
from castx.meshes.model import SYMMETRY
from castx.tables import Table

ZERO = Table.constant(0.0)

PARALLEL = 1e-6
"""Sine below which two directions are the same."""

HELD = 1e-3
"""Part of the size of a body by which its supports miss an even shrinkage before they hinder it."""


@dataclass(frozen=True)
class FixedDirections:
    """One direction at each of several nodes of a body, along which the displacement is prescribed.

    Attributes:
        name: the surface and direction, for messages.
        nodes: local numbers of owned nodes, shape (n,).
        directions: unit vectors, shape (n, dimension).
        value: displacement over time [m]; None: all nodes move equally, their resultant is free.
        symmetry: whether the body goes on as its mirror image behind the surface.
        surface: where the nodes are; empty: on the axis.
    """

    name: str
    nodes: IntArray
    directions: FloatArray
    value: Table | None = ZERO
    symmetry: bool = False
    surface: str = ""

    def cancel(self, vectors: FloatArray, nodes: IntArray, owned: int) -> None:
        """Remove from sums over a surface the part that the mirror image behind this one cancels.

        Args:
            vectors: at nodes, changed in place, shape (n, dimension).
            nodes: local numbers of owned nodes, shape (n,).
            owned: number of owned nodes of the body.
        """
        position = np.full(owned, -1)
        position[self.nodes] = np.arange(len(self.nodes))
        found = position[nodes]
        here = found >= 0
        e = self.directions[found[here]]
        vectors[here] -= np.sum(vectors[here] * e, axis=1, keepdims=True) * e


def parallel(directions: FloatArray, direction: FloatArray) -> BoolArray:
    """Return the unit vectors that lie along another one as a mask, shape (n,)."""
    across = directions - np.outer(directions @ direction, direction)
    return np.asarray(np.linalg.norm(across, axis=1) < PARALLEL)


@dataclass(frozen=True)
class SurfaceDisplacement:
    """A displacement condition on a named surface of a body.

    Attributes:
        surface: name of the surface.
        direction: "x", "y", "z", "r", "normal" or "all".
        value: displacement over time [m]; None: uniform, the resultant is free.
    """

    surface: str
    direction: str
    value: Table | None = ZERO

    @property
    def symmetry(self) -> bool:
        """Whether the body goes on as its mirror image behind the surface."""
        return self.surface.startswith(SYMMETRY) and self.direction == "normal"


def fixed_directions(
    body: BodyMesh, model: str, conditions: Sequence[SurfaceDisplacement]
) -> list[FixedDirections]:
    """Return the fixed directions of a body: its conditions, symmetry planes and the axis.

    Surfaces named `symmetry-…` have normal displacement 0 unless a condition names them.

    Args:
        body: mesh of the body.
        model: geometric model.
        conditions: on the surfaces of the body.

    Raises:
        CaseError: a direction that the model does not have.
    """
    named = {condition.surface for condition in conditions}
    planes = [
        SurfaceDisplacement(surface, "normal")
        for surface in body.symmetry_planes
        if surface not in named
    ]
    found = [_axis(body)] if model == "axisymmetric" else []
    for condition in sorted([*planes, *conditions], key=lambda c: not c.symmetry):
        mirrors = [directions for directions in found if directions.symmetry]
        found.extend(_directions_on_surface(body, model, condition, mirrors))
    return found


def _directions_on_surface(
    body: BodyMesh,
    model: str,
    condition: SurfaceDisplacement,
    mirrors: Sequence[FixedDirections],
) -> list[FixedDirections]:
    nodes = body.surface_nodes(condition.surface)
    owned = nodes[nodes < body.nodes.dofmap.index_map.size_local]
    dimension = body.mesh.geometry.dim
    if condition.direction == "normal":
        vectors = [_unit_normals(body, model, condition.surface, owned, mirrors)]
    else:
        axes = axes_of(model)
        wanted = list(axes) if condition.direction == "all" else [condition.direction]
        unknown = [axis for axis in wanted if axis not in axes]
        if unknown:
            raise CaseError(
                f"displacement {unknown[0]!r} on {body.name}/{condition.surface}: the model "
                f"{model!r} has the directions {', '.join(axes)}, normal and all"
            )
        vectors = [np.tile(np.eye(dimension)[axes[a]], (len(owned), 1)) for a in wanted]
    name = f"{body.name}/{condition.surface} {condition.direction}"
    return [
        FixedDirections(name, owned, v, condition.value, condition.symmetry, condition.surface)
        for v in vectors
    ]


def hinders_shrinkage(body: BodyMesh, model: str, fixed: Sequence[FixedDirections]) -> bool:
    """Return whether fixed directions keep a body from shrinking evenly; collective.

    They do not where some rigid motion, added to u = -x, moves no node along its direction: planes
    of symmetry and three supports on a face let a body shrink, two ends that are held do not.

    Args:
        body: mesh of the body.
        model: geometric model.
        fixed: of the body; nodes that move equally, by no matter how much, are one more motion.
    """
    comm = body.mesh.comm
    low, high = bounding_box(body.points, comm)
    size = float(np.linalg.norm(high - low))
    free = [condition for condition in fixed if condition.value is None]
    rigid = len(rigid_motions(np.zeros((0, len(low))), model, (low, high)))
    A, b = [np.zeros((0, rigid + len(free)))], [np.zeros(0)]
    for condition in fixed:
        e, points = condition.directions, body.points[condition.nodes]
        x: FloatArray = np.subtract(points, low) / np.float64(size)
        if model == "axisymmetric":
            x[:, 0] += low[0] / size
        motions = rigid_motions(points, model, (low, high))
        moved = np.column_stack([np.sum(motion * e, axis=1) for motion in motions])
        equal = np.array([float(condition is other) for other in free])
        A.append(np.hstack([moved, np.tile(equal, (len(e), 1))]))
        b.append(np.sum(e * x, axis=1))
    rows, wanted = np.vstack(A), np.concatenate(b)
    normal = comm.allreduce(np.column_stack([rows.T @ rows, rows.T @ wanted]), op=MPI.SUM)
    found = np.linalg.lstsq(normal[:, :-1], normal[:, -1])[0]
    off = float(np.abs(rows @ found - wanted).max(initial=0.0))
    return bool(comm.allreduce(off, op=MPI.MAX) > HELD)


def axes_of(model: str) -> dict[str, int]:
    """Return the numbers of the directions of a model by name."""
    if model == "3d":
        return {"x": 0, "y": 1, "z": 2}
    return {"r": 0, "z": 1} if model == "axisymmetric" else {"x": 0, "y": 1}


def _axis(body: BodyMesh) -> FixedDirections:
    radius = body.nodes.tabulate_dof_coordinates()[:, 0]
    owned = body.nodes.dofmap.index_map.size_local
    largest = body.mesh.comm.allreduce(float(radius.max(initial=0.0)), op=MPI.MAX)
    nodes = np.flatnonzero(radius[:owned] < 1e-9 * largest).astype(np.int32)
    directions = np.tile(np.array([1.0, 0.0]), (len(nodes), 1))
    return FixedDirections(f"{body.name} axis", nodes, directions, symmetry=True)


def _unit_normals(
    body: BodyMesh,
    model: str,
    surface: str,
    nodes: IntArray,
    mirrors: Sequence[FixedDirections],
) -> FloatArray:
    """Return outward normals averaged by area at owned nodes, as if the mirror images were there.

    Zero where the mirror images cancel them.
    """
    # Of this degree at all times: another one moves the normals by round-off.
    vectors = nodal_area_vectors(body, model, surface, 2)[nodes]
    smallest = PARALLEL * np.linalg.norm(vectors, axis=1, keepdims=True)
    for mirror in mirrors:
        mirror.cancel(vectors, nodes, body.nodes.dofmap.index_map.size_local)
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    none = np.zeros_like(vectors)
    return np.asarray(np.divide(vectors, lengths, out=none, where=lengths > smallest))
