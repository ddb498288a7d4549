"""Errors of cells by hand, and against the exact stress of pressed cylinders and spheres."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from castx.discretisation.cell_errors import CellErrors, described_error, squared
from castx.proof.verification.contact.shrink_fit import ShrinkFit, fitted_case
from castx.proof.verification.solids.hollow import Hollow, draw_section, pressed_case
from castx.proof.verification.states import drawn_mesh, states
from tests.castx.fakes import cylinder_mesh, slab_mesh
from tests.partitions import PARTITION, on_the_last

SIZE = 2.5e-3


def middles(body):
    return body.points[body.nodes.dofmap.list].mean(axis=1)


@pytest.mark.ranks
@pytest.mark.parametrize("cells, share", [("simplices", 18.0), ("quadrilaterals", 12.0)])
def test_a_slope_is_missed_by_its_spread_over_the_cell(comm, cells, share):
    """The variance of x over a rectangle of width h is h²/12, over half of it h²/18."""
    body = cylinder_mesh(comm, "axisymmetric", SIZE, cells).bodies["casting"]
    found = CellErrors(body, "plane-strain").of(7.0 * middles(body)[:, :1])
    np.testing.assert_allclose(found, 7.0 * SIZE / np.sqrt(share), rtol=1e-9)


@pytest.mark.ranks
def test_errors_of_a_body_are_those_of_all_ranks_and_of_the_full_turn(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    body = cylinder_mesh(comm, size=SIZE).bodies["casting"]
    errors = CellErrors(body, "axisymmetric")
    assert comm.allreduce(errors.volumes.sum()) == pytest.approx(np.pi * 0.02**2 * 0.04, rel=1e-9)
    stress = np.zeros((len(middles(body)), 6))
    stress[:, 3] = middles(body)[:, 1]  # a shear stress stands twice in the tensor
    found = errors.described(stress)
    assert found["error"] == pytest.approx(np.sqrt(2.0 / 18.0) * SIZE, rel=1e-9)
    size = np.sqrt(2.0 * 0.04**2 / 3.0)
    assert np.hypot(found["error"], found["size"]) == pytest.approx(size, rel=1e-3)
    assert found["relative"] == pytest.approx(found["error"] / size, rel=1e-3)


@pytest.mark.serial
def test_nothing_is_said_of_a_body_without_cells_that_count(comm):
    body = slab_mesh(comm, 5e-3).bodies["casting"]
    none = np.zeros(len(middles(body)), dtype=bool)
    errors = CellErrors(body, "plane-strain", none)
    assert errors.described(np.ones((len(none), 6))) is None
    assert not errors.of(np.ones((len(none), 6))).any()
    assert described_error(np.array([0.0, 0.0, 1.0])) == dict(error=0, size=0, relative=0)


def exact_stress(hollow, pressure, x):
    """Return Lamé's stress, sphere or cylinder in plane strain, at places, (…, 6)."""
    a, b, d = hollow.inner, hollow.outer, hollow.dimension
    r = np.linalg.norm(x, axis=-1)
    level = pressure * a**d / (b**d - a**d)
    radial = level * (1.0 - (b / r) ** d)
    hoop = level * (1.0 + (b / r) ** d / (d - 1))
    cosine, sine = x[..., 0] / r, x[..., 1] / r
    found = np.zeros((*r.shape, 6))
    found[..., 0] = radial * cosine**2 + hoop * sine**2
    found[..., 1] = radial * sine**2 + hoop * cosine**2
    found[..., 2] = hoop if d == 3 else hollow.poisson * (radial + hoop)
    found[..., 3] = (radial - hoop) * cosine * sine
    return found


def true_error(body, model, stress, exact):
    """Return the root mean square of the error of cell stresses over a body."""
    places, weights = body.kind.quadrature(4)
    shapes = body.kind.shape_functions(places)[0]
    corners = body.points[body.nodes.dofmap.list]
    x = np.einsum("pa,cai->cpi", shapes, corners)
    volumes = np.abs(np.linalg.det(body.kind.jacobians(corners, places))) * weights
    volumes *= x[..., 0] if model == "axisymmetric" else 1.0
    squares = squared((exact(x) - stress[:, None]).reshape(-1, 6)).reshape(volumes.shape)
    return np.sqrt((squares * volumes).sum() / volumes.sum())


@pytest.mark.sampled
@pytest.mark.parametrize(
    "dimension, quadrilaterals, formulation",
    [(3, False, "mixed"), (2, True, "q1p0"), (2, False, "displacement")],
)
def test_the_estimate_is_the_error_of_pressed_hollow_bodies(
    comm, dimension, quadrilaterals, formulation
):
    hollow, wanted = Hollow(dimension), {"formulation": formulation}
    pressure = 0.5 * hollow.first_yield
    time = {"end": pressure / 1e6, "fixed_step": pressure / 1e6}
    with drawn_mesh(comm, partial(draw_section, hollow, 6, quadrilaterals)) as folder:
        for state in states(comm, pressed_case(hollow, wanted, time), folder):
            stress, field = (state.cellwise("wall", n) for n in ("stress", "stress_error"))
    body, model = state.mesh.bodies["wall"], state.mesh.model
    errors = CellErrors(body, model)
    true = true_error(body, model, stress, lambda x: exact_stress(hollow, pressure, x))
    found = errors.described(stress)
    assert found["error"] == pytest.approx(true, rel=0.1)
    assert 0.05 < found["relative"] < 0.2
    np.testing.assert_allclose(field, errors.of(stress), rtol=1e-12)


def fitted_stress(fit, x):
    """Return Lamé's stress in the hub of a shrink fit in plane stress, (…, 6)."""
    r = np.linalg.norm(x, axis=-1)
    hoop = fit.hoop_stress(r)
    radial = 2 * fit.pressure * fit.inner**2 / (fit.outer**2 - fit.inner**2) - hoop
    cosine, sine = x[..., 0] / r, x[..., 1] / r
    found = np.zeros((*r.shape, 6))
    found[..., 0] = radial * cosine**2 + hoop * sine**2
    found[..., 1] = radial * sine**2 + hoop * cosine**2
    found[..., 3] = (radial - hoop) * cosine * sine
    return found


@pytest.mark.sampled
@pytest.mark.parametrize("formulation", ["mixed", "displacement", "taylor-hood"])
@pytest.mark.parametrize("fit", [ShrinkFit(), ShrinkFit(inner=0.01, outer=0.045)])
def test_the_estimate_is_the_error_of_a_shrink_fit(comm, fit, formulation):
    data = fitted_case(fit, fit.inner / 4)
    for described in data["bodies"]:
        described["formulation"] = formulation
    for state in states(comm, data):
        stress = state.cellwise("casting", "stress")
    body, model = state.mesh.bodies["casting"], state.mesh.model
    true = true_error(body, model, stress, partial(fitted_stress, fit))
    assert CellErrors(body, model).described(stress)["error"] == pytest.approx(true, rel=0.1)
