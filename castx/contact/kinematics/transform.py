"""Change of unknowns that turns every constraint on a node into a Dirichlet condition.

At each node the displacement is expressed in rows of its own: directions with a prescribed value,
the motion relative to a facing node along its normal (condensed contact), and what completes them
to a basis. The unknowns v and the displacements u of all bodies are related by the square,
invertible v = R u and u = P v, which do not depend on which pairs are closed:

    v_k = n_k · (u_secondary - u_primary)     contact: the change of the gap, with mid-sides
    v_k = e · u                               prescribed direction
    v_k = e · (u - u_first)                   nodes of a surface that move equally: always zero
    v_k = w - w_first                         the axial strain of a body: always zero

A closed pair or a prescribed displacement is then a Dirichlet condition on one entry of v, and the
contact force is the residual of that row of Pᵀ r(P v).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.contact.kinematics.basis import BasisMatrices
from castx.contact.kinematics.pair_rows import MidsideMotions, PairRows, Prescribed
from castx.contact.kinematics.placement import RowPlacement
from castx.contact.kinematics.rows import InterfaceRows, Treatment
from castx.mechanics.fixed_directions import ZERO, FixedDirections
from castx.solvers.layout import Layout


class ConstraintTransform:
    """The change of unknowns of all bodies and the entries that conditions fix.

    Attributes:
        layout: numbering of the displacements (and pressures) of all bodies, and of v.
        dimension: number of displacement components.
        P: u = P v.
        R: v = R u.
        coupling: of which row k is what v_k has of the motion of facing points, in unknowns v; None
            where no pair is relative.
        prescribed: entries of v that conditions prescribe.
        interfaces: rows of the pairs of each interface.

    Args:
        layout: numbering of the displacements (and pressures) of all bodies.
        body_names: names of the bodies and of their mid-sides in the order of the layout.
        dimension: number of displacement components.
        fixed: fixed directions of each of them.
        interfaces: the interfaces with contact; a primary body without unknowns is rigid.
        uniform: of each body, the component of its unknowns that is the same at all nodes, or None.

    Raises:
        CaseError: a uniform surface or a pair whose motion a condition prescribes.
    """

    def __init__(
        self,
        layout: Layout,
        body_names: Sequence[str],
        dimension: int,
        fixed: Sequence[Sequence[FixedDirections]],
        interfaces: Sequence[InterfaceRows],
        uniform: Sequence[int | None] = (),
    ) -> None:
        self.layout, self.dimension, self._names = layout, dimension, list(body_names)
        placement = RowPlacement(layout, body_names, dimension, fixed, interfaces)
        self.prescribed, self.interfaces = placement.prescribed, placement.interfaces
        basis = BasisMatrices(layout, dimension, placement.rows)
        for motion in placement.equal_motions:
            self.prescribed.append(Prescribed(basis.tie(motion), ZERO))
            if motion.tied_by is not None and motion.tied_by.primary in self._names:
                basis.follow(motion, self._names.index(motion.tied_by.primary))
        for b, k in enumerate(uniform):
            if k is not None:
                self.prescribed.append(Prescribed(basis.tie_component(b, k), ZERO))
        for interface in self.interfaces:
            if interface.treatment is Treatment.UNCHANGED:
                continue
            of_midsides = interface.midsides_in_gaps()
            self._make_relative(basis, interface, interface.local, interface.normals, of_midsides)
            for k in range(interface.tangents.shape[1]):
                along = interface.tangents[:, k]
                of_midsides = interface.midsides_along(along)
                local = interface.tangent_local[:, k]
                self._make_relative(basis, interface, local, along, of_midsides)
        self.R, self.P = basis.finish()
        self.coupling = basis.coupling(self.P)

    def _make_relative(
        self,
        basis: BasisMatrices,
        interface: PairRows,
        local: IntArray,
        directions: FloatArray,
        of_midsides: Iterable[MidsideMotions],
    ) -> None:
        pairs, free = interface.pairs, local >= 0
        b, own = self._names.index(pairs.secondary), pairs.secondary_local[interface.index]
        nodes, weights = pairs.partners
        chosen = interface.index[free]
        if pairs.primary in self._names:
            other = self._names.index(pairs.primary)
            partners = nodes[chosen], weights[chosen]
            basis.make_relative(b, own[free], local[free], directions[free], other, partners)
        for name, rows, midsides, shares, along in of_midsides:
            there = free[rows]
            rows, other = rows[there], self._names.index(name)
            facing = midsides[there, None], -shares[there, None]
            basis.make_relative(b, own[rows], local[rows], along[there], other, facing)

    def displacements(self, v: FloatArray) -> FloatArray:
        """Return u = P v of owned unknowns v; collective."""
        return self._product(self.P.mult, v)

    def unknowns(self, u: FloatArray) -> FloatArray:
        """Return v = R u of owned displacements and pressures u; collective."""
        return self._product(self.R.mult, u)

    def forces_on_unknowns(self, f: FloatArray) -> FloatArray:
        """Return Pᵀf, conjugate to v, of owned forces f on the nodes; collective."""
        return self._product(self.P.multTranspose, f)

    def forces_on_nodes(self, f: FloatArray) -> FloatArray:
        """Return Rᵀf, conjugate to u, of owned forces f that are conjugate to v; collective."""
        return self._product(self.R.multTranspose, f)

    def _product(
        self, product: Callable[[PETSc.Vec, PETSc.Vec], None], values: FloatArray
    ) -> FloatArray:
        x, y = self.layout.create_vector(), self.layout.create_vector()
        x.array[:] = values
        product(x, y)
        image = y.array_r.copy()
        x.destroy()
        y.destroy()
        return np.asarray(image)

    def facing(self) -> BoolArray:
        """Return a mask of the owned unknowns at nodes of pairs; collective."""
        marker = self.layout.create_vector()
        for interface in self.interfaces:
            pairs = interface.pairs
            facing = (pairs.primary, pairs.partners[0].ravel())
            for name, nodes in ((pairs.secondary, pairs.secondary_nodes), facing):
                b = self._names.index(name) if name in self._names else -1
                for k in range(self.layout.block_sizes[b] if b >= 0 else 0):
                    numbers = self.layout.dofs(b, nodes, k)
                    ones = np.ones(len(numbers))
                    marker.setValues(numbers, ones, PETSc.InsertMode.ADD_VALUES)
        marker.assemble()
        found = marker.array_r > 0
        marker.destroy()
        return np.asarray(found)
