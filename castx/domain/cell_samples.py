"""Samples inside cells: places, and the parts of the nodes and of the volume there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.cell_kinds import CellKind
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics

DEGREES = {"triangle": 8, "tetrahedron": 6, "quadrilateral": 7, "hexahedron": 5}
"""Degrees of the rules of which the samples are the points."""

SHARE_DEGREES = {**DEGREES, "quadrilateral": 15, "hexahedron": 7}
"""The same for the share that bears, which passes from 0 to 1 within a few kelvins.

A skin is as thin in its first moment as the nearest sample, and contracts with the logarithm of
that. Of a product rule few samples lie behind each other: eight across a quadrilateral halve the
error that four leave; heat hardly hangs on them.
"""


class SampleRule(NamedTuple):
    """Samples of a cell.

    Attributes:
        places: in the reference cell, shape (samples, tdim).
        weights: in it, shape (samples,).
        shapes: linear shape functions there, shape (samples, corners).
    """

    places: FloatArray
    weights: FloatArray
    shapes: FloatArray

    @property
    def shares(self) -> FloatArray:
        """Shares of the volume of the reference cell, shape (samples,)."""
        return np.asarray(self.weights / self.weights.sum())


def sample_rule(kind: CellKind, degrees: Mapping[str, int] = DEGREES) -> SampleRule:
    """Return the samples of cells of a kind, by degrees of the rules of all kinds."""
    places, weights = kind.quadrature(degrees[kind.name])
    return SampleRule(places, weights, kind.shape_functions(places)[0])


def sample_volumes(body: BodyMesh, model: str, rule: SampleRule) -> FloatArray:
    """Return the volumes of the samples of the local cells [m³], shape (cells, samples).

    Args:
        body: mesh of the body.
        model: geometric model.
        rule: samples of its cells.
    """
    weight = kinematics.weight(model, ufl.SpatialCoordinate(body.mesh))
    scale = abs(ufl.JacobianDeterminant(body.mesh)) * weight
    cells = np.arange(len(body.nodes.dofmap.list), dtype=np.int32)
    values = fem.Expression(scale, rule.places).eval(body.mesh, cells)
    return np.asarray(rule.weights * np.reshape(values, (len(cells), len(rule.weights))))
