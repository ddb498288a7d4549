"""Integration points of a body: functions, weights, and interpolation from nodes and cells."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import basix.ufl
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain import compat
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics


def quadrature_degree(body: BodyMesh, model: str, formulation: str) -> int:
    """Return the degree to which the terms with the deviatoric stress are integrated.

    Strains of linear simplices are constant. In plane stress the pressure enters the strain, so
    that both must be integrated alike. Strains of quadratic displacements are linear, and the
    radius of axisymmetric bodies multiplies and divides them.
    """
    if formulation == "taylor-hood":
        return 4 if model == "axisymmetric" else 2
    if body.kind.name not in ("triangle", "tetrahedron"):
        return 2
    return 2 if model == "plane-stress" and formulation == "mixed" else 1


class IntegrationPoints:
    """The points of all local cells, one cell after the other.

    Args:
        body: mesh of the body.
        model: geometric model.
        degree: of the quadrature rule.
    """

    def __init__(self, body: BodyMesh, model: str, degree: int) -> None:
        self._body, self.kind, self.model = body, body.kind, model
        self.numbering, self.node_numbering = body.cell_numbering, body.node_numbering
        self.cell_nodes = body.nodes.dofmap.list
        self.cells = len(self.cell_nodes)
        self._all_cells = np.arange(self.cells, dtype=np.int32)
        self.degree = degree
        self.places = compat.interpolation_points(self._space(()))
        self.per_cell = len(self.places)
        self.components = 6 if model == "3d" else 4
        self._shapes = self.kind.shape_functions(self.places)[0]
        rule = self.kind.quadrature(degree)[1]
        scale = abs(ufl.JacobianDeterminant(body.mesh))
        volumes = rule * self._by_points(self.evaluate(self.expression(scale)))
        weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
        weighted = self._by_points(self.evaluate(self.expression(scale * weight)))
        self.weights: FloatArray = rule * weighted
        """Weights of the points [m³], shape (cells, points per cell)."""
        self.sizes: FloatArray = volumes.sum(axis=1) ** (1.0 / body.mesh.geometry.dim)
        """Sizes of the cells [m], shape (cells,)."""

    @property
    def owned_cells(self) -> int:
        """Number of local cells that are no ghosts; they come first."""
        return int(self._body.mesh.topology.index_map(self._body.mesh.topology.dim).size_local)

    @property
    def count(self) -> int:
        """Number of local points."""
        return self.cells * self.per_cell

    def _space(self, shape: tuple[int, ...]) -> fem.FunctionSpace:
        element = basix.ufl.quadrature_element(
            self._body.mesh.basix_cell(), value_shape=shape, degree=self.degree
        )
        return fem.functionspace(self._body.mesh, element)

    def scalar(self) -> fem.Function:
        """Return a function with a number at each point."""
        return fem.Function(self._space(()))

    def tensor(self) -> fem.Function:
        """Return a function with the components of a symmetric tensor at each point."""
        return fem.Function(self._space((self.components,)))

    def expression(self, expression: Any) -> fem.Expression:
        """Return a UFL expression compiled for the points."""
        return fem.Expression(expression, self.places)

    def evaluate(self, expression: fem.Expression) -> FloatArray:
        """Return an expression at all points, shape (points, components)."""
        values = expression.eval(self._body.mesh, self._all_cells)
        return np.asarray(values).reshape(self.count, expression.value_size)

    @property
    def volumes(self) -> int:
        """Number of local places that have a volume of their own: the cells."""
        return self.cells

    def volume_function(self, cells: fem.FunctionSpace) -> fem.Function:
        """Return a function with a number at each place of a volume.

        Args:
            cells: functions constant in each cell.
        """
        return fem.Function(cells)

    def volume_means(self, values: FloatArray, weight: FloatArray | None = None) -> FloatArray:
        """Return weighted means Σ W_v a_v/Σ W_v over the corners, zero without any W, (volumes,).

        Args:
            values: a_v of the nodes, shape (nodes,).
            weight: W_v of the nodes, shape (nodes,); None: 1.
        """
        corners = self.cell_nodes
        if weight is None:
            return np.asarray(np.mean(values[corners], axis=1))
        weighted, total = (weight * values)[corners].sum(axis=1), weight[corners].sum(axis=1)
        return part_of_whole(weighted, total)

    def from_volumes(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return values of the volumes at the points, shape (points,)."""
        return self.from_cells(values)

    def to_volumes(self, values: FloatArray) -> FloatArray:
        """Return the means of values at the points over the volumes, shape (volumes,)."""
        return self.cell_means(values)

    def cells_to_volumes(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return cell values at the volumes, shape (volumes,)."""
        return values

    def volumes_to_cells(self, values: FloatArray) -> FloatArray:
        """Return the means of values of the volumes over the cells, shape (cells,)."""
        return values

    def volumes_by_cell(self, values: FloatArray) -> FloatArray:
        """Return values of the volumes with one row for each cell."""
        return values

    def from_nodes(self, values: FloatArray, cells: IntArray | None = None) -> FloatArray:
        """Return nodal values interpolated to the points, shape (points,), or to those of cells."""
        corners = self.cell_nodes if cells is None else self.cell_nodes[cells]
        return np.asarray(values[corners] @ self._shapes.T).ravel()

    def from_cells(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return cell values at the points, shape (points,)."""
        return np.repeat(values, self.per_cell)

    def by_cell(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return values of points or cells with one row for each cell."""
        return values.reshape(self.cells, values.size // max(self.cells, 1))

    def _by_points(self, values: FloatArray) -> FloatArray:
        """Return numbers at the points as rows of the cells, of which a rank may have none."""
        return values.reshape(self.cells, self.per_cell)

    def cell_means(self, values: FloatArray) -> FloatArray:
        """Return means over the cells by weight, shape (cells,) or (cells, components)."""
        if self.per_cell == 1:
            return values
        parts = values.reshape(self.cells, self.per_cell, *values.shape[1:])
        shares = self.weights / self.weights.sum(axis=1, keepdims=True)
        return np.asarray(np.einsum("cp,cp...->c...", shares, parts))

    def cell_tensors(self, values: FloatArray) -> FloatArray:
        """Return means over the cells of tensors at the points, shape (cells, 6)."""
        means = self.cell_means(values)
        return np.pad(means, ((0, 0), (0, 6 - means.shape[1])))

    def integrals(self, values: Sequence[FloatArray]) -> FloatArray:
        """Return ∫ v over the body of arrays of nodal values, shape (arrays,); collective."""
        return self.summed(np.array([self._own_weights @ each for each in values]))

    def summed(self, local: FloatArray) -> FloatArray:
        """Return sums over all ranks; collective."""
        return np.asarray(self._body.mesh.comm.allreduce(local))

    def means_around_nodes(self, values: FloatArray) -> FloatArray:
        """Return means by weight over the cells around each node, (nodes,); collective.

        Args:
            values: of the cells, shape (cells,).
        """
        return self.vectors_around_nodes(self.from_cells(values)[:, None])[:, 0]

    @cached_property
    def _own_weights(self) -> FloatArray:
        """∫ N over the cells of this rank, shape (nodes,)."""
        return self.to_nodes(np.ones(self.count), len(self.node_numbering.numbers))

    def shared_out(self, values: FloatArray, some: BoolArray) -> FloatArray:
        """Return values of some volumes as means over those of them near, (volumes,); collective.

        Args:
            values: of the volumes, shape (volumes,).
            some: which of them give and take, shape (volumes,); others have none.
        """
        both = np.column_stack([np.where(some, values, 0.0), some.astype(float)])
        part, whole = self.vectors_around_nodes(np.repeat(both, self.per_cell, axis=0)).T
        means = np.divide(part, whole, out=np.zeros_like(part), where=whole > 0)
        return np.where(some, means[self.cell_nodes].mean(axis=1), 0.0)

    def vectors_around_nodes(self, values: FloatArray) -> FloatArray:
        """Return means by weight of vectors round each node, (nodes, gdim); collective.

        Args:
            values: at the points, shape (points, gdim).
        """
        weights = self._own_weights
        here = [self.to_nodes(component, len(weights)) for component in values.T]
        sums = nodal_sum(self._body, np.column_stack([*here, weights]))
        return np.asarray(sums[:, :-1] / sums[:, -1:])

    def gradients(self, values: FloatArray) -> FloatArray:
        """Return gradients of nodal values at the points, shape (points, gdim).

        Args:
            values: of the nodes, shape (nodes,).
        """
        function, gradient = self._gradient
        function.x.array[:] = values
        return self.evaluate(gradient)

    @cached_property
    def _gradient(self) -> tuple[fem.Function, fem.Expression]:
        """A function with values at the nodes, and its gradient at the points."""
        function = fem.Function(self._body.nodes)
        return function, self.expression(ufl.grad(function))

    def to_nodes(self, values: FloatArray, nodes: int) -> FloatArray:
        """Return ∫ N v over the owned cells by their points, shape (nodes,)."""
        return self._summed_at_nodes((self._by_points(values) * self.weights) @ self._shapes, nodes)

    def shared_to_nodes(self, values: FloatArray, nodes: int) -> FloatArray:
        """Return ∫ N v over the owned cells, of v that is even in each cell that has one point.

        With the one point of a triangle at its centre all its nodes would have as much. Round an
        axis those outside have more: of a cell at the axis ∫ N dV there is three quarters of that.

        Args:
            values: v at the points, shape (points,).
            nodes: number of local nodes.

        Returns:
            Shape (nodes,).
        """
        if self.per_cell > 1:
            return self.to_nodes(values, nodes)
        return self._summed_at_nodes(values[:, None] * self._corner_volumes, nodes)

    @cached_property
    def _corner_volumes(self) -> FloatArray:
        """∫ N dV over each cell [m³], shape (cells, corners)."""
        places, rule = self.kind.quadrature(2)
        mesh = self._body.mesh
        weight = kinematics.weight(self.model, ufl.SpatialCoordinate(mesh))
        scale = fem.Expression(abs(ufl.JacobianDeterminant(mesh)) * weight, places)
        here = np.asarray(scale.eval(mesh, self._all_cells)).reshape(self.cells, len(places))
        return np.asarray((rule * here) @ self.kind.shape_functions(places)[0])

    def _summed_at_nodes(self, of_corners: FloatArray, nodes: int) -> FloatArray:
        """Return sums over the owned cells round nodes, shape (nodes,)."""
        owned = self.owned_cells
        corners, values = self.cell_nodes[:owned].ravel(), of_corners[:owned].ravel()
        return np.asarray(np.bincount(corners, weights=values, minlength=nodes)[:nodes])


class VolumePoints(IntegrationPoints):
    """Points each of which has a volume of its own, where the dilatation varies in a cell."""

    @property
    def volumes(self) -> int:
        """Number of local places that have a volume of their own: the points."""
        return self.count

    def volume_function(self, cells: fem.FunctionSpace) -> fem.Function:
        """Return a function with a number at each point."""
        return self.scalar()

    def volume_means(self, values: FloatArray, weight: FloatArray | None = None) -> FloatArray:
        """Return nodal values at the points, as means over the solid there, shape (points,)."""
        if weight is None:
            return self.from_nodes(values)
        return part_of_whole(self.from_nodes(weight * values), self.from_nodes(weight))

    def from_volumes(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return the values as they are."""
        return values

    def to_volumes(self, values: FloatArray) -> FloatArray:
        """Return the values as they are."""
        return values

    def cells_to_volumes(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return cell values at the points, shape (points,)."""
        return self.from_cells(values)

    def volumes_to_cells(self, values: FloatArray) -> FloatArray:
        """Return means over the cells by weight, shape (cells,)."""
        return self.cell_means(values)

    def shared_out(self, values: FloatArray, some: BoolArray) -> FloatArray:
        """Return the values, zero elsewhere: volumes of one layer lie alike in their cells."""
        return np.where(some, values, 0.0)

    def volumes_by_cell(self, values: FloatArray) -> FloatArray:
        """Return values of the points with one row for each cell."""
        return self.by_cell(values)


def part_of_whole(part: FloatArray, total: FloatArray) -> FloatArray:
    """Return parts of totals, zero where there is nothing in all."""
    return np.asarray(np.divide(part, total, out=np.zeros_like(total), where=total > 0))
