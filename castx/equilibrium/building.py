"""Puts together an equilibrium: coordinates, gaps, contact method, supports and linear solvers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.building import contact_system
from castx.contact.choice import Contact, common_method, fallbacks
from castx.contact.kinematics.coordinates import Coordinates
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.rigid import RigidBody
from castx.contact.kinematics.rows import InterfaceRows
from castx.contact.method import ContactSystem
from castx.contact.methods.registry import METHODS
from castx.contact.multipliers import MultiplierContact
from castx.domain.measures import nodal_volumes
from castx.domain.pairs.node_pairs import NodePairs
from castx.equilibrium.block_iterative import BlockIteration, arrow_blocks
from castx.equilibrium.equilibrium import Equilibrium, Procedure
from castx.equilibrium.fallback import MethodsInTurn
from castx.equilibrium.forces import Balance
from castx.equilibrium.linear_system import InnerSolver
from castx.equilibrium.newton import PREFIX, Newton
from castx.equilibrium.supports.in_gates import InGate
from castx.equilibrium.supports.springs import FIRM, WEAK, FloatingMotions
from castx.mechanics.assembly import BodyAssembly
from castx.mechanics.body import BodyMechanics
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.rigid_modes import near_null_modes, rigid_modes
from castx.solvers.arrow_schur import ArrowSchur
from castx.solvers.blocks import (
    FACTORS,
    MOST_CHANGED,
    MULTIGRID,
    Block,
    BlockSolver,
    BlockSweep,
    DirectSolver,
    solves_directly,
)
from castx.solvers.counters import StepCounters
from castx.solvers.layout import Layout

LARGEST_DIRECT = {2: 200_000, 3: 12_000}
"""Unknowns up to which "automatic" solves directly, by dimension."""


@dataclass(frozen=True)
class MechanicsSettings:
    """How the equilibrium is solved.

    Attributes:
        linear: "direct", "iterative" or "automatic" (by size).
        tolerance: residual relative to the largest internal, contact or external force.
        support: whether motions that nothing holds get springs.
        options: PETSc options under `castx_mechanics_`.
        in_gate: surfaces that hold a body while it has lost all contact, by name of the body.
    """

    linear: str = "automatic"
    tolerance: float = 1e-3
    support: bool = True
    options: Mapping[str, Any] = field(default_factory=dict)
    in_gate: Mapping[str, Sequence[str]] = field(default_factory=dict)


@dataclass(frozen=True)
class Assembled:
    """The deformable bodies, before anything is said about their contact.

    Attributes:
        names: of the bodies.
        assembly: their residual and matrix.
        fixed: fixed directions of each of them.
        rigid: rigid bodies by name.
        length: size of the whole [m].
        stiffness: G/L of the stiffest body [Pa/m].
        counters: of the step, to which the solution adds.
    """

    names: Sequence[str]
    assembly: BodyAssembly
    fixed: Sequence[Sequence[FixedDirections]]
    rigid: Mapping[str, RigidBody]
    length: float
    stiffness: float
    counters: StepCounters

    @property
    def layout(self) -> Layout:
        """Numbering of their unknowns."""
        return self.assembly.layout

    @property
    def bodies(self) -> Sequence[BodyMechanics]:
        """The bodies in the order of the layout."""
        return self.assembly.bodies


def build_methods(
    made: Assembled,
    contacts: Sequence[Contact],
    pairs: Sequence[NodePairs],
    settings: MechanicsSettings,
) -> Equilibrium | MethodsInTurn:
    """Return the equilibrium of bodies with contact, by several methods if there are fallbacks.

    Args:
        made: the bodies.
        contacts: interfaces with contact.
        pairs: their node pairs.
        settings: how to solve.

    Raises:
        CaseError: contact methods that cannot be combined.
    """
    first = _build_equilibrium(made, contacts, pairs, settings)
    others = [
        (name, partial(_build_equilibrium, made, found, pairs, settings))
        for name, found in fallbacks(contacts)
    ]
    return MethodsInTurn(first, others) if others else first


def _build_equilibrium(
    made: Assembled,
    contacts: Sequence[Contact],
    pairs: Sequence[NodePairs],
    settings: MechanicsSettings,
) -> Equilibrium:
    method = common_method(contacts)
    rows = [InterfaceRows(p, c.treatment) for c, p in zip(contacts, pairs, strict=True)]
    coordinates = Coordinates(
        made.layout, made.names, made.bodies[0].dimension, made.fixed, rows,
        [body.axial for body in made.bodies],
    )  # fmt: skip
    initial = [p.gap + c.initial_gap(p.points) for c, p in zip(contacts, pairs, strict=True)]
    gaps = Gaps(made.layout, made.names, coordinates.interfaces, initial, made.rigid)
    contact = contact_system(method, contacts, coordinates, made.names, gaps, made.stiffness)
    springs = (WEAK if contacts else FIRM) * made.stiffness / made.length
    floating = _floating(made, coordinates, contact, springs) if settings.support else None
    gates = [
        InGate(coordinates, gaps, b, body, settings.in_gate[body.name])
        for b, body in enumerate(made.bodies)
        if body.name in settings.in_gate
    ]
    balance = Balance(
        made.assembly, coordinates, gaps, contact, floating, gates, settings.tolerance
    )
    return Equilibrium(balance, _procedure(made, contacts, coordinates, balance, settings))


def _procedure(
    made: Assembled,
    contacts: Sequence[Contact],
    coordinates: Coordinates,
    balance: Balance,
    settings: MechanicsSettings,
) -> Procedure:
    prefix, comm, contact = f"{PREFIX}bodies_", made.layout.comm, balance.contact
    largest = LARGEST_DIRECT[made.bodies[0].mesh.mesh.topology.dim]
    direct = solves_directly(settings.linear, made.layout.size_global, largest)
    chosen = next((c for c in contacts if METHODS[c.method].by_blocks), None)
    inner: InnerSolver
    if chosen is not None:
        bodies = _body_blocks(made, coordinates, FACTORS if direct else MULTIGRID)
        blocks = bodies
        if chosen.setting("blocks") == "interface":
            blocks = arrow_blocks(bodies, coordinates)
        if chosen.setting("block_solver") == "iteration":
            solvers = [
                (_mask(made.layout, block), BlockSolver(comm, f"{prefix}{b}_", block))
                for b, block in enumerate(blocks)
            ]
            newton = Newton(balance, solvers, settings.options, made.counters)
            return BlockIteration(newton, len(blocks), int(chosen.setting("block_iterations")))
        inner = BlockSweep(comm, prefix, blocks)
    elif direct:
        multipliers = isinstance(contact, MultiplierContact)
        inner = DirectSolver(comm, prefix, 0 if multipliers else MOST_CHANGED)
    else:
        blocks = _body_blocks(made, coordinates, MULTIGRID)
        if isinstance(contact, MultiplierContact):
            inner = ArrowSchur(comm, prefix, blocks, contact.schur_weights())
        else:
            inner = BlockSweep(comm, prefix, blocks)
    return Newton(balance, [(None, inner)], settings.options, made.counters)


def _mask(layout: Layout, block: Block) -> BoolArray:
    mask = np.zeros(layout.size_local, dtype=bool)
    mask[block.rows.getIndices() - layout.first] = True
    return mask


def _body_blocks(
    made: Assembled, coordinates: Coordinates, options: Mapping[str, object]
) -> list[Block]:
    """Return a block for each body, with the options of its solver."""
    forward, blocks = coordinates.to_coordinates.mult, []
    for b, (rows, body) in enumerate(zip(made.layout.index_sets(), made.bodies, strict=True)):
        own = made.layout.local_slice(b)
        near_null = near_null_modes(body.unknowns)
        modes = [_image(made.layout, forward, b, mode)[own] for mode in near_null]
        blocks.append(Block(rows, np.array(modes), options))
    return blocks


def _floating(
    made: Assembled, coordinates: Coordinates, contact: ContactSystem, stiffness: float
) -> FloatingMotions:
    motions, weights = [], []
    for b, body in enumerate(made.bodies):
        volumes = np.repeat(nodal_volumes(body.mesh, body.model), body.block_size)
        for mode in rigid_modes(body.unknowns):
            motions.append(_image(made.layout, coordinates.to_coordinates.mult, b, mode))
            transpose = coordinates.to_displacements.multTranspose
            weights.append(_image(made.layout, transpose, b, volumes * mode))
    return FloatingMotions(
        contact.to_unknowns(np.array(motions)),
        contact.to_unknowns(np.array(weights)),
        stiffness,
        made.layout.comm,
    )


def _image(
    layout: Layout, product: Callable[[PETSc.Vec, PETSc.Vec], None], b: int, values: FloatArray
) -> FloatArray:
    x, y = layout.create_vector(), layout.create_vector()
    x.array[layout.local_slice(b)] = values
    product(x, y)
    image = y.array_r.copy()
    x.destroy()
    y.destroy()
    return np.asarray(image)
