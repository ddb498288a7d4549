"""Builds an equilibrium: change of unknowns, gaps, contact method, supports, linear solvers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from castx.arrays import BoolArray
from castx.case.contact import is_tied
from castx.contact.building import contact_system
from castx.contact.choice import Contact, common_method, fallbacks
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.midside_shares import QuadraticPairs, name_of_midsides
from castx.contact.kinematics.rigid import RigidBody
from castx.contact.kinematics.rows import InterfaceRows, Treatment
from castx.contact.kinematics.transform import ConstraintTransform
from castx.contact.methods.registry import METHODS
from castx.contact.multipliers import MultiplierContact
from castx.equilibrium.block_iterative import BlockIteration, arrow_blocks
from castx.equilibrium.body_blocks import body_blocks, moving_together
from castx.equilibrium.equilibrium import Equilibrium, Procedure
from castx.equilibrium.fallback import FallbackMethods
from castx.equilibrium.forces import MomentumBalance
from castx.equilibrium.linear_system import InnerSolver
from castx.equilibrium.newton import PREFIX, Newton
from castx.equilibrium.supports.acting import Supports
from castx.equilibrium.supports.floating import floating_motions
from castx.equilibrium.supports.in_gates import InGate
from castx.equilibrium.supports.springs import FIRM, WEAK
from castx.mechanics.assembly import BodyAssembly
from castx.mechanics.body import BodyMechanics
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.q1p0 import Q1P0Formulation
from castx.mechanics.taylor_hood import TaylorHoodFormulation
from castx.solvers.counters import StepCounters
from castx.solvers.inner.arrow_schur import ArrowSchur
from castx.solvers.inner.block_solver import BlockSolver
from castx.solvers.inner.direct import MOST_CHANGED, DirectSolver
from castx.solvers.inner.midside_schur import MidsideSchur
from castx.solvers.inner.nest import Block
from castx.solvers.inner.options import FACTORS, MULTIGRID, solves_directly
from castx.solvers.inner.sweep import BlockSweep
from castx.solvers.inner.whole_matrix import Lacking
from castx.solvers.layout import Layout

BLOCKS_PREFIX, FACTORS_PREFIX = f"{PREFIX}bodies_", f"{PREFIX}factors_"
WHOLE_PREFIX = f"{PREFIX}whole_"
LARGEST_DIRECT = {2: 200_000, 3: 4_000}
"""Unknowns up to which "automatic" solves directly, by dimension."""
LARGEST_DIRECT_Q1P0 = 12_000
"""The same in space with Q1/P0: a pocket of liquid costs multigrid hundreds of iterations."""
LARGEST_DIRECT_GRAINS = 15_000
"""The same in space with a body of grains: beyond that factors of each body cost less than those of
all, a fifth at 22,000 unknowns. Multigrid of sand that yields ends at its most iterations."""
LARGEST_DIRECT_QUADRATIC = 20_000
"""The same in space with quadratic displacements of bodies that never melt: of an elastic beam of
44,500 unknowns factors cost 2.4 times as much as two levels and multigrid."""
LARGEST_FLOWING = 200_000
"""Unknowns of a body that flows, yields as grains or may be liquid up to which it gets factors
beside the multigrid of the others, once multigrid is slow: shells that freeze and yield cost it
iterations by the hundred. With quadratic bodies, those of all up to which "automatic" solves
directly where one of them yields as grains or may be liquid."""


@dataclass(frozen=True)
class MechanicsSettings:
    """Settings of the solution of the equilibrium.

    Attributes:
        linear: "direct", "iterative" or "automatic" (by size).
        tolerance: residual relative to the net forces on a body.
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
class DeformableBodies:
    """The deformable bodies, before anything is said about their contact.

    Attributes:
        names: of the bodies.
        assembly: their residual and matrix.
        fixed: fixed directions of each of them, then of the mid-sides of those that have any.
        rigid: rigid bodies by name.
        length: size of the whole [m].
        moduli: G/L of the bodies, G the largest of each and L the size of the whole [Pa/m].
        counters: of the step, to which the solution adds.
    """

    names: Sequence[str]
    assembly: BodyAssembly
    fixed: Sequence[Sequence[FixedDirections]]
    rigid: Mapping[str, RigidBody]
    length: float
    moduli: Sequence[float]
    counters: StepCounters

    @property
    def stiffness(self) -> float:
        """G/L of the stiffest body [Pa/m]."""
        return max(self.moduli)

    @property
    def layout(self) -> Layout:
        """Numbering of their unknowns."""
        return self.assembly.layout

    @property
    def layout_names(self) -> list[str]:
        """Names of the bodies and of their mid-sides in the order of the layout."""
        midsides = [name_of_midsides(self.names[b]) for b in self.assembly.quadratic]
        return [*self.names, *midsides]

    @property
    def parts(self) -> Sequence[BodyMechanics]:
        """The bodies in the order of the layout."""
        return self.assembly.bodies


