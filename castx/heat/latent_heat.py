"""Latent heat inside cells: what its storage differs from that of nodes where mush ends in a cell.

A node stores the heat of its volume by its own temperature. Where an alloy freezes within a few
kelvins its volume does so at once: the temperatures of a wall fall by fits and starts. Inside cells
the temperature is linear, and the solid fraction that belongs to it stores

    D_i = −ρL ∫ φ_i (f_s(T_h) − Σ_j φ_j f_s(T_j)) dV

beside V_i H_i. It is nothing where f_s is linear in a cell, whose temperatures pass no kink of
f_s(T), and ΣD_i makes the heat of a cell that of its temperatures. The metal must not freeze at a
plateau, where a temperature has many fractions.
"""

from __future__ import annotations

from collections import deque
from functools import reduce

import numpy as np
from dolfinx.la import MatrixCSR
from scipy.sparse import csr_matrix

from castx.arrays import FloatArray, IntArray
from castx.domain.cell_samples import sample_rule, sample_volumes
from castx.domain.measures import nodal_sum
from castx.domain.mesh import BodyMesh
from castx.materials.enthalpy import EnthalpyCurve

STRAIGHT = 1e-9
"""Change of df_s/dT at a knot of a curve, over the largest slope, that is rounding and no kink."""

KNOWN_STATES = 4
"""States whose storage is kept: the start of a step, ends of sub-steps, and the present one."""


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
        self._body, self.latent, self._matrix = body, latent, matrix
        rule = sample_rule(body.kind)
        self._shapes = rule.shapes
        samples, corners = rule.shapes.shape
        products = rule.shapes[:, :, None] * rule.shapes[:, None, :]
        self._products = products.reshape(samples, corners * corners)
        owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
        self._corners: IntArray = body.nodes.dofmap.list[:owned]
        self._volumes = sample_volumes(body, model, rule)[:owned]
        self._owned = body.nodes.dofmap.index_map.size_local
        self._places = self._find_places()
        self._kinks, self._fractions = kinks(curve)
        rates = np.diff(self._fractions) / np.diff(self._kinks)
        self._rates = np.concatenate(([0.0], rates, [0.0]))
        self._known: deque[tuple[FloatArray, FloatArray]] = deque(maxlen=KNOWN_STATES)

    def _find_places(self) -> IntArray:
        """Return the places of the entries of the cells in the matrix, (cells, corners²)."""
        indices, pointers = self._matrix.indices, self._matrix.indptr
        shape = len(pointers) - 1, int(indices.max(initial=0)) + 1
        numbers = csr_matrix((np.arange(1, len(indices) + 1), indices, pointers), shape=shape)
        count = self._corners.shape[1]
        if not len(self._corners):
            return np.empty((0, count * count), dtype=np.int32)
        rows = np.repeat(self._corners, count, axis=1).ravel()
        columns = np.tile(self._corners, count).ravel()
        found = np.asarray(numbers[rows, columns]).ravel() - 1
        return np.asarray(found, dtype=np.int32).reshape(len(self._corners), count * count)

    def _bent(self, temperature: FloatArray) -> IntArray:
        """Return the cells of which the temperature passes a kink of the solid fraction."""
        pieces = np.searchsorted(self._kinks, temperature, side="right").astype(np.int32)
        at_corners = [pieces[corner] for corner in self._corners.T]
        coldest, hottest = reduce(np.minimum, at_corners), reduce(np.maximum, at_corners)
        return np.flatnonzero(coldest < hottest).astype(np.int32)

    def stored(self, temperature: FloatArray, solid_fraction: FloatArray) -> FloatArray:
        """Return D of the owned nodes [J], shape (owned,), found anew unless known; collective.

        Args:
            temperature: of the local nodes [°C], shape (nodes,).
            solid_fraction: of the local nodes, likewise.
        """
        here = [np.array_equal(temperature, state) for state, _ in self._known]
        there = np.flatnonzero(np.all(self._body.mesh.comm.allgather(here), axis=0))
        if len(there):
            return self._known[there[0]][1]
        return self.found(temperature, solid_fraction)

    def found(self, temperature: FloatArray, solid_fraction: FloatArray) -> FloatArray:
        """Return D of the owned nodes of a state that has just come about, as `stored` does."""
        cells = self._bent(temperature)
        corners = self._corners[cells]
        more = np.interp(temperature[corners] @ self._shapes.T, self._kinks, self._fractions)
        more -= solid_fraction[corners] @ self._shapes.T
        more *= self._volumes[cells]
        parts = -self.latent * (more @ self._shapes)
        sums = np.bincount(corners.ravel(), parts.ravel(), minlength=len(temperature))
        found = np.asarray(nodal_sum(self._body, sums)[: self._owned])
        found.setflags(write=False)
        self._known.append((temperature.copy(), found))
        return found

    def slopes(
        self, temperature: FloatArray, temperature_slope: FloatArray, fraction_slope: FloatArray
    ) -> FloatArray:
        """Return the derivatives of D, entry by entry of the conduction of owned rows; collective.

        Args:
            temperature: of the local nodes [°C], shape (nodes,).
            temperature_slope: over the unknowns of the columns, shape (columns,).
            fraction_slope: of the solid fraction, likewise.
        """
        cells = self._bent(temperature)
        corners, volumes = self._corners[cells], self._volumes[cells]
        inside = temperature[corners] @ self._shapes.T
        steep = self._rates[np.searchsorted(self._kinks, inside, side="right")] * volumes
        count = corners.shape[1]
        columns = np.tile(corners, count)
        blocks = (steep @ self._products) * temperature_slope[columns]
        blocks -= (volumes @ self._products) * fraction_slope[columns]
        data = self._matrix.data
        data[:] = np.bincount(self._places[cells].ravel(), blocks.ravel(), minlength=len(data))
        self._matrix.scatter_reverse()
        return np.asarray(-self.latent * data[: self._matrix.indptr[self._owned]])


def kinks(curve: EnthalpyCurve) -> tuple[FloatArray, FloatArray]:
    """Return the kinks of f_s(T), shape (kinks,) [°C], and f_s there, likewise.

    Knots of the curve that only the heat capacity needs are left out.

    Args:
        curve: of a metal that freezes, without a plateau.
    """
    rates = np.diff(curve.fractions) / np.diff(curve.temperatures)
    bends = np.abs(np.diff(rates)) > STRAIGHT * np.abs(rates).max()
    at = np.flatnonzero(bends) + 1
    return curve.temperatures[at], curve.fractions[at]
