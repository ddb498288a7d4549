"""Balance of forces of all bodies in contact: rows, matrix, closed pairs, what is held."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.active_set import ActiveSet
from castx.contact.kinematics.coordinates import Coordinates
from castx.contact.kinematics.gaps import Gaps
from castx.contact.method import ContactSystem
from castx.equilibrium.convergence import ForceBalance
from castx.equilibrium.linear_system import SystemOperator
from castx.equilibrium.supports.first_contact import Falling
from castx.equilibrium.supports.in_gates import InGate
from castx.equilibrium.supports.resultants import Resultant, SupportForces
from castx.equilibrium.supports.springs import FloatingMotions, Support
from castx.mechanics.assembly import BodyAssembly
from castx.solvers.worst_place import Part, worst_place

NOISE_SHARE, NOISE_FACTOR = 1e-2, 100.0
"""Forces that are too small to open or close a pair: at most a part of what balances, and no more
than a multiple of the residual, so that exact solutions see the weight of a body beside far larger
thermal forces."""

SETTLED = 1e-3
"""Residual beside the forces in a body from which on pairs may begin to slip or to stick."""


class Balance:
    """The nonlinear problem of one step, as a function of the unknowns of the contact method.

    A row of an unknown that is held is its distance from its place; of others it is the sum of
    forces. Pairs close and open between iterations only, so that a line search sees one function.

    Attributes:
        active: closed pairs.
        operator: the Jacobian.
        frozen: unknowns that stay where they are, whatever acts on them.
        committed_time: of prescribed displacements at the end of the last accepted step [s].
        anchor: unknowns at which the springs of supports are without force.

    Args:
        assembly: residual and matrix of the bodies.
        coordinates: coordinates and prescribed displacements.
        gaps: pairs of all interfaces.
        contact: the contact method.
        floating: finds what nothing holds; None: no supports.
        gates: hold bodies that have lost all contact.
        tolerance: residual relative to the largest internal, contact or external force.
    """

    def __init__(
        self,
        assembly: BodyAssembly,
        coordinates: Coordinates,
        gaps: Gaps,
        contact: ContactSystem,
        floating: FloatingMotions | None,
        gates: Sequence[InGate],
        tolerance: float,
    ) -> None:
        self.assembly, self.gaps, self.contact = assembly, gaps, contact
        self.coordinates, self._floating, self._gates = coordinates, floating, list(gates)
        self._falling = Falling(contact, assembly.unknowns)
        self._support_forces = SupportForces(coordinates, assembly.bodies)
        self._place: FloatArray = np.zeros(contact.layout.size_local)
        self._comm = assembly.layout.comm
        self.active = ActiveSet(self._comm, gaps.initial, gaps.free, gaps.keys())
        self.operator = SystemOperator(assembly.corrections())
        self.frozen: BoolArray = np.zeros(contact.layout.size_local, dtype=bool)
        self.anchor: FloatArray = np.zeros(contact.layout.size_local)
        # Those of pressures are far larger in liquids, since τ is.
        self._displacement_rows = contact.to_unknowns(assembly.displacement_rows()) > 0
        self._diagonal, self._stiffness = np.zeros(0), 0.0
        self._forces_in_bodies = ForceBalance(assembly, contact.layout, tolerance)
        self._time = self.committed_time = 0.0
        self._committed_support: Support | None = None
        self._evaluated: tuple[FloatArray, FloatArray] = np.zeros(0), np.zeros(0)
        self._forces: FloatArray = np.zeros(0)

    def begin(self, x: PETSc.Vec, time: float) -> None:
        """Take over the state of the bodies, with prescribed displacements and loads of a time."""
        self._time = time
        self._forces_in_bodies.begin()
        for gate in self._gates:
            gate.begin(self.active.committed)
        self.gaps.set_time(time)
        for body in self.assembly.bodies:
            body.set_time(time)
        self.rows(x)
        bodies = self.assembly.matrix()
        self.contact.prepare(bodies)
        self.contact.update_bodies(bodies)
        self.update_matrix()
        assert self.operator.matrix is not None
        diagonal = self.operator.matrix.getDiagonal()
        self._diagonal = np.abs(diagonal.array_r)
        largest = float(self._diagonal[self._displacement_rows].max(initial=0.0))
        self._stiffness = self._comm.allreduce(largest, op=MPI.MAX)
        diagonal.destroy()

    def update_matrix(self, renewed: bool = False) -> None:
        """Make the matrix that of the closed pairs, and of the present unknowns if `renewed`."""
        if renewed:
            self.contact.update_bodies(self.assembly.matrix())
        if renewed or self.contact.follows_set or self.operator.matrix is None:
            self.operator.matrix = self.contact.matrix(self.active.closed)

    def rows(self, x: PETSc.Vec) -> FloatArray:
        """Return the rows before the pairs act, and give the bodies their displacements."""
        self.contact.displacements(x, self.assembly.unknowns)
        return self.contact.residual(x, self.assembly.residual())

    def residual(self, x: PETSc.Vec, f: PETSc.Vec) -> None:
        """Fill the residual for the present set of closed pairs.

        Raises:
            ConvergenceError: a law has no answer there.
        """
        rows = self.rows(x)
        self._evaluated = x.array_r.copy(), rows.copy()
        self._forces_in_bodies.update(x, self._diagonal)
        self._sum_up(x, rows, f)

    def _sum_up(self, x: PETSc.Vec, rows: FloatArray, f: PETSc.Vec) -> None:
        closed = self.active.closed
        self._forces = self._trial_forces(x, rows)
        held, violation = self._prescribed(x)
        self.contact.impose(x, self._forces, closed, rows, held, violation)
        for gate in self._gates:
            if gate.holds:
                held[gate.local] = True
                violation[gate.local] = x.array_r[gate.local] - self._place[gate.local]
        held[self.frozen], violation[self.frozen] = True, 0.0
        support = self._support(held)
        state = self.contact.state(closed).copy()
        self.operator.hold(held, self._stiffness, support, state)
        if support is not None:
            rows += support.force(x.array_r - self.anchor)
        f.array[:] = np.where(held, self._stiffness * violation, rows)

    def _trial_forces(self, x: PETSc.Vec, rows: FloatArray) -> FloatArray:
        gaps = self.contact.gaps(x, self.assembly.unknowns)
        return self.contact.trial_forces(x, rows, gaps, self.active.closed, self._stiffness)

    def _prescribed(self, x: PETSc.Vec) -> tuple[BoolArray, FloatArray]:
        held = np.zeros(x.getLocalSize(), dtype=bool)
        violation = np.zeros(len(held))
        for item in self.coordinates.prescribed:
            held[item.local] = True
            violation[item.local] = x.array_r[item.local] - float(item.value(self._time))
        return held, violation

    def _support(self, held: BoolArray) -> Support | None:
        if self._floating is None:
            return None
        values = self.contact.constraint_values(self._floating.motions, self.active.closed)
        return self._floating.find(held, values)

    def change_set(self, x: PETSc.Vec, f: PETSc.Vec) -> bool:
        """Close and open pairs and gates at the present iterate; return whether any did.

        Args:
            x: the iterate.
            f: its residual, filled anew if it has changed.
        """
        improved = self.assembly.improve_pressures()
        if improved or not self._all(np.array_equal(self._evaluated[0], x.array_r)):
            self.residual(x, f)
        noise = min(NOISE_SHARE * self._forces_in_bodies.smallest, NOISE_FACTOR * f.norm())
        settled = f.norm() <= SETTLED * max(self.force, self._forces_in_bodies.smallest)
        changed = self.active.update(self._forces, noise)
        if self.contact.slide(
            x, self._evaluated[1], self._forces, self.active.closed, self._stiffness, noise, settled
        ):
            changed = True
            self.active.forget()
        gripped = [gate.update(self.active.closed, not changed) for gate in self._gates]
        if not changed and not any(gripped):
            return False
        self._sum_up(x, self._evaluated[1].copy(), f)
        return True

    def stop_at_contact(self, x: PETSc.Vec, y: PETSc.Vec) -> bool:
        """End the rigid motion of what only springs hold, in a step to x − y, where it touches.

        Returns:
            Whether y has changed.
        """
        support = self.operator.support
        if support is None:
            return False
        open_pairs = self.gaps.free & ~self.active.closed & ~self.active.frozen
        force = 2 * NOISE_SHARE * self._forces_in_bodies.smallest
        return self._falling.stop(support, x, y, open_pairs, force, self._stiffness)

    def augment(self, x: PETSc.Vec, f: PETSc.Vec, balanced: bool) -> bool:
        """Improve the multipliers of the method, if it has any; return whether they changed.

        Args:
            x: the iterate.
            f: its residual, filled anew if it has changed.
            balanced: whether it is small enough.
        """
        enough = self._forces_in_bodies.smallest
        if not self.contact.augment(self._forces, self.active.closed, balanced, enough):
            return False
        self._sum_up(x, self._evaluated[1].copy(), f)
        return True

    def _all(self, here: bool) -> bool:
        return bool(self._comm.allreduce(here, op=MPI.LAND))

    def holds(self, f: PETSc.Vec) -> bool:
        """Return whether a residual is small enough."""
        return self._forces_in_bodies.holds(f)

    @property
    def is_linear(self) -> bool:
        """Whether the matrix depends on nothing but which pairs are closed."""
        return self.assembly.is_linear and not self.contact.follows_motion

    @property
    def smallest(self) -> float:
        """Residual that is small enough for every body [N]."""
        return self._forces_in_bodies.smallest

    @property
    def force(self) -> float:
        """Forces in the body with the weakest ones [N]."""
        return self._forces_in_bodies.weakest

    def pair_values(self, x: PETSc.Vec) -> tuple[FloatArray, FloatArray]:
        """Return gaps [m] and contact forces [N] of all rows of this rank, no force where open."""
        rows = self.rows(x)
        gaps = self.contact.gaps(x, self.assembly.unknowns)
        forces = np.where(self.active.closed, self._trial_forces(x, rows), 0.0)
        tied = self.gaps.tied
        forces[tied] = rows[self.gaps.local[tied]]
        return gaps, forces

    def along_surface(self, x: PETSc.Vec) -> FloatArray | None:
        """Return the friction on the secondary nodes of all rows [N]; None: there is none."""
        return self.contact.along_surface(x, self.rows(x), self.active.closed)

    def support_force(self, x: PETSc.Vec) -> float:
        """Return the norm of the forces of the supports at unknowns x [N], springs and gates."""
        support = self.operator.support
        springs = 0.0 if support is None else support.resultant(x.array_r - self.anchor)
        gates = self._support_forces.resultants(self._gate_forces(x))
        return springs + sum(float(np.linalg.norm(body.force)) for body in gates.values())

    def supports(self, x: PETSc.Vec) -> dict[str, Resultant]:
        """Return what the supports exert on each body at unknowns x; collective."""
        forces, support = self._gate_forces(x), self.operator.support
        if support is not None:
            forces = forces - support.force(x.array_r - self.anchor)[: len(forces)]
        return self._support_forces.resultants(forces)

    def _gate_forces(self, x: PETSc.Vec) -> FloatArray:
        forces = np.zeros(self.assembly.layout.size_local)
        rows = self.rows(x)
        for gate in self._gates:
            if gate.holds:
                forces[gate.local] = rows[gate.local]
        return forces

    def adopt(self, other: Balance) -> None:
        """Take over the committed time and pairs of another contact method."""
        self.gaps.at_rest[:] = other.gaps.at_rest
        self.committed_time, self._committed_support = other.committed_time, None
        self.active.restore(other.active.committed & self.gaps.free)

    def worst_place(self, f: PETSc.Vec) -> str:
        """Say where a residual is largest, the same text on all ranks; collective."""
        layout, parts = self.contact.layout, []
        for b, body in enumerate(self.assembly.bodies):
            own = f.array_r[layout.local_slice(b)].reshape(-1, body.block_size)
            points, d = body.mesh.points[: len(own)], body.dimension
            parts.append(Part(f"body {body.name!r} (forces)", own[:, :d], points))
            parts.append(Part(f"body {body.name!r} (volumes, axial strain)", own[:, d:], points))
        rest = f.array_r[self.assembly.layout.size_local :]
        for part, interface in zip(self.gaps.slices, self.gaps.interfaces, strict=True):
            if len(rest):
                points = interface.pairs.points[interface.index]
                parts.append(Part(f"interface {interface.pairs.name!r}", rest[part], points))
        return worst_place(self._comm, parts, "N")

    def commit(self, x: PETSc.Vec) -> None:
        """Make the present state, whose unknowns are x, the one from which the next step starts."""
        self._place = x.array_r.copy()
        self.committed_time, self._committed_support = self._time, self.operator.support
        self.active.commit()
        self.contact.commit(x)
        for body in self.assembly.bodies:
            body.commit()

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the last committed state, whose unknowns are x."""
        self._place = x.array_r.copy()
        self._time, self.operator.support = self.committed_time, self._committed_support
        self.gaps.set_time(self._time)
        self.active.rewind()
        self.contact.rewind(x)
        for body in self.assembly.bodies:
            body.rewind()
        self.rows(x)

    def destroy(self) -> None:
        """Free what PETSc holds; the bodies are their owner's."""
        self.contact.destroy()
