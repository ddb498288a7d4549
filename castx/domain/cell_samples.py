"""Samples inside cells: places, and the parts of the nodes and of the volume there."""

from __future__ import annotations

from typing import NamedTuple

import basix
import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.cell_kinds import CellKind
from castx.domain.mesh import BodyMesh
from castx.forms import kinematics

DEGREES = {"triangle": 8, "tetrahedron": 6, "quadrilateral": 7, "hexahedron": 5}
"""Degrees of the rules of which the samples are the points."""


class SampleRule(NamedTuple):
    """Samples of a cell.

    Attributes:
        places: in the reference cell, shape (samples, tdim).
        shares: of its volume, shape (samples,).
        shapes: linear shape functions there, shape (samples, corners).
    """

    places: FloatArray
    shares: FloatArray
    shapes: FloatArray


def sample_rule(kind: CellKind) -> SampleRule:
    """Return the samples of cells of a kind."""
    cell = getattr(basix.CellType, kind.name)
    rule = basix.make_quadrature(cell, DEGREES[kind.name])
    places, shares = (np.asarray(part, dtype=np.float64) for part in rule)
    element = basix.create_element(basix.ElementFamily.P, cell, 1)
    table = np.asarray(element.tabulate(0, places), dtype=np.float64)
    return SampleRule(places, shares / shares.sum(), table[0, :, :, 0])


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
    cell = getattr(basix.CellType, body.kind.name)
    whole = float(np.sum(basix.make_quadrature(cell, 1)[1]))
    return np.asarray(whole * rule.shares * np.reshape(values, (len(cells), -1)))
