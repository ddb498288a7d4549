"""Strain without stress of a cell in which some metal contracts and some does not.

Behind a front solid lies in layers. Along them all of it strains alike, and the thinnest skin takes
its cell with it; across them one layer lies behind the other, and each contracts for itself. With
dc the contraction of the corners, w their shares, and n the normal of the front,

    da = Σ_v w_v dc_v / Σ_v w_v,   de^θ = mean of dc_v,   de^c = (da − de^θ)/3 (1 − 3 n ⊗ n).

Along the front that is da/3, and the volume is that of the metal, whatever the size of the cell:
the means of Voigt and of Reuss of a laminate (Milton, The Theory of Composites, 2002, chapter 9).
With da in all directions a triangle would lose c (1 + 1/2 + 1/3) to a front that is narrower than
it is, and behind which the metal contracts by c.

Single nodes of a mesh freeze early or late, and isotherms lean in the cells beside them, by which a
plate in triangles contracts by 2 % too little. So n is the normal of means round the nodes, taken
three times. Cells of one layer have one corner in the solid or more: they share da − de^θ.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.constitutive.growth import ROUNDING, Growth
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.places import MetalPlaces

AXES = np.array([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)])
"""Of the components of a symmetric tensor, see `castx.forms.kinematics.symmetric_tensor`."""

FLAT = 1e-9
"""Fall of the temperature across a cell that is none [K]."""

MEANS = 3
"""Times that means are taken. Plates of 16 tetrahedra behind a thin wall are 4.0 % short with two,
and with more than three by as much as with the normal of the plate."""


class Eigenstrain(NamedTuple):
    """Strain over a step that no stress resists.

    Attributes:
        volume: de^θ, shape (volumes,).
        shape: de^c, deviatoric, shape (points, components).
        front: 1 − 3 n ⊗ n, zero where no solid contracts unevenly, likewise.
    """

    volume: FloatArray
    shape: FloatArray
    front: FloatArray


def eigenstrain(
    points: IntegrationPoints,
    places: IntegrationPoints | MetalPlaces,
    growth: Growth,
    temperature: FloatArray,
) -> Eigenstrain:
    """Return the strain of a step that contraction alone would bring about; collective.

    Args:
        points: integration points of the body.
        places: of the metal; integration points stand for the nodes of the body.
        growth: of its solid in the step.
        temperature: of the nodes at the end of the step [°C], shape (nodes,).
    """
    along = growth.along(places)
    front: FloatArray = np.zeros((points.count, points.components))
    excess = along - growth.across(places)
    uneven = np.abs(excess) > ROUNDING
    if points.summed(np.array([np.count_nonzero(uneven)])).any():
        excess = points.shared_out(excess, uneven)
        front = _in_the_plane(points.components, front_normals(points, temperature))
    return Eigenstrain(along - excess, (points.from_volumes(excess) / 3)[:, None] * front, front)


def front_normals(points: IntegrationPoints, temperature: FloatArray) -> FloatArray:
    """Return the normals of the isotherms at the points, (points, gdim); collective.

    They are zero where all around is as warm.

    Args:
        points: integration points of the body.
        temperature: of the nodes [°C], shape (nodes,).
    """
    gradient = points.gradients(temperature)
    for _ in range(MEANS):
        means = points.vectors_around_nodes(gradient)
        gradient = np.column_stack([points.from_nodes(component) for component in means.T])
    size: FloatArray = np.linalg.norm(gradient, axis=1)[:, None]
    falls = size * points.from_cells(points.sizes)[:, None] > FLAT
    return np.asarray(np.divide(gradient, size, out=np.zeros_like(gradient), where=falls))


def _in_the_plane(components: int, normals: FloatArray) -> FloatArray:
    """Return 1 − 3 n ⊗ n, zero without a normal, shape (points, components)."""
    n = np.pad(normals, ((0, 0), (0, 3 - normals.shape[1])))
    first, second = AXES[:components].T
    known = (n != 0.0).any(axis=1)[:, None]
    return np.asarray(known * (first == second) - 3 * n[:, first] * n[:, second])
