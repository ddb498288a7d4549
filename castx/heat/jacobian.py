"""Sparse Jacobian of the nodal balances of heat, with the blocks of bodies, pairs and groups."""

from __future__ import annotations

from collections.abc import Sequence

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray, IntArray
from castx.heat.body import ThermalBody
from castx.heat.interface import PairExchange
from castx.heat.perfect_contact import NodeGroups
from castx.solvers.layout import Layout


class HeatJacobian:
    """One AIJ matrix over the nodes of all bodies, with the pattern of the first assembly.

    Rows and columns of nodes in perfect contact add up at the unknown of their group.

    Args:
        layout: numbering of the nodes of all bodies.
        bodies: in the order of the layout.
        exchanges: interfaces under a law.
        groups: of nodes with one unknown; None: there are none.
    """

    def __init__(
        self,
        layout: Layout,
        bodies: Sequence[ThermalBody],
        exchanges: Sequence[PairExchange],
        groups: NodeGroups | None,
    ) -> None:
        self._layout = layout
        self._groups = groups
        self._bodies = [self._body_block(number, body) for number, body in enumerate(bodies)]
        self._pairs = [self._pair_block(exchange) for exchange in exchanges]
        self.matrix = self._create_matrix()

    def _body_block(
        self, number: int, body: ThermalBody
    ) -> tuple[ThermalBody, slice, IntArray, IntArray, IntArray, npt.NDArray[np.intp]]:
        """Return body, part of the layout, row pointers, columns, rows, places of the diagonal."""
        matrix = body.conduction
        columns = self._unknowns(self._layout.dofs(number, body.column_nodes, 0))
        owner = np.repeat(np.arange(body.owned), np.diff(matrix.indptr))
        return (
            body,
            self._layout.local_slice(number),
            matrix.indptr.astype(PETSc.IntType),
            columns[matrix.indices],
            columns[: body.owned],
            np.flatnonzero(matrix.indices == owner),
        )

    def _pair_block(
        self, exchange: PairExchange
    ) -> tuple[PairExchange, IntArray, IntArray, IntArray]:
        """Return exchange, row pointers, columns, rows: secondary and primary of each pair."""
        dofs = np.column_stack((exchange.secondary_dofs, exchange.primary_dofs))
        rows = self._unknowns(dofs.ravel()).reshape(dofs.shape)
        count = rows.shape[1]
        columns = np.repeat(rows[:, None, :], count, axis=1).ravel()
        pointers = np.arange(0, len(columns) + 1, count, dtype=PETSc.IntType)
        return exchange, pointers, columns, rows.ravel()

    def _unknowns(self, dofs: IntArray) -> IntArray:
        return dofs if self._groups is None else self._groups.unknowns(dofs)

    def _create_matrix(self) -> PETSc.Mat:
        size = (self._layout.size_local, self._layout.size_global)
        matrix = PETSc.Mat().create(self._layout.comm)
        matrix.setSizes((size, size))
        matrix.setType(PETSc.Mat.Type.AIJ)
        matrix.setUp()
        matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        add = PETSc.InsertMode.ADD
        # Idle rows get no entry from the blocks, but a direct solver wants their diagonal.
        start, end = matrix.getOwnershipRange()
        rows = np.arange(start, end, dtype=PETSc.IntType)
        pointers = np.arange(len(rows) + 1, dtype=PETSc.IntType)
        matrix.setValuesIJV(pointers, rows, np.zeros(len(rows)), add, rows)
        for _, _, pointers, columns, rows, _ in self._bodies:
            matrix.setValuesIJV(pointers, columns, np.zeros(len(columns)), add, rows)
        for _, pointers, columns, rows in self._pairs:
            matrix.setValuesIJV(pointers, columns, np.zeros(len(columns)), add, rows)
        matrix.assemble()
        matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_LOCATION_ERR, True)
        return matrix

    def assemble(
        self,
        diagonal: FloatArray,
        temperature_slope: PETSc.Vec,
        inside: Sequence[FloatArray | None],
        step: float,
    ) -> None:
        """Assemble at the present state of the bodies.

        Args:
            diagonal: what only the node itself acts on, in the layout [W m³/J].
            temperature_slope: derivative of each node's temperature over its unknown [K m³/J].
            inside: derivatives of the latent heat inside the cells of each body [m³]; or none.
            step: Δt [s].
        """
        add = PETSc.InsertMode.ADD
        slopes = temperature_slope.array_r
        self.matrix.zeroEntries()
        for (body, part, pointers, columns, rows, places), latent in zip(
            self._bodies, inside, strict=True
        ):
            values = body.conduction_slope(slopes[part])
            if latent is not None:
                values += latent / step
            values[places] += diagonal[part]
            self.matrix.setValuesIJV(pointers, columns, values, add, rows)
        for exchange, pointers, columns, rows in self._pairs:
            values = exchange.derivatives(temperature_slope).ravel()
            self.matrix.setValuesIJV(pointers, columns, values, add, rows)
        self.matrix.assemble()

    def destroy(self) -> None:
        """Free the matrix."""
        self.matrix.destroy()
