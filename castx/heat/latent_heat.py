"""Latent heat inside cells: what its storage differs from that of nodes where mush ends in a cell.

A node stores the heat of its volume by its own temperature. Where an alloy freezes within a few
kelvins its volume does so at once: the temperatures of a wall fall by fits and starts. Inside cells
the temperature is linear, and the solid fraction that belongs to it stores

    D_i = −ρL ∫ φ_i (f_s(T_h) − Σ_j φ_j f_s(T_j)) dV

beside V_i H_i. It is nothing where no metal freezes, and ΣD_i makes the heat of a cell that of its
temperatures. The metal must not freeze at a plateau, where a temperature has many fractions.
"""

from __future__ import annotations

import numpy as np
from dolfinx.la import MatrixCSR
from scipy.sparse import csr_matrix

from castx.arrays import FloatArray, IntArray
from castx.domain.cell_samples import sample_rule, sample_volumes
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.materials.enthalpy import EnthalpyCurve


class LatentHeat:
    """Latent heat inside the cells of a body, beside that of its nodes.

    Attributes:
        latent: ρL [J/m³].

    Args:
        body: mesh of the body.
        model: geometric model.
        curve: of its material, without a plateau.
        latent: ρL [J/m³].
        matrix: with the pattern of the conduction, whose values are overwritten.
    """

    def __init__(
        self, body: BodyMesh, model: str, curve: EnthalpyCurve, latent: float, matrix: MatrixCSR
    ) -> None:
        self._body, self._curve, self.latent, self._matrix = body, curve, latent, matrix
        rule = sample_rule(body.kind)
        self._shapes = rule.shapes
        owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
        self._corners: IntArray = body.nodes.dofmap.list[:owned]
        self._volumes = sample_volumes(body, model, rule)[:owned]
        self._owned = body.nodes.dofmap.index_map.size_local
        self._places = self._find_places()
        solid, liquid = np.flatnonzero(curve.fractions >= 1.0), np.flatnonzero(curve.fractions <= 0)
        self._range = curve.temperatures[solid[-1]], curve.temperatures[liquid[0]]

    def _find_places(self) -> IntArray:
        """Return the places of the entries of the cells in the matrix, (cells, corners²)."""
        indices, pointers = self._matrix.indices, self._matrix.indptr
        shape = len(pointers) - 1, int(indices.max(initial=0)) + 1
        numbers = csr_matrix((np.arange(1, len(indices) + 1), indices, pointers), shape=shape)
        count = self._corners.shape[1]
        rows = np.repeat(self._corners, count, axis=1).ravel()
        columns = np.tile(self._corners, count).ravel()
        found = np.asarray(numbers[rows, columns]).ravel() - 1
        return np.asarray(found, dtype=np.int32).reshape(len(self._corners), count * count)

    def _freezing(self, temperature: FloatArray) -> IntArray:
        """Return the cells in which metal freezes somewhere."""
        corners = temperature[self._corners]
        solidus, liquidus = self._range
        cells = (corners.min(axis=1) < liquidus) & (corners.max(axis=1) > solidus)
        return np.flatnonzero(cells).astype(np.int32)

    def stored(self, temperature: FloatArray, solid_fraction: FloatArray) -> FloatArray:
        """Return D of the owned nodes [J], shape (owned,); collective.

        Args:
            temperature: of the local nodes [°C], shape (nodes,).
            solid_fraction: of the local nodes, likewise.
        """
        cells = self._freezing(temperature)
        corners = self._corners[cells]
        inside = temperature[corners] @ self._shapes.T
        fraction = np.interp(inside, self._curve.temperatures, self._curve.fractions)
        more = (fraction - solid_fraction[corners] @ self._shapes.T) * self._volumes[cells]
        sums = np.zeros(len(temperature))
        np.add.at(sums, corners, -self.latent * (more @ self._shapes))
        return np.asarray(nodal_sum(self._body, sums)[: self._owned])

    def slopes(
        self, temperature: FloatArray, temperature_slope: FloatArray, fraction_slope: FloatArray
    ) -> FloatArray:
        """Return the derivatives of D, entry by entry of the conduction of owned rows; collective.

        Args:
            temperature: of the local nodes [°C], shape (nodes,).
            temperature_slope: over the unknowns of the columns, shape (columns,).
            fraction_slope: of the solid fraction, likewise.
        """
        cells = self._freezing(temperature)
        inside = temperature[self._corners[cells]] @ self._shapes.T
        steep = self._fraction_slope(inside) * self._volumes[cells]
        by_temperature = self._assembled(cells, steep)
        by_fraction = self._assembled(cells, self._volumes[cells])
        columns = self._matrix.indices[: len(by_temperature)]
        return -self.latent * (
            by_temperature * temperature_slope[columns] - by_fraction * fraction_slope[columns]
        )

    def _fraction_slope(self, temperature: FloatArray) -> FloatArray:
        """Return df_s/dT at temperatures [1/K]."""
        knots, fractions = self._curve.temperatures, self._curve.fractions
        start = np.clip(np.searchsorted(knots, temperature, side="right") - 1, 0, len(knots) - 2)
        return np.asarray(np.diff(fractions)[start] / np.diff(knots)[start])

    def _assembled(self, cells: IntArray, weights: FloatArray) -> FloatArray:
        """Return ∫ φ_i φ_j c over cells for weights c dV at their samples, by owned rows."""
        blocks = np.einsum("cs,si,sj->cij", weights, self._shapes, self._shapes, optimize=True)
        data = self._matrix.data
        data[:] = 0.0
        np.add.at(data, self._places[cells].ravel(), blocks.ravel())
        self._matrix.scatter_reverse()
        return np.array(data[: self._matrix.indptr[self._owned]])
