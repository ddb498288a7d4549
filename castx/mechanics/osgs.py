"""Orthogonal sub-grid scales: the projected pressure gradient Π (Chiumenti, section 2.2).

OSGS puts Σ_e τ_e ∫ ∇q·(∇p - Π) into the continuity equation, with Π on the nodes such that

    Σ_e τ_e ∫ ω·(∇p - Π) = 0   for all ω.

Here the matrix of Π is lumped and weighted with τ_e: a plain projection lets the pressure gradient
of the solid leak into the liquid, whose τ is far larger. With G = Σ_e τ_e ∫ ω·∇p and the lumped M,
Π = M⁻¹ G p, and the part of OSGS beyond GLS is Σ_e τ_e ∫ ∇q·Π = Gᵀ M⁻¹ G p.

Metal that freezes has one projection in its solid and one in its liquid. Pressure bends at the
front, and Π there would be that of the liquid, by its τ: a skin on few cells would be stabilised as
by GLS, against all of its gradient, and would contract too little.

Source: R. Codina, Computer Methods in Applied Mechanics and Engineering 190 (2000); C. Agelet de
Saracibar, M. Chiumenti, Q. Valverde and M. Cervera, ibid. 195 (2006).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, la
from dolfinx.fem.petsc import assemble_matrix, create_matrix

from castx.arrays import FloatArray
from castx.domain.measures import cell_measure
from castx.forms import stabilisation
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.formulation import BodyUnknowns


class OrthogonalProjection:
    """The operator Gᵀ M⁻¹ G of one body, or of a part of its cells.

    On symmetry planes Π has no normal component: that of the mirror image would cancel it.

    Args:
        unknowns: of the body, with the pressure.
        tau: τ_e of the cells [m²/Pa], zero in those that do not belong to the part.
        planes: symmetry planes of the body.
    """

    def __init__(self, unknowns: BodyUnknowns, tau: Any, planes: Sequence[FixedDirections]) -> None:
        mesh, nodes = unknowns.mesh.mesh, unknowns.mesh.nodes
        self._scale, self._dimension = unknowns.pressure_scale, unknowns.dimension
        self._pressures = slice(unknowns.pressure_component, None, unknowns.block_size)
        vectors = fem.functionspace(mesh, ("Lagrange", 1, (self._dimension,)))
        dx = cell_measure(unknowns.mesh, unknowns.model, 2)
        p, omega = ufl.TrialFunction(nodes), ufl.TestFunction(vectors)
        self._gradient_form = fem.form(stabilisation.weighted_gradient(p, omega, tau, dx))
        self._weight_form = fem.form(
            stabilisation.projection_weight(ufl.TestFunction(nodes), tau, dx)
        )
        self._weight = la.vector(nodes.dofmap.index_map)
        self._comm, self._acts = mesh.comm, False
        self._taken: PETSc.Mat | None = None
        self._gradient = create_matrix(self._gradient_form)
        # With all entries of its pattern, whose values there are none of yet.
        self._fill_gradient()
        self._gradient.zeroEntries()
        self._pressure, self._force = (self._gradient.createVecRight() for _ in range(2))
        self._projected = self._gradient.createVecLeft()
        self._mirrored, self._in_planes = _tangential(
            planes, nodes.dofmap.index_map.size_local, self._dimension
        )

    def assemble(self) -> None:
        """Assemble G and M for the present shear moduli; collective."""
        self._weight.array[:] = 0
        fem.assemble_vector(self._weight.array, self._weight_form)
        self._weight.scatter_reverse(la.InsertMode.add)
        owned = self._weight.array[: self._pressure.getLocalSize()]
        self._acts = bool(self._comm.allreduce(bool(owned.any()), op=MPI.LOR))
        if self._acts:
            self._fill_gradient()

    def _fill_gradient(self) -> None:
        self._gradient.zeroEntries()
        assemble_matrix(self._gradient, self._gradient_form)
        self._gradient.assemble()

    def matrix(self) -> PETSc.Mat:
        """Return Gᵀ M⁻¹ G for all unknowns of the body, which the caller destroys; collective.

        Its pattern is always the same: two pressures meet where they share a neighbour.
        """
        count, dimension = self._pressure.getLocalSize(), self._dimension
        weight = self._weight.array[:count] if self._acts else np.zeros(count)
        inverse = np.divide(1.0, weight, out=np.zeros(count), where=weight > 0)
        blocks = inverse[:, None, None] * np.eye(dimension)
        blocks[self._mirrored] = inverse[self._mirrored, None, None] * self._in_planes
        of_pressures = self._gradient.matMult(self._pressures_of_unknowns())
        projected = _block_diagonal(self._projected, blocks)
        found = projected.ptap(of_pressures)
        projected.destroy()
        of_pressures.destroy()
        return found

    def add_product(self, x: FloatArray, y: FloatArray) -> None:
        """Add Gᵀ M⁻¹ G p to the rows of the pressures, scaled like the unknowns; collective.

        Args:
            x: owned unknowns of the body with the pressures p; those of ghosts may follow.
            y: owned rows of the residual, changed in place.
        """
        if self._acts:
            y[self._pressures] += self._correction(x[self._pressures])

    def _correction(self, pressure: FloatArray) -> FloatArray:
        owned = self._pressure.getLocalSize()
        self._pressure.array[:] = pressure[:owned]
        self._gradient.mult(self._pressure, self._projected)
        projected = self._projected.array.reshape(owned, self._dimension)
        # Nodes inside trapped liquid have no weight: nothing is projected there.
        weight = self._weight.array[:owned, None]
        np.divide(projected, weight, out=projected, where=weight > 0)
        mirrored = self._mirrored
        projected[mirrored] = np.einsum("nij,nj->ni", self._in_planes, projected[mirrored])
        self._gradient.multTranspose(self._projected, self._force)
        return np.asarray(self._scale**2 * self._force.array)

    def _pressures_of_unknowns(self) -> PETSc.Mat:
        """Return the matrix that takes the pressures [Pa] out of the unknowns of the body."""
        if self._taken is None:
            first, last = self._pressure.getOwnershipRange()
            size, count = self._pressures.step, last - first
            columns = np.arange(first, last) * size + self._pressures.start
            csr = _pointers(count, 1), columns.astype(np.int32), np.full(count, self._scale)
            sizes = [(n, n * size) for n in (count, self._pressure.getSize())]
            self._taken = PETSc.Mat().createAIJ(
                tuple(zip(*sizes, strict=True)), csr=csr, comm=self._comm
            )
        return self._taken


def _block_diagonal(like: PETSc.Vec, blocks: FloatArray) -> PETSc.Mat:
    """Return the matrix with square blocks, shape (blocks, n, n), for vectors like a given one."""
    count, n, _ = blocks.shape
    first, _ = like.getOwnershipRange()
    start = np.arange(first, first + count * n, n)[:, None, None]
    columns = np.broadcast_to(start + np.arange(n), blocks.shape).ravel().astype(np.int32)
    csr = _pointers(count * n, n), columns, blocks.ravel()
    return PETSc.Mat().createAIJ((like.getSizes(),) * 2, csr=csr, comm=like.getComm())


def _pointers(rows: int, each: int) -> npt.NDArray[np.int32]:
    """Return where the rows of a matrix begin that has the same number of entries in each."""
    return np.arange(0, rows * each + 1, each, dtype=np.int32)


def _tangential(
    planes: Sequence[FixedDirections], owned: int, dimension: int
) -> tuple[npt.NDArray[np.intp], FloatArray]:
    """Return the owned nodes on planes and projectors on the directions that all planes allow."""
    everywhere = np.zeros((owned, len(planes), dimension))
    for k, plane in enumerate(planes):
        everywhere[plane.nodes, k] = plane.directions
    nodes = np.flatnonzero(everywhere.any(axis=(1, 2)))
    normals = everywhere[nodes]
    return nodes, np.eye(dimension) - np.linalg.pinv(normals, rcond=1e-6) @ normals