def build_methods(
    bodies: DeformableBodies,
    contacts: Sequence[Contact],
    pairs: Sequence[QuadraticPairs],
    settings: MechanicsSettings,
) -> Equilibrium | FallbackMethods:
    """Return the equilibrium of bodies with contact, by several methods if there are fallbacks.

    Args:
        bodies: the bodies.
        contacts: interfaces with contact.
        pairs: their node pairs, and what mid-sides have in them.
        settings: how to solve.

    Raises:
        CaseError: contact methods that cannot be combined.
    """
    first = _build_equilibrium(bodies, contacts, pairs, settings)
    others = [
        (name, partial(_build_equilibrium, bodies, found, pairs, settings))
        for name, found in fallbacks(contacts)
    ]
    return FallbackMethods(first, others) if others else first


def _build_equilibrium(
    bodies: DeformableBodies,
    contacts: Sequence[Contact],
    pairs: Sequence[QuadraticPairs],
    settings: MechanicsSettings,
) -> Equilibrium:
    method = common_method(contacts)
    rows = [
        InterfaceRows(found.nodes, contact.treatment, found.shares, found.facets)
        for contact, found in zip(contacts, pairs, strict=True)
    ]
    tied = [InterfaceRows(each, Treatment.TIED) for found in pairs for each in found.tied]
    transform = ConstraintTransform(
        bodies.layout, bodies.layout_names, bodies.parts[0].dimension, bodies.fixed,
        [*rows, *tied], [body.axial for body in bodies.parts],
    )  # fmt: skip
    touching = transform.interfaces[: len(rows)]
    gaps = Gaps(bodies.layout, bodies.layout_names, touching, bodies.rigid)
    contact = contact_system(method, contacts, transform, bodies.layout_names, gaps, bodies.moduli)
    springs = (WEAK if contacts else FIRM) * bodies.stiffness / bodies.length
    floating = None
    if settings.support:
        joined = _joined_by_contact(bodies, contacts)
        floating = floating_motions(bodies.parts, transform, contact, gaps, springs, joined)
    gates = [
        InGate(transform, gaps, b, body, settings.in_gate[body.name])
        for b, body in enumerate(bodies.parts)
        if body.name in settings.in_gate
    ]
    supports = Supports(transform, bodies.parts, floating, gates, contact.layout.size_local)
    balance = MomentumBalance(
        bodies.assembly, transform, gaps, contact, supports, settings.tolerance
    )
    return Equilibrium(balance, _procedure(bodies, contacts, balance, settings))


def largest_direct(bodies: DeformableBodies) -> int:
    """Return the number of unknowns up to which "automatic" solves directly."""
    dimension = bodies.parts[0].mesh.mesh.topology.dim
    grains = any(part.material.law.is_granular for part in bodies.parts)
    quadratic = any(isinstance(part.formulation, TaylorHoodFormulation) for part in bodies.parts)
    if dimension == 3 and quadratic:
        melts = not all(part.is_compressible for part in bodies.parts)
        return LARGEST_FLOWING if melts or grains else LARGEST_DIRECT_QUADRATIC
    if dimension == 3 and grains:
        return LARGEST_DIRECT_GRAINS
    q1p0 = any(isinstance(part.formulation, Q1P0Formulation) for part in bodies.parts)
    return LARGEST_DIRECT_Q1P0 if q1p0 and dimension == 3 else LARGEST_DIRECT[dimension]


