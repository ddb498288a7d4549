"""Flux through a wall from steady temperatures inside a box, conduction by `forms/heat.py`.

T = a x² + b x y + c y - a z² + c is harmonic, and k (b x + c) flows out through y = 0. The flux is
a line of five knots along x, the far wall has its exact temperatures, the other four their exact
fluxes, and sensors lie between nodes at a tenth of the depth. Source: Morelli et al., Int. J.
Numer. Methods Eng. 122 (2021) 4541; field and data of ROMSOC/benchmarks-inverse-heat-transfer.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from mpi4py import MPI

import numpy as np
import pytest
import ufl
from dolfinx import fem, geometry, mesh
from scipy.sparse.linalg import cg

from castx.arrays import FloatArray
from castx.forms.heat import conduction
from castx.foundry.identification.covariance import deviations, posterior
from castx.foundry.identification.fit import Unknown, fit

pytestmark = pytest.mark.serial

CONDUCTIVITY, A, B, C = 3.0, 5.0, 10.0, 15.0
KNOTS: FloatArray = np.linspace(0.0, 1.0, 5, dtype=np.float64)
FLUX = CONDUCTIVITY * (B * KNOTS + C)
NOISE = np.array(0.05)
ALONG, ACROSS = (0.05, 0.29, 0.45, 0.61, 0.77, 0.95), (0.31, 0.57, 0.73)
SENSORS = np.array([[x, 0.1, z] for x in ALONG for z in ACROSS])


def exact(x: FloatArray) -> FloatArray:
    return np.asarray(A * x[0] ** 2 + B * x[0] * x[1] + C * x[1] - A * x[2] ** 2 + C)


@dataclass(frozen=True, eq=False)
class Box:
    """Temperatures of the sensors without flux, and their changes by the flux of each knot."""

    without: FloatArray
    changes: FloatArray


def at_sensors(box: mesh.Mesh, fields: list[fem.Function]) -> FloatArray:
    """Return the values of fields between nodes, (sensors, fields)."""
    tree = geometry.bb_tree(box, 3)
    candidates = geometry.compute_collisions_points(tree, SENSORS)
    cells = geometry.compute_colliding_cells(box, candidates, SENSORS)
    first = np.array([cells.links(k)[0] for k in range(len(SENSORS))])
    return np.column_stack([field.eval(SENSORS, first)[:, 0] for field in fields])


@cache
def box_of(divisions: int) -> Box:
    """Return a cube whose far wall is held; its sides have their exact fluxes."""
    cells = mesh.CellType.hexahedron
    cube = mesh.create_unit_cube(MPI.COMM_SELF, divisions, divisions, divisions, cells)
    space = fem.functionspace(cube, ("Lagrange", 1))
    test, potential = ufl.TestFunction(space), CONDUCTIVITY * ufl.TrialFunction(space)
    form = conduction(potential, test, 1.0, ufl.dx)
    matrix = fem.assemble_matrix(fem.form(form)).to_scipy().tocsc()
    points = space.tabulate_dof_coordinates().T
    held = np.isclose(points[1], 1.0)
    inside = matrix[~held][:, ~held]

    def answer(load: ufl.Form, wall: FloatArray) -> fem.Function:
        """Return the temperatures under a load, with those of the far wall given."""
        found = fem.Function(space)
        inner = fem.assemble_vector(fem.form(load)).array - matrix @ (held * wall)
        found.x.array[:] = held * wall
        found.x.array[~held], failed = cg(inside, inner[~held], rtol=1e-12)
        assert not failed
        return found

    x, n = ufl.SpatialCoordinate(cube), ufl.FacetNormal(cube)
    gradient = ufl.grad(A * x[0] ** 2 + B * x[0] * x[1] + C * x[1] - A * x[2] ** 2)
    near = ufl.conditional(ufl.lt(x[1], 1e-9), 1.0, 0.0)
    sides = (1.0 - near) * CONDUCTIVITY * ufl.inner(gradient, n) * test * ufl.ds
    fields = [answer(sides, exact(points))]
    for knot in np.eye(len(KNOTS)):
        share = fem.Function(space)
        share.interpolate(lambda at, knot=knot: np.interp(at[0], KNOTS, knot))
        fields.append(answer(-near * share * test * ufl.ds, np.zeros(points.shape[1])))
    found = at_sensors(cube, fields)
    return Box(found[:, 0], found[:, 1:])


def fitted(box: Box, measured: FloatArray):
    """Fit the flux of the knots from a uniform one."""
    names = [f"{x:g}" for x in KNOTS]
    unknowns = [Unknown(name, 50.0, 1.0) for name in names]

    def model(values):
        return box.without + box.changes @ np.array([values[name] for name in names])

    return fit(model, measured, NOISE, unknowns)


def test_the_flux_without_noise():
    """Within 1 % at each knot, by the error of the mesh, which falls."""
    errors = []
    for divisions in (13, 26):
        found = fitted(box_of(divisions), exact(SENSORS.T))
        errors.append(np.abs(found.fitted / FLUX - 1.0).max())
    assert errors[0] < 0.01 and errors[1] < 0.5 * errors[0], errors


def test_noise_scatters_it_as_the_covariance_says():
    """Of 400 draws 95 % bands hit, and misfits weighted by the covariance have the mean 5."""
    box = box_of(10)
    true = box.without + box.changes @ FLUX
    covariance = posterior(box.changes, NOISE)
    random = np.random.default_rng(20261123)
    off = np.array([
        fitted(box, true + NOISE * random.normal(size=len(true))).fitted - FLUX for _ in range(400)
    ])  # fmt: skip
    hits = np.abs(off) < 1.96 * deviations(covariance)
    assert np.all(np.abs(hits.mean(axis=0) - 0.95) < 0.03)
    squares = np.einsum("ij,jk,ik->i", off, np.linalg.inv(covariance), off)
    assert squares.mean() == pytest.approx(len(KNOTS), abs=4.0 * np.sqrt(2.0 * len(KNOTS) / 400))
