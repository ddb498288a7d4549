"""Rigid motions of all bodies in the unknowns of the contact, for springs on those that float."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.transform import ConstraintTransform
from castx.contact.system import ContactSystem
from castx.domain.measures import nodal_volumes
from castx.equilibrium.supports.falling import BodiesTogether
from castx.equilibrium.supports.springs import FloatingMotions
from castx.mechanics.body import BodyMechanics
from castx.mechanics.rigid_modes import extent, modes_of_parts, rigid_modes
from castx.solvers.layout import Layout


def floating_motions(
    parts: Sequence[BodyMechanics],
    transform: ConstraintTransform,
    contact: ContactSystem,
    gaps: Gaps,
    stiffness: float,
    joined: Sequence[Sequence[int]],
) -> FloatingMotions:
    """Return the rigid motions of all bodies, to find those that nothing holds; collective.

    Args:
        parts: the bodies in the order of the layout.
        transform: change of unknowns of all bodies.
        contact: the contact method.
        gaps: the pairs of all interfaces.
        stiffness: of the springs per volume [Pa/m²].
        joined: numbers of bodies that contact joins, by groups.
    """
    layout = transform.layout
    volumes = [np.repeat(nodal_volumes(b.mesh, b.model), b.block_size) for b in parts]
    modes = [modes_of_parts(body.unknowns) for body in parts]
    motions, weights, held, changes = [], [], [], []
    for b, own in enumerate(modes):
        for mode in own:
            nodal = _extended(layout, b, mode)
            motions.append(transform.unknowns(nodal))
            weights.append(transform.forces_on_unknowns(_extended(layout, b, volumes[b] * mode)))
            held.append(_strained(parts, b, mode))
            changes.append(gaps.changes(nodal)[gaps.free])
    ways = np.concatenate(layout.comm.allgather(np.array(changes).T))
    return FloatingMotions(
        contact.unknowns.extended(np.array(motions)),
        contact.unknowns.extended(np.array(weights)),
        stiffness,
        layout.comm,
        np.array(held),
        [_joined(layout.comm, parts, modes, volumes, group, ways) for group in joined],
    )


def _joined(
    comm: MPI.Intracomm,
    parts: Sequence[BodyMechanics],
    modes: Sequence[FloatArray],
    volumes: Sequence[FloatArray],
    group: Sequence[int],
    ways: FloatArray,
) -> BodiesTogether:
    """Return the bodies of a group with the motions of all of them as one.

    Args:
        comm: of all bodies.
        parts: the bodies in the order of the layout.
        modes: rigid motions of each of them.
        volumes: of their unknowns [m³].
        group: numbers of bodies.
        ways: change of all gaps in each motion, shape (pairs, motions).
    """
    box = extent([parts[b].unknowns for b in group])
    ends = np.cumsum([0, *(len(own) for own in modes)])
    number: IntArray = np.full(ends[-1], -1, dtype=np.int32)
    common: FloatArray = np.zeros((len(rigid_modes(parts[group[0]].unknowns)), ends[-1]))
    weight: FloatArray = np.zeros((len(group), len(common)))
    volume: FloatArray = np.zeros(len(group))
    for k, b in enumerate(group):
        body, own, here = parts[b], modes[b], slice(ends[b], ends[b + 1])
        motion = rigid_modes(body.unknowns, box)
        force = np.zeros((body.owned_nodes, body.block_size))
        force[:, : body.dimension] = body.loads.uniform_force
        sums = comm.allreduce(np.hstack([
            (volumes[b] * own) @ own.T, (volumes[b] * own) @ motion.T
        ]), op=MPI.SUM)  # fmt: skip
        common[:, here] = np.linalg.solve(sums[:, : len(own)], sums[:, len(own) :]).T
        number[here] = k
        weight[k] = motion @ (volumes[b] * force.ravel())
        volume[k] = volumes[b].sum() / body.block_size
    weight, volume = comm.allreduce(weight, op=MPI.SUM), comm.allreduce(volume, op=MPI.SUM)
    density = np.array([np.linalg.norm(parts[b].loads.uniform_force) for b in group])
    return BodiesTogether(number, common, weight, volume, density, ways)


def _strained(parts: Sequence[BodyMechanics], b: int, mode: FloatArray) -> FloatArray:
    """Return the elongation of the springs of all surfaces under a motion of one body."""
    motions: list[FloatArray] = [np.zeros((p.owned_nodes, p.dimension)) for p in parts]
    motions[b] = mode.reshape(-1, parts[b].block_size)[:, : parts[b].dimension]
    found = [part.loads.held(motion) for part, motion in zip(parts, motions, strict=True)]
    return np.concatenate(found)


def _extended(layout: Layout, b: int, values: FloatArray) -> FloatArray:
    """Return owned values of one body with zeros for the others."""
    found = np.zeros(layout.size_local)
    found[layout.local_slice(b)] = values
    return found