def _procedure(
    bodies: DeformableBodies,
    contacts: Sequence[Contact],
    balance: MomentumBalance,
    settings: MechanicsSettings,
) -> Procedure:
    direct = solves_directly(settings.linear, bodies.layout.size_global, largest_direct(bodies))
    flat = bodies.parts[0].mesh.mesh.topology.dim == 2
    if bodies.assembly.quadratic and (
        flat or isinstance(balance.contact.normal, MultiplierContact)
    ):
        direct = True
    chosen = next((c for c in contacts if METHODS[c.method].by_blocks), None)
    if chosen is not None:
        return _by_blocks(bodies, chosen, balance, direct, settings.options)
    inner = _inner_solvers(bodies, contacts, balance, direct, settings.linear == "automatic")
    return Newton(balance, [(None, inner)], settings.options, bodies.counters)


def _inner_solvers(
    bodies: DeformableBodies,
    contacts: Sequence[Contact],
    balance: MomentumBalance,
    direct: bool,
    by_body: bool,
) -> list[InnerSolver]:
    """Return the solvers of all bodies: factors, or multigrid.

    With `by_body` follow, for where multigrid is slow, factors for the bodies that flow, yield as
    grains or may be liquid; with mid-sides those of all bodies. Where each body has its own, those
    of all together follow: a shell that is stiffer than its mould, and hangs at few pairs, takes a
    sweep from one body to the other iterations by the hundred.
    """
    comm, pairs = bodies.layout.comm, balance.contact.normal
    multipliers = isinstance(pairs, MultiplierContact)
    if direct:
        lacking = _lacking(bodies, balance, range(len(bodies.parts)))
        most = 0 if multipliers else MOST_CHANGED
        return [DirectSolver(comm, BLOCKS_PREFIX, most, lacking)]
    groups = _tied_together(bodies, contacts)
    blocks = body_blocks(
        bodies.layout, bodies.parts, groups, balance.transform, [MULTIGRID] * len(groups)
    )
    if bodies.assembly.quadratic:
        return _with_midsides(bodies, blocks, by_body)
    if isinstance(pairs, MultiplierContact):
        return [ArrowSchur(comm, BLOCKS_PREFIX, blocks, pairs.schur_weights())]
    # Where preconditioners are often renewed, the coupling costs more than it saves iterations.
    coupling = balance.transform.coupling if bodies.assembly.is_elastic else None
    solvers: list[InnerSolver] = [BlockSweep(comm, BLOCKS_PREFIX, blocks, coupling)]
    may = [by_body and _may_have_factors(bodies, group) for group in groups]
    if any(may):
        with_factors = [
            block._replace(options=FACTORS) if factors else block
            for block, factors in zip(blocks, may, strict=True)
        ]
        exact = [b for group, factors in zip(groups, may, strict=True) if factors for b in group]
        lacking = _lacking(bodies, balance, exact)
        solvers.append(BlockSweep(comm, FACTORS_PREFIX, with_factors, coupling, lacking))
    if all(may) and len(groups) > 1 and bodies.layout.size_global <= LARGEST_FLOWING:
        whole = _lacking(bodies, balance, range(len(bodies.parts)))
        solvers.append(DirectSolver(comm, WHOLE_PREFIX, MOST_CHANGED, whole))
    return solvers


def _lacking(bodies: DeformableBodies, balance: MomentumBalance, exact: Sequence[int]) -> Lacking:
    """Return the matrix of corrections of bodies that get factors, as a function of no argument.

    Args:
        bodies: all of them.
        balance: of them, with the layout of the matrix.
        exact: numbers of those that get factors.
    """
    return partial(bodies.assembly.corrections_matrix, balance.contact.layout, exact)


