"""Rigid motions of a body: free motions without supports, near-null space of multigrid."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import FloatArray
from castx.domain.measures import bounding_box
from castx.mechanics.formulation import BodyUnknowns
from castx.mechanics.liquid.regions import CellRegions

Box = tuple[FloatArray, FloatArray]


def extent(parts: Sequence[BodyUnknowns]) -> Box:
    """Return the lowest and highest coordinates [m] of the nodes of bodies; collective."""
    points = np.concatenate([_points(unknowns) for unknowns in parts])
    return bounding_box(points, parts[0].mesh.mesh.comm)


def rigid_modes(unknowns: BodyUnknowns, box: Box | None = None) -> FloatArray:
    """Return the rigid motions of a body as owned unknowns, shape (modes, owned unknowns).

    Each moves no node by more than about one: rotations are taken about the middle of a box and
    scaled by its size. Axisymmetric bodies have only the axial translation.

    Args:
        unknowns: of the body.
        box: that of all bodies which move together; None: that of this body alone.
    """
    d, size = unknowns.dimension, unknowns.block_size
    points = _points(unknowns)
    owned = len(points)
    motions = rigid_motions(points, unknowns.model, box or extent([unknowns]))
    modes = np.zeros((len(motions), owned, size))
    for mode, motion in zip(modes, motions, strict=True):
        mode[:, :d] = motion
    return modes.reshape(len(motions), owned * size)


def modes_of_parts(unknowns: BodyUnknowns) -> FloatArray:
    """Return the rigid motions of each connected part of a body, as `rigid_modes`; collective.

    Parts have no node in common: the core inside of a casting with an open top, cut off from the
    mould outside of it, is one of the body "mould".
    """
    modes = rigid_modes(unknowns)
    regions = CellRegions(unknowns.mesh)
    nodes = regions.cell_nodes
    count, part = regions.find(np.ones(len(nodes), dtype=bool))
    if count == 1:
        return modes
    of_node = np.full(len(unknowns.mesh.parent_vertices), -1)
    of_node[nodes] = part[:, None]
    owned = of_node[: len(_points(unknowns))]
    single = modes.reshape(len(modes), len(owned), unknowns.block_size)
    parts = [np.where((owned == p)[:, None], single, 0.0) for p in range(count)]
    return np.asarray(np.concatenate(parts).reshape(count * len(modes), -1))


def near_null_modes(unknowns: BodyUnknowns, box: Box | None = None) -> FloatArray:
    """Return the near-null space of a body as owned unknowns, shape (modes, owned unknowns).

    These are the rigid motions, in an axisymmetric body the radial translation, and the constant
    pressure where it is an unknown.

    Args:
        unknowns: of the body.
        box: of the rotations, see `rigid_modes`.
    """
    modes = [*rigid_modes(unknowns, box)]
    owned = unknowns.space.dofmap.index_map.size_local
    extra = [0] if unknowns.model == "axisymmetric" else []
    if unknowns.pressure_component is not None:
        extra.append(unknowns.pressure_component)
    for component in extra:
        mode = np.zeros((owned, unknowns.block_size))
        mode[:, component] = 1.0
        modes.append(mode.ravel())
    return np.array(modes)


def _points(unknowns: BodyUnknowns) -> FloatArray:
    """Return the owned nodes of a body, shape (owned, dimension) [m]."""
    owned = unknowns.space.dofmap.index_map.size_local
    places = unknowns.mesh.nodes.tabulate_dof_coordinates()
    return np.asarray(places[:owned, : unknowns.dimension])


def rigid_motions(points: FloatArray, model: str, box: Box) -> list[FloatArray]:
    """Return the rigid motions at points, each of shape (points, dimension).

    Args:
        points: shape (points, dimension) [m].
        model: geometric model; axisymmetric bodies have only the axial translation.
        box: of the rotations, see `rigid_modes`.
    """
    if model == "axisymmetric":
        return [np.tile([0.0, 1.0], (len(points), 1))]
    moves = [np.tile(e, (len(points), 1)) for e in np.eye(points.shape[1])]
    return [*moves, *_rotations(points, box)]


def _rotations(points: FloatArray, box: Box) -> list[FloatArray]:
    low, high = box
    arms = (points - (low + high) / 2) / (np.linalg.norm(high - low) / 2)
    if points.shape[1] == 2:
        return [np.stack((-arms[:, 1], arms[:, 0]), axis=1)]
    return [np.cross(axis, arms) for axis in np.eye(3)]
