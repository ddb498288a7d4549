"""Puts together the equilibrium of all bodies from descriptions of bodies, supports and contact."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.assembly import BodyAssembly
from castx.balance import Balance
from castx.constraints import SurfaceDisplacement, fixed_directions
from castx.contact.choice import Contact, check_bodies, common_method
from castx.contact.gaps import Gaps
from castx.contact.methods import contact_system
from castx.contact.multipliers import MultiplierContact
from castx.contact.pair_state import ContactState, contact_state
from castx.contact.rigid import rigid_body
from castx.contact.rows import single_rows
from castx.contact.system import ContactSystem
from castx.coordinates import Coordinates
from castx.equilibrium import PREFIX, Equilibrium
from castx.layout import Layout
from castx.linear import InnerSolver
from castx.measures import extent, nodal_volumes
from castx.mechanical_body import MechanicalBody
from castx.mechanical_memory import MechanicalMemory
from castx.mechanics import BodyMechanics
from castx.mesh import CastingMesh
from castx.pairs import node_pairs
from castx.rigid_modes import near_null_modes, rigid_modes
from castx.schur import ArrowSchur
from castx.solvers import MOST_CHANGED, BodywiseMultigrid, DirectSolver
from castx.supports import FIRM, WEAK, FloatingMotions

FloatArray = npt.NDArray[np.float64]


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
    """

    linear: str = "automatic"
    tolerance: float = 1e-3
    support: bool = True
    options: Mapping[str, Any] = field(default_factory=dict)


class MechanicalProblem:
    """The bodies, their contact and the solver of their equilibrium.

    Args:
        mesh: mesh of all bodies.
        bodies: mechanical description by name of the body; others are rigid.
        displacements: displacement conditions by name of the body.
        contacts: interfaces with contact.
        settings: how to solve.

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
    ) -> None:
        method = common_method(contacts)
        check_bodies(contacts, bodies)
        names = list(bodies)
        bodies = {
            n: replace(body, closed=_closed_surfaces(mesh, n, displacements.get(n, ())))
            for n, body in bodies.items()
        }
        fixed = [
            fixed_directions(mesh.bodies[n], mesh.model, displacements.get(n, ())) for n in names
        ]
        planes = [[condition for condition in f if condition.symmetry] for f in fixed]
        parts = [
            BodyMechanics(mesh.bodies[n], mesh.model, bodies[n], planes[b])
            for b, n in enumerate(names)
        ]
        self.bodies = dict(zip(names, parts, strict=True))
        self.layout = Layout(
            mesh.comm,
            [body.space.dofmap.index_map for body in parts],
            [body.block_size for body in parts],
        )
        self.pairs = [node_pairs(mesh, c.secondary, c.primary) for c in contacts]
        rows = [single_rows(p, c.treatment) for c, p in zip(contacts, self.pairs, strict=True)]
        coordinates = Coordinates(
            self.layout, names, parts[0].dimension, fixed, rows, [body.axial for body in parts]
        )
        initial = [c.initial_gap(p.points) for c, p in zip(contacts, self.pairs, strict=True)]
        self.rigid = {
            n: rigid_body(n, mesh.model, displacements.get(n, ()))
            for n in mesh.bodies
            if n not in bodies
        }
        self.gaps = Gaps(self.layout, names, coordinates.interfaces, initial, self.rigid)
        length = extent(mesh.parent)
        stiffness = max(b.law.largest_shear_modulus() for b in bodies.values()) / length
        contact = contact_system(method, contacts, coordinates, names, self.gaps, stiffness)
        springs = (WEAK if contacts else FIRM) * stiffness / length
        floating = self._floating(coordinates, contact, springs)
        inner = self._inner_solver(settings.linear, coordinates, contact)
        balance = Balance(
            BodyAssembly(self.layout, parts), coordinates, self.gaps, contact,
            floating if settings.support else None, settings.tolerance,
        )  # fmt: skip
        self.equilibrium = Equilibrium(balance, inner, settings.options)
        self.memory = MechanicalMemory(self.bodies, coordinates, balance, self.equilibrium)

    def contact_states(self) -> list[ContactState]:
        """Return what the pairs of each interface do; collective."""
        gaps, forces = self.equilibrium.pair_values()
        closed = self.equilibrium.active.closed
        return [
            contact_state(interface, gaps[part], forces[part], closed[part])
            for part, interface in zip(self.gaps.slices, self.gaps.interfaces, strict=True)
        ]

    def _inner_solver(
        self, linear: str, coordinates: Coordinates, contact: ContactSystem
    ) -> InnerSolver:
        parts = list(self.bodies.values())
        if linear == "automatic":
            small = self.layout.size_global <= LARGEST_DIRECT[parts[0].mesh.mesh.topology.dim]
            linear = "direct" if small else "iterative"
        prefix, comm = f"{PREFIX}bodies_", self.layout.comm
        if linear == "direct":
            multipliers = isinstance(contact, MultiplierContact)
            return DirectSolver(comm, prefix, 0 if multipliers else MOST_CHANGED)
        modes = []
        for b, body in enumerate(parts):
            own = self.layout.local_slice(b)
            forward = coordinates.to_coordinates.mult
            modes.append(
                np.array([self._image(forward, b, mode)[own] for mode in near_null_modes(body)])
            )
        if isinstance(contact, MultiplierContact):
            weights = contact.schur_weights()
            return ArrowSchur(comm, prefix, self.layout.index_sets(), modes, weights)
        return BodywiseMultigrid(comm, prefix, self.layout.index_sets(), modes)

    def _floating(
        self, coordinates: Coordinates, contact: ContactSystem, stiffness: float
    ) -> FloatingMotions:
        motions, weights = [], []
        for b, body in enumerate(self.bodies.values()):
            volumes = np.repeat(nodal_volumes(body.mesh, body.model), body.block_size)
            for mode in rigid_modes(body):
                motions.append(self._image(coordinates.to_coordinates.mult, b, mode))
                transpose = coordinates.to_displacements.multTranspose
                weights.append(self._image(transpose, b, volumes * mode))
        return FloatingMotions(
            contact.to_unknowns(np.array(motions)),
            contact.to_unknowns(np.array(weights)),
            stiffness,
            self.layout.comm,
        )

    def _image(
        self, product: Callable[[PETSc.Vec, PETSc.Vec], None], b: int, values: FloatArray
    ) -> FloatArray:
        x, y = self.layout.create_vector(), self.layout.create_vector()
        x.array[self.layout.local_slice(b)] = values
        product(x, y)
        image = y.array_r.copy()
        x.destroy()
        y.destroy()
        return np.asarray(image)


def _closed_surfaces(
    mesh: CastingMesh, name: str, displacements: Sequence[SurfaceDisplacement]
) -> set[str]:
    """Return the surfaces of a body through which no liquid can follow."""
    surfaces = mesh.bodies[name].surfaces
    shut = {s for s in surfaces if s in mesh.bodies or s.startswith("symmetry-")}
    return shut | {d.surface for d in displacements if d.value is not None}