def _with_midsides(
    bodies: DeformableBodies, blocks: Sequence[Block], with_factors: bool
) -> list[InnerSolver]:
    """Return the solvers of bodies with mid-sides: two levels, then factors if they are slow."""
    layout = bodies.layout
    of_nodes = layout.local_slice(len(bodies.parts) - 1).stop
    pressures = bodies.assembly.displacement_rows()[:of_nodes] == 0.0
    levels = MidsideSchur(layout.comm, BLOCKS_PREFIX, blocks, pressures, layout.first)
    return [levels, DirectSolver(layout.comm, FACTORS_PREFIX)] if with_factors else [levels]


def _by_blocks(
    bodies: DeformableBodies,
    chosen: Contact,
    balance: MomentumBalance,
    direct: bool,
    options: Mapping[str, Any],
) -> Procedure:
    """Return the iteration over blocks, or Newton's method with one sweep as preconditioner."""
    comm = bodies.layout.comm
    groups, solver_options = _alone(bodies), FACTORS if direct else MULTIGRID
    bodies_in_turn = blocks = body_blocks(
        bodies.layout, bodies.parts, groups, balance.transform, [solver_options] * len(groups)
    )
    if chosen.setting("blocks") == "interface":
        blocks = arrow_blocks(blocks, balance.transform)

    def preconditioned(swept: Sequence[Block]) -> Newton:
        sweep = BlockSweep(comm, BLOCKS_PREFIX, swept)
        return Newton(balance, [(None, [sweep])], options, bodies.counters)

    if chosen.setting("block_solver") == "preconditioner":
        return preconditioned(blocks)
    solvers = [
        (_mask(bodies.layout, block), [BlockSolver(comm, f"{BLOCKS_PREFIX}{b}_", block)])
        for b, block in enumerate(blocks)
    ]
    most = int(chosen.setting("block_iterations"))
    newton = Newton(balance, solvers, options, bodies.counters)
    return BlockIteration(newton, len(blocks), most, partial(preconditioned, bodies_in_turn))


def _mask(layout: Layout, block: Block) -> BoolArray:
    mask = np.zeros(layout.size_local, dtype=bool)
    mask[block.rows.getIndices() - layout.first] = True
    return mask


def _alone(bodies: DeformableBodies) -> list[list[int]]:
    """Return the bodies as groups of one."""
    return [[b] for b in range(len(bodies.parts))]


def _may_have_factors(bodies: DeformableBodies, group: Sequence[int]) -> bool:
    """Return whether a body of a group flows, yields as grains or may be liquid, and is small."""
    parts = [bodies.parts[b] for b in group]
    unknowns = bodies.layout.comm.allreduce(sum(part.unknowns.owned for part in parts))
    flows = any(
        p.material.law.flows_by_rate or p.material.law.is_granular or not p.is_compressible
        for p in parts
    )
    return unknowns <= LARGEST_FLOWING and flows


def _tied_together(bodies: DeformableBodies, contacts: Sequence[Contact]) -> list[list[int]]:
    """Return groups of bodies of one kind of unknowns that are tied, or may stick by friction."""
    sizes = bodies.layout.block_sizes[: len(bodies.parts)]
    ties = _joints(bodies, [c for c in contacts if is_tied(c.method) or c.friction > 0.0])
    return moving_together(len(sizes), [(a, b) for a, b in ties if sizes[a] == sizes[b]])


def _joined_by_contact(bodies: DeformableBodies, contacts: Sequence[Contact]) -> list[list[int]]:
    """Return groups of bodies that are joined by contact; without any contact there are none."""
    return moving_together(len(bodies.names), _joints(bodies, contacts)) if contacts else []


def _joints(bodies: DeformableBodies, contacts: Sequence[Contact]) -> list[tuple[int, int]]:
    """Return the numbers of the bodies of contacts without rigid ones."""
    number = {name: b for b, name in enumerate(bodies.names)}
    return [
        (number[c.secondary], number[c.primary])
        for c in contacts
        if {c.secondary, c.primary} <= number.keys()
    ]
