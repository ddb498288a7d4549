"""Builds the equilibrium of all bodies from descriptions of bodies, supports and contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import replace

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.contact import is_tied
from castx.contact.choice import Contact, check_bodies
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.midside_shares import QuadraticPairs, quadratic_pairs
from castx.contact.kinematics.pair_state import contact_state
from castx.contact.kinematics.rigid import rigid_body
from castx.domain.measures import extent
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.facet_pairs import facet_pairs
from castx.domain.pairs.node_pairs import NodePairs
from castx.domain.pairs.pairing import Facing, pairs_of
from castx.equilibrium.building import DeformableBodies, MechanicsSettings, build_methods
from castx.equilibrium.memory import MechanicalMemory
from castx.mechanics.assembly import BodyAssembly
from castx.mechanics.body import BodyMechanics
from castx.mechanics.description import MechanicalBody
from castx.mechanics.fixed_directions import (
    SurfaceDisplacement,
    fixed_directions,
    hinders_shrinkage,
)
from castx.mechanics.fixed_midsides import midside_directions
from castx.mechanics.midsides.midsides import Midsides
from castx.profiling import RunPart, booked_as
from castx.solvers.counters import StepCounters
from castx.solvers.layout import Layout
from castx.transfer.pair_state import PairState


class MechanicalProblem:
    """The bodies, their contact and the solver of their equilibrium.

    Attributes:
        hindered: whether the supports of a body keep it from shrinking evenly, by its name.

    Args:
        mesh: mesh of all bodies.
        bodies: mechanical description by name of the body; others are rigid.
        displacements: displacement conditions by name of the body.
        contacts: interfaces with contact.
        settings: how to solve.
        counters: of the step, to which the solution adds.
        pairs: node pairs of each contact; None: those that the contacts describe.

    Raises:
        CaseError: contact methods that cannot be combined.
    """

    def __init__(
        self,
        mesh: CastingMesh,
        bodies: Mapping[str, MechanicalBody],
        displacements: Mapping[str, Sequence[SurfaceDisplacement]],
        contacts: Sequence[Contact],
        settings: MechanicsSettings,
        counters: StepCounters | None = None,
        pairs: Sequence[NodePairs] | None = None,
    ) -> None:
        check_bodies(contacts, bodies)
        names = list(bodies)
        bodies = {
            n: replace(body, closed=_closed_surfaces(mesh, n, contacts, displacements.get(n, ())))
            for n, body in bodies.items()
        }
        fixed = [
            fixed_directions(mesh.bodies[n], mesh.model, displacements.get(n, ())) for n in names
        ]
        self.hindered = {
            n: hinders_shrinkage(mesh.bodies[n], mesh.model, own)
            for n, own in zip(names, fixed, strict=True)
        }
        planes = [[condition for condition in f if condition.symmetry] for f in fixed]
        parts = [
            BodyMechanics(mesh.bodies[n], mesh.model, bodies[n], planes[b])
            for b, n in enumerate(names)
        ]
        self.bodies = dict(zip(names, parts, strict=True))
        midsides = {p.name: p.midsides for p in parts if p.midsides is not None}
        blocks: list[BodyMechanics | Midsides] = [*parts, *midsides.values()]
        spaces, sizes = [each.space for each in blocks], [each.block_size for each in blocks]
        self.layout = Layout(mesh.comm, [space.dofmap.index_map for space in spaces], sizes)
        if pairs is None:
            described = [Facing(c.secondary, c.primary, c.pairing, c.initial_gap) for c in contacts]
            pairs = pairs_of(mesh, described)
        self.pairs = list(pairs)
        self.rigid = {
            n: rigid_body(n, mesh.model, displacements.get(n, ()))
            for n in mesh.bodies
            if n not in bodies
        }
        length = extent(mesh.parent)
        moduli = [bodies[n].law.largest_shear_modulus() / length for n in names]
        self._assembly = BodyAssembly(self.layout, parts)
        straight = [
            midside_directions(body.mesh, body.midsides, fixed[b])
            for b, body in enumerate(parts)
            if body.midsides is not None
        ]
        deformable = DeformableBodies(
            names, self._assembly, [*fixed, *straight], self.rigid, length, moduli,
            counters or StepCounters(),
        )  # fmt: skip
        liquid = {part.name for part in parts if not part.is_compressible}
        found = [
            _interface_pairs(mesh, own, contact, midsides, liquid)
            for own, contact in zip(self.pairs, contacts, strict=True)
        ]
        self.equilibrium = build_methods(deformable, contacts, found, settings)
        self.memory = MechanicalMemory(self.bodies, self.equilibrium.first)

    @property
    def gaps(self) -> Gaps:
        """The pairs of all interfaces."""
        return self.equilibrium.present.gaps

    def skin_growth(self) -> float:
        """Return the growth of the fastest skin in the trial step; collective."""
        present = self.equilibrium.present
        return present.balance.skin.growth(present.active.committed)

    def pair_values(self) -> tuple[FloatArray, FloatArray]:
        """Return gaps [m] and contact forces [N] of all rows of this rank, no force where open."""
        present = self.equilibrium.present
        return present.balance.pair_values(present.x)

    @booked_as(RunPart.CONTACT)
    def contact_states(self) -> list[PairState]:
        """Return the contact states of the pairs of each interface; collective."""
        present = self.equilibrium.present
        gaps, forces = self.pair_values()
        closed, friction = present.active.closed, present.balance.along_surface(present.x)
        column = present.liquid_pressures()
        felt = present.balance.felt(forces)
        return [
            contact_state(
                interface, gaps[part], forces[part], closed[part],
                None if friction is None else friction[part], felt[part], column[part],
            )
            for part, interface in zip(self.gaps.slices, self.gaps.interfaces, strict=True)
        ]  # fmt: skip

    def clamp_totals(self) -> dict[str, float]:
        """Return force and displacement of all clamped surfaces by their columns; collective."""
        found: dict[str, float] = {}
        for body in self.bodies.values():
            values = body.solution.x.array.reshape(-1, body.block_size)[:, : body.dimension]
            for clamp in body.loads.clamps:
                found |= clamp.totals(values)
        return found

    def largest_flow(self) -> float:
        """Return the change of the equivalent viscoplastic strain in the trial step; collective.

        The root mean square over what is solid of a body, of the body in which it is the largest.
        """
        local = np.array([[0.0, 0.0], *(body.flow_of_solid() for body in self.bodies.values())])
        flow, solid = self.layout.comm.allreduce(local, op=MPI.SUM).T
        return float(np.sqrt(flow / np.where(solid > 0.0, solid, 1.0)).max())

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        self.equilibrium.destroy()
        self._assembly.destroy()


def _interface_pairs(
    mesh: CastingMesh,
    pairs: NodePairs,
    contact: Contact,
    midsides: Mapping[str, Midsides],
    liquid: Set[str],
) -> QuadraticPairs:
    """Return the pairs of an interface with mid-sides, and facets where liquid may hold them.

    Args:
        mesh: mesh of the bodies.
        pairs: of the interface.
        contact: of its bodies.
        midsides: of the quadratic bodies by name.
        liquid: names of the bodies that may be liquid.
    """
    tied = is_tied(contact.method)
    found = quadratic_pairs(mesh, pairs, contact.pairing, tied, midsides)
    if tied or liquid.isdisjoint((contact.secondary, contact.primary)):
        return found._replace(facets=None)
    facets = found.facets or facet_pairs(mesh, pairs, contact.pairing.angle_of_patches)
    return found._replace(facets=facets)


def _closed_surfaces(
    mesh: CastingMesh,
    name: str,
    contacts: Sequence[Contact],
    displacements: Sequence[SurfaceDisplacement],
) -> set[str]:
    """Return the surfaces of a body through which no liquid can follow.

    A body that does not meet another one is free there, whatever heat passes.
    """
    sides = [zip((c.secondary, c.primary), c.surfaces, strict=True) for c in contacts]
    shut = {surface for pair in sides for body, surface in pair if body == name}
    shut.update(mesh.bodies[name].symmetry_planes)
    return shut | {d.surface for d in displacements if d.value is not None}
