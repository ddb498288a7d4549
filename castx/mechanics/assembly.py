"""Assembles residual and matrix of all bodies without their contact."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from functools import partial

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
from dolfinx import fem

from castx.arrays import FloatArray
from castx.errors import ConvergenceError
from castx.mechanics.body import BodyMechanics
from castx.mechanics.formulation import MidsideForms, Product
from castx.profiling import RunPart, booked_as
from castx.solvers.layout import Layout

FAILED = 2
"""State of a rank where a law cannot be solved, above 1: evaluated anew, and 0: nothing new."""

Correction = Callable[[FloatArray, FloatArray], None]
"""Adds to its second argument, owned rows, the image of its first."""


class BodyAssembly:
    """Residual and matrix of all bodies without contact, in the layout of their unknowns.

    Args:
        layout: numbering of the unknowns of all bodies.
        bodies: the bodies in the order of the layout, which has the mid-sides of those that have
            any behind them.

    Attributes:
        unknowns: where the residual is evaluated, in the layout.
        quadratic: numbers of the bodies with mid-sides, in the order of the layout.
    """

    def __init__(self, layout: Layout, bodies: Sequence[BodyMechanics]) -> None:
        self.layout, self.bodies = layout, list(bodies)
        self.unknowns = layout.create_vector()
        self.residual_vector = layout.create_vector()
        self._blocks = [body.formulation.forms.create_jacobian() for body in bodies]
        self._midsides = {
            b: MidsideBlocks(body.formulation.midside_forms)
            for b, body in enumerate(bodies)
            if body.formulation.midside_forms is not None
        }
        self.quadratic = list(self._midsides)
        self._nest = PETSc.Mat().createNest(self._all_blocks(), comm=layout.comm)
        self._matrix: PETSc.Mat | None = None
        self._evaluations = [-1] * len(self.bodies)
        self._trials = [-1] * len(self.bodies)

    def _all_blocks(self) -> list[list[PETSc.Mat | None]]:
        """Return the blocks of nodes and mid-sides, none between bodies."""
        count = len(self.bodies) + len(self._midsides)
        blocks: list[list[PETSc.Mat | None]] = [[None] * count for _ in range(count)]
        for b, block in enumerate(self._blocks):
            blocks[b][b] = block
        for k, (b, own) in enumerate(self._midsides.items(), len(self.bodies)):
            blocks[k][k], blocks[k][b], blocks[b][k] = own.own, own.rows, own.columns
        return blocks

    def _functions(self) -> list[fem.Function]:
        """Return the unknowns in the order of the layout."""
        midsides = [self.bodies[b].midsides for b in self.quadratic]
        return [
            *(body.solution for body in self.bodies), *(m.solution for m in midsides if m)
        ]  # fmt: skip

    @booked_as(RunPart.ASSEMBLY)
    def residual(self) -> PETSc.Vec:
        """Return internal minus external forces at `unknowns`; the next call overwrites them.

        Where unknowns and state of the bodies are those of the last call, it has them already.

        Raises:
            ConvergenceError: the law of a body cannot be solved; on all ranks.
        """
        self.layout.to_functions(self.unknowns, self._functions())
        if not self._update_points():
            return self.residual_vector
        values = self.residual_vector.array
        for b, body in enumerate(self.bodies):
            values[self.layout.local_slice(b)] = body.formulation.residual()
        for k, b in enumerate(self.quadratic, len(self.bodies)):
            own = self.bodies[b].formulation.midside_residual()
            values[self.layout.local_slice(k)] = own
        return self.residual_vector

    def _update_points(self) -> bool:
        """Find the stresses of all bodies; return whether the residual is another one."""
        failure = ""
        for body in self.bodies:
            try:
                if not body.is_evaluated:
                    body.update_points()
            except ConvergenceError as error:
                failure = f"body {body.name!r}: {error}"
        evaluations = [body.evaluations for body in self.bodies]
        local = FAILED if failure else int(evaluations != self._evaluations)
        self._evaluations = [-1] * len(self.bodies) if failure else evaluations
        # Collective on every residual: one number.
        state = self.layout.comm.allreduce(local, op=MPI.MAX)
        if state == FAILED:
            raise ConvergenceError(next(filter(None, self.layout.comm.allgather(failure))))
        return bool(state > 0)

    @booked_as(RunPart.ASSEMBLY)
    def matrix(self) -> PETSc.Mat:
        """Return the assembled Jacobian; the next call overwrites it.

        That of a linear body is assembled once for each state of its material.
        """
        for b, (body, block) in enumerate(zip(self.bodies, self._blocks, strict=True)):
            if not body.is_linear or body.trials != self._trials[b]:
                body.formulation.assemble_jacobian(block)
                if b in self._midsides:
                    self._midsides[b].assemble()
                self._trials[b] = body.trials
        self._nest.assemble()
        if self._matrix is None:
            self._matrix = self._nest.convert("aij", PETSc.Mat())
        else:
            self._nest.convert("aij", self._matrix)
        return self._matrix

    @property
    def is_linear(self) -> bool:
        """Whether the matrix is the same for all unknowns of a step."""
        return all(body.is_linear for body in self.bodies)

    @property
    def flows_by_rate(self) -> bool:
        """Whether each body flows by a rate or has the same matrix for all unknowns of a step."""
        return all(body.is_linear or body.material.law.flows_by_rate for body in self.bodies)

    @property
    def is_elastic(self) -> bool:
        """Whether all bodies are elastic at every temperature."""
        return self.is_linear and all(body.is_compressible for body in self.bodies)

    def force_scales(self) -> FloatArray:
        """Return the size of the forces in each body [N], shape (bodies,); collective.

        It is the larger one of two norms over the nodes: that of the forces of the cells on their
        nodes, which count although they cancel each other, and that of the loads.
        """
        squares = np.array([body.force_scale() for body in self.bodies])
        total = self.layout.comm.allreduce(squares, op=MPI.SUM)
        return np.asarray(np.sqrt(total.max(axis=1)))

    def improve_pressures(self) -> bool:
        """Take the pressures of Q1/P0 cells for their multipliers; return whether any has one."""
        improved = [body.improve_pressures() for body in self.bodies]
        return bool(self.layout.comm.allreduce(any(improved), op=MPI.LOR))

    @property
    def pores_changed(self) -> bool:
        """Whether pores of any body have opened or closed at the present iterate; collective."""
        here = any(body.formulation.pores_changed for body in self.bodies)
        return bool(self.layout.comm.allreduce(here, op=MPI.LOR))

    def displacement_rows(self) -> FloatArray:
        """Return 1 at the owned unknowns that are displacements, else 0."""
        rows = np.zeros(self.layout.size_local)
        for b, body in enumerate(self.bodies):
            part = rows[self.layout.local_slice(b)].reshape(-1, body.block_size)
            part[:, : body.dimension] = 1.0
            if body.axial is not None:
                part[:, body.axial] = 1.0
        for k in range(len(self.bodies), len(self.bodies) + len(self.quadratic)):
            rows[self.layout.local_slice(k)] = 1.0
        return rows

    def corrections(self) -> list[Correction]:
        """Return the pressure part of the Jacobian that the matrix lacks, from OSGS."""
        return self._on_parts([body.formulation.products() for body in self.bodies])

    def corrections_matrix(self, layout: Layout, bodies: Collection[int]) -> PETSc.Mat | None:
        """Return the matrix of `corrections` of some bodies, as far as it is known.

        The caller destroys it; None: there is none; collective.

        Args:
            layout: of the matrix, with the unknowns of the contact method behind the bodies.
            bodies: their numbers.
        """
        own = {b: self.bodies[b].formulation.matrix_of_products() for b in bodies}
        known = {b: block for b, block in own.items() if block is not None}
        if not known:
            return None
        parts = [
            known[k] if k in known else _empty(layout, k) for k in range(len(layout.block_sizes))
        ]
        blocks = [
            [part if k == m else None for m in range(len(parts))] for k, part in enumerate(parts)
        ]
        nest = PETSc.Mat().createNest(blocks, comm=layout.comm)
        found = nest.convert("aij", PETSc.Mat())
        for item in (nest, *parts):
            item.destroy()
        return found

    def coupled_corrections(self) -> list[Correction]:
        """Return the products of the trapped liquid with displacements."""
        return self._on_parts([body.formulation.coupled_products() for body in self.bodies])

    def _on_parts(self, products: Sequence[Sequence[Product]]) -> list[Correction]:
        """Return products of each body as corrections of the unknowns of all."""
        return [
            partial(_on_parts, self._slices(b), product)
            for b, of_body in enumerate(products)
            for product in of_body
        ]

    def _slices(self, b: int) -> list[slice]:
        """Return where the unknowns of the nodes and of the mid-sides of a body lie."""
        found = [self.layout.local_slice(b)]
        if b in self._midsides:
            k = len(self.bodies) + self.quadratic.index(b)
            found.append(self.layout.local_slice(k))
        return found

    @property
    def has_pockets(self) -> bool:
        """Whether any body has trapped liquid in the trial step."""
        return any(body.formulation.has_pockets for body in self.bodies)

    def destroy(self) -> None:
        """Free matrices and vectors."""
        for own in self._midsides.values():
            own.destroy()
        for item in (self._matrix, self._nest, *self._blocks, self.unknowns, self.residual_vector):
            if item is not None:
                item.destroy()


class MidsideBlocks:
    """The blocks of the mid-sides of one body in the matrix.

    Attributes:
        own: of the mid-sides themselves.
        rows: of the mid-sides for the unknowns of the nodes.
        columns: of the nodes for the unknowns of the mid-sides.

    Args:
        forms: of the mid-sides.
    """

    def __init__(self, forms: MidsideForms) -> None:
        self._forms = forms
        self.own, self.rows = forms.create_jacobian(), forms.create_coupling()
        forms.assemble_coupling(self.rows)
        self.columns = self.rows.transpose(PETSc.Mat())

    def assemble(self) -> None:
        """Assemble the blocks at the present stresses and tangents; collective."""
        self._forms.assemble_jacobian(self.own)
        self._forms.assemble_coupling(self.rows)
        self.rows.transpose(self.columns)

    def destroy(self) -> None:
        """Free the matrices."""
        for matrix in (self.own, self.rows, self.columns):
            matrix.destroy()


def _empty(layout: Layout, part: int) -> PETSc.Mat:
    """Return a matrix without entries for a part of a layout."""
    own = layout.local_slice(part)
    size = own.stop - own.start, None
    matrix = PETSc.Mat().createAIJ((size, size), nnz=0, comm=layout.comm)
    matrix.assemble()
    return matrix


def _on_parts(parts: Sequence[slice], product: Product, x: FloatArray, y: FloatArray) -> None:
    """Add the product of one body to the unknowns of all."""
    if len(parts) == 1:
        product(x[parts[0]], y[parts[0]])
        return
    own = np.concatenate([y[part] for part in parts])
    product(np.concatenate([x[part] for part in parts]), own)
    place = 0
    for part in parts:
        size = part.stop - part.start
        y[part] = own[place : place + size]
        place += size
