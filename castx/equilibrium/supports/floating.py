"""Rigid motions of all bodies in the unknowns of the contact, for springs on those that float."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
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
    stiffness: float,
    together: Sequence[Sequence[int]],
) -> FloatingMotions:
    """Return the rigid motions of all bodies, to find those that nothing holds; collective.

    Args:
        parts: the bodies in the order of the layout.
        transform: change of unknowns of all bodies.
        contact: the contact method.
        stiffness: of the springs per volume [Pa/m²].
        together: numbers of bodies that touch each other and no rigid one, by groups.
    """
    layout = transform.layout
    volumes = [np.repeat(nodal_volumes(b.mesh, b.model), b.block_size) for b in parts]
    modes = [modes_of_parts(body.unknowns) for body in parts]
    motions, weights, held = [], [], []
    for b, own in enumerate(modes):
        for mode in own:
            motions.append(transform.unknowns(_extended(layout, b, mode)))
            weights.append(transform.forces_on_unknowns(_extended(layout, b, volumes[b] * mode)))
            held.append(_strained(parts, b, mode))
    return FloatingMotions(
        contact.unknowns.extended(np.array(motions)),
        contact.unknowns.extended(np.array(weights)),
        stiffness,
        layout.comm,
        np.array(held),
        [
            _joined(layout.comm, parts, modes, volumes, group)
            for group in together
            if all(parts[b].loads.weighs for b in group)
        ],
    )


def _joined(
    comm: MPI.Intracomm,
    parts: Sequence[BodyMechanics],
    modes: Sequence[FloatArray],
    volumes: Sequence[FloatArray],
    group: Sequence[int],
) -> BodiesTogether:
    """Return the bodies of a group with the motions of all of them as one."""
    box = extent([parts[b].unknowns for b in group])
    ends = np.cumsum([0, *(len(own) for own in modes)])
    joint: FloatArray | None = None
    weight: FloatArray | float = 0.0
    density, total, heavy = np.ones(ends[-1]), 0.0, 0.0
    for b in group:
        body, own = parts[b], modes[b]
        motion = rigid_modes(body.unknowns, box)
        joint = np.zeros((len(motion), ends[-1])) if joint is None else joint
        force = np.zeros((body.owned_nodes, body.block_size))
        force[:, : body.dimension] = body.loads.uniform_force
        sums = comm.allreduce(np.hstack([
            (volumes[b] * own) @ own.T, (volumes[b] * own) @ motion.T
        ]), op=MPI.SUM)  # fmt: skip
        joint[:, ends[b] : ends[b + 1]] = np.linalg.solve(
            sums[:, : len(own)], sums[:, len(own) :]
        ).T
        weight = weight + motion @ (volumes[b] * force.ravel())
        volume = comm.allreduce(float(volumes[b].sum()), op=MPI.SUM)
        density[ends[b] : ends[b + 1]] = np.linalg.norm(body.loads.uniform_force)
        total, heavy = total + volume, heavy + volume * density[ends[b]]
    for b in group:
        density[ends[b] : ends[b + 1]] *= total / heavy
    assert joint is not None
    return BodiesTogether(joint, comm.allreduce(weight, op=MPI.SUM), density)


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
