"""Balance of momentum of all bodies in contact: rows, matrix, pairs, constrained unknowns."""

from __future__ import annotations

from dataclasses import replace

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.kinematics.active_set import ActiveSet
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.iterate import ConstrainedRows, PairIterate
from castx.contact.kinematics.transform import ConstraintTransform
from castx.contact.liquid_skin import LiquidSkin
from castx.contact.system import ContactSystem
from castx.equilibrium.convergence import ForceConvergence
from castx.equilibrium.linear_system import SystemOperator
from castx.equilibrium.net_forces import NetForces
from castx.equilibrium.pocket_block import PocketBlock
from castx.equilibrium.supports.acting import Supports
from castx.mechanics.assembly import BodyAssembly
from castx.profiling import RunPart, booked_as


class MomentumBalance:
    """The nonlinear problem of one step, as a function of the unknowns of the contact method.

    A row of a constrained unknown is its distance from its place; of others it is the sum of
    forces. Pairs close and open between iterations only, so that a line search sees one function.

    Attributes:
        assembly: residual and matrix of the bodies.
        transform: change of unknowns and prescribed displacements.
        gaps: pairs of all interfaces.
        contact: the contact method.
        supports: springs and in-gates.
        active: closed pairs.
        skin: finds the pulls that liquid bears at its wall.
        operator: the Jacobian.
        convergence: tests residuals.
        frozen: unknowns that stay where they are, whatever acts on them.
        iterate: where the residual was evaluated last.
        trial_forces: of the pairs there [N].
        stiffness: force per length of rows that have none of their own [N/m].
        committed_time: of prescribed displacements at the end of the last accepted step [s].

    Args:
        assembly: residual and matrix of the bodies.
        transform: change of unknowns and prescribed displacements.
        gaps: pairs of all interfaces.
        contact: the contact method.
        supports: springs and in-gates.
        tolerance: residual relative to the net forces on a body.
    """

    def __init__(
        self,
        assembly: BodyAssembly,
        transform: ConstraintTransform,
        gaps: Gaps,
        contact: ContactSystem,
        supports: Supports,
        tolerance: float,
    ) -> None:
        self.assembly, self.gaps, self.contact = assembly, gaps, contact
        self.transform, self.supports = transform, supports
        self._comm = assembly.layout.comm
        self.active = ActiveSet(self._comm, gaps.initial, gaps.free, gaps.signatures())
        self.skin = LiquidSkin(assembly.layout, assembly.bodies, gaps)
        self.operator = SystemOperator([*assembly.corrections(), PocketBlock(assembly, transform)])
        self._net = NetForces(assembly, transform, gaps)
        self.convergence = ForceConvergence(assembly, contact.layout, self._net, tolerance)
        self.frozen: BoolArray = np.zeros(contact.layout.size_local, dtype=bool)
        # Those of pressures are far larger in liquids, since τ is.
        self._displacement_rows = contact.unknowns.extended(assembly.displacement_rows()) > 0
        none: FloatArray = np.zeros(0)
        self._diagonal, self._evaluated = none, none
        self._time = self.committed_time = self.stiffness = 0.0
        self.iterate = PairIterate(assembly.unknowns, none, none, self.active.closed, 0.0)
        self.trial_forces: FloatArray = np.zeros(len(gaps.initial))

    def begin(self, x: PETSc.Vec, time: float) -> None:
        """Take over the state of the bodies, with prescribed displacements and loads of a time."""
        self._time = time
        self.active.hold(*self.skin.pulls())
        self.contact.hold(self.active.held)
        self.supports.begin(self.active.committed)
        self.gaps.set_time(time)
        for body in self.assembly.bodies:
            body.set_time(time)
        self.set_displacements(x)
        self.iterate = self._pair_iterate(x)
        self.contact.begin(self.assembly.matrix())
        self.update_matrix()
        assert self.operator.matrix is not None
        diagonal = self.operator.matrix.getDiagonal()
        self._diagonal = np.abs(diagonal.array_r)
        of_displacements = self._diagonal[self._displacement_rows]
        self.convergence.begin(of_displacements)
        self.stiffness = self._comm.allreduce(float(of_displacements.max(initial=0)), op=MPI.MAX)
        diagonal.destroy()

    @booked_as(RunPart.CONTACT)
    def update_matrix(self, renewed: bool = False) -> None:
        """Update the matrix for the closed pairs, and for the present unknowns if `renewed`."""
        if renewed:
            self.contact.normal.update_bodies(self.assembly.matrix())
        if renewed or self.contact.follows_set or self.operator.matrix is None:
            present = replace(self.iterate, closed=self.active.closed)
            self.operator.matrix = self.contact.matrix(present)

    def set_displacements(self, x: PETSc.Vec) -> None:
        """Move the bodies to the unknowns x."""
        self.contact.unknowns.displacements(x, self.assembly.unknowns)

    def rows(self, x: PETSc.Vec) -> FloatArray:
        """Return the rows before the pairs act, at the unknowns x of `set_displacements`."""
        return self.contact.unknowns.residual(x, self.assembly.residual())

    def _pair_iterate(self, x: PETSc.Vec) -> PairIterate:
        """Return the iterate at the unknowns x of `set_displacements`."""
        rows = self.rows(x)
        gaps = self.contact.normal.gaps(x, self.assembly.unknowns)
        return PairIterate(x, rows, gaps, self.active.closed, self.stiffness)

    def residual(self, x: PETSc.Vec, f: PETSc.Vec, *, judged: bool = True) -> None:
        """Fill the residual for the present set of closed pairs.

        Args:
            x: the unknowns.
            f: the residual.
            judged: whether `convergence` will be asked of it, whose forces cost as much again.

        Raises:
            ConvergenceError: a law has no answer there.
        """
        self.set_displacements(x)
        iterate = self._pair_iterate(x)
        self._evaluated = x.array_r.copy()
        self._sum_up(iterate, f, judged)

    @booked_as(RunPart.CONTACT)
    def _sum_up(self, iterate: PairIterate, f: PETSc.Vec, judged: bool) -> None:
        """Fill the residual from the rows of an iterate: pairs, supports, constrained unknowns."""
        x = iterate.x.array_r
        self.iterate, self.trial_forces = iterate, self.contact.normal.trial_forces(iterate)
        rows = ConstrainedRows(iterate.rows.copy())
        for item in self.transform.prescribed:
            rows.constrain(item.local, x[item.local] - float(item.value(self._time)))
        self.contact.impose(iterate, self.trial_forces, rows)
        self.supports.constrain(x, rows)
        rows.constrained[self.frozen], rows.violation[self.frozen] = True, 0.0
        self._find_springs(rows.constrained)
        springs, state = self.supports.springs, self.contact.state(self.active.closed)
        self.operator.constrain(rows.constrained, self.stiffness, springs, state)
        forces = self.supports.spring_forces(x)
        if forces is not None:
            rows.forces += forces
        f.array[:] = np.where(rows.constrained, self.stiffness * rows.violation, rows.forces)
        if judged:
            carried = self._forces_of_pairs(iterate, self.trial_forces)
            self.convergence.update(iterate.x, self._diagonal, carried)

    def foretold_rows(self, y: PETSc.Vec) -> FloatArray:
        """Return the rows before the pairs act that the linear system has behind a step y.

        Args:
            y: step from the iterate, evaluated last, to x − y.
        """
        change = y.duplicate()
        self.operator.free_product(y, change)
        rows: FloatArray = self.iterate.rows - change.array_r
        change.destroy()
        return rows

    def take_off(self, foretold: FloatArray, f: PETSc.Vec) -> None:
        """Make rows of constrained unknowns forces beyond foretold ones, F = r(x) − (r(x₀) − A y).

        So the residual of any iterate is the gradient of an energy: that of the bodies, less the
        work of constant forces on what is constrained. Distances from a place would be none.

        Args:
            foretold: rows before the pairs act, of `foretold_rows`.
            f: residual of the iterate, evaluated last, changed in place.
        """
        constrained = self.operator.constrained
        f.array[constrained] = (self.iterate.rows - foretold)[constrained]

    def felt(self, forces: FloatArray) -> FloatArray:
        """Return contact forces, those of pairs that liquid holds as it feels them; collective.

        Args:
            forces: of the rows [N], shape (rows,).
        """
        return self.skin.felt(forces, self.active.closed & self.active.held)

    def _find_springs(self, constrained: BoolArray) -> None:
        motions = self.supports.motions
        if motions is not None:
            values = self.contact.constraint_values(motions, self.active.closed)
            self.supports.find_springs(constrained, values)

    def sum_up_again(self, x: PETSc.Vec, f: PETSc.Vec) -> None:
        """Fill the residual at unknowns x, evaluated last, for the present state of the pairs."""
        self._sum_up(self.present(x), f, judged=True)

    def present(self, x: PETSc.Vec) -> PairIterate:
        """Return the iterate at the unknowns x, evaluated last, with the present closed pairs."""
        return replace(self.iterate, x=x, closed=self.active.closed)

    def is_evaluated_at(self, x: PETSc.Vec) -> bool:
        """Return whether the residual was evaluated last at the unknowns x; collective."""
        same = np.array_equal(self._evaluated, x.array_r)
        return bool(self._comm.allreduce(same, op=MPI.LAND))

    @property
    def is_linear(self) -> bool:
        """Whether the matrix depends on nothing but which pairs are closed."""
        return self.assembly.is_linear and self.contact.is_linear

    def pair_values(self, x: PETSc.Vec) -> tuple[FloatArray, FloatArray]:
        """Return gaps [m] and contact forces [N] of all rows of this rank, no force where open."""
        self.set_displacements(x)
        iterate = self._pair_iterate(x)
        trial = self.contact.normal.trial_forces(iterate)
        return iterate.gaps, self._forces_of_pairs(iterate, trial)

    def _forces_of_pairs(self, iterate: PairIterate, trial: FloatArray) -> FloatArray:
        forces = np.where(iterate.closed, trial, 0.0)
        tied = self.gaps.tied
        forces[tied] = iterate.rows[self.gaps.local[tied]]
        return forces

    def along_surface(self, x: PETSc.Vec) -> FloatArray | None:
        """Return the friction on the secondary nodes of all rows [N]; None: there is none."""
        self.set_displacements(x)
        return self.contact.along_surface(self._pair_iterate(x))

    def adopt(self, other: MomentumBalance) -> None:
        """Take over the accepted time and pairs of another contact method."""
        self.gaps.at_rest[:] = other.gaps.at_rest
        self.committed_time = other.committed_time
        self.supports.adopt()
        self.active.restore(other.active.committed & self.gaps.free)

    def commit(self, x: PETSc.Vec) -> None:
        """Accept the present state, whose unknowns are x, as the start of the next step."""
        self.committed_time = self._time
        self.supports.commit(x.array_r)
        self.active.commit()
        self.contact.commit(x)
        for body in self.assembly.bodies:
            body.commit()

    def rewind(self, x: PETSc.Vec) -> None:
        """Return to the last accepted state, whose unknowns are x."""
        self._time = self.committed_time
        self.supports.rewind(x.array_r)
        self.operator.support = self.supports.springs
        self.gaps.set_time(self._time)
        self.active.rewind()
        self.contact.rewind(x)
        for body in self.assembly.bodies:
            body.rewind()
            body.set_time(self._time)
        self.set_displacements(x)
        self.assembly.residual()  # which hands them to the bodies

    def destroy(self) -> None:
        """Destroy the PETSc objects; the bodies are their owner's."""
        self.contact.destroy()
        self._net.destroy()
