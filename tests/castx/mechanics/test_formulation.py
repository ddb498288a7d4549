"""Unknowns of a body, assembly of its weak forms, and stresses from their two parts."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import ufl
from dolfinx import fem

from castx.mechanics.formulation import PRESSURE_SHARE, BodyUnknowns, WeakForms, cell_stress
from tests.castx.mechanics.lone_bodies import LENGTH, WIDTH, slab

SHEAR = 26e9


@pytest.mark.ranks
@pytest.mark.parametrize("with_pressure", [False, True])
@pytest.mark.parametrize("model", ["plane-strain", "generalised-plane-strain", "3d"])
def test_unknowns_of_a_node(comm, model, with_pressure):
    """Displacement first, then the pressure, then the axial strain."""
    made = BodyUnknowns(slab(comm, model), model, with_pressure, SHEAR)
    d = 3 if model == "3d" else 2
    axial = model == "generalised-plane-strain"
    assert made.dimension == d
    assert made.pressure_component == (d if with_pressure else None)
    assert made.axial == (d + with_pressure if axial else None)
    assert made.block_size == made.space.dofmap.index_map_bs == d + with_pressure + axial
    assert made.owned == made.space.dofmap.index_map.size_local * made.block_size
    assert made.length == pytest.approx(LENGTH)
    assert made.pressure_scale == pytest.approx(PRESSURE_SHARE * SHEAR / LENGTH)


def mean(comm, expression, mesh):
    """Return the mean of an expression over the plane slab."""
    local = fem.assemble_scalar(fem.form(expression * ufl.dx(mesh)))
    return comm.allreduce(local) / (LENGTH * WIDTH)


def test_fields_are_read_from_the_unknowns(comm):
    model = "generalised-plane-strain"
    made = BodyUnknowns(slab(comm, model), model, True, SHEAR)
    values = made.solution.x.array.reshape(-1, 4)
    x, y = made.mesh.points[:, 0], made.mesh.points[:, 1]
    values[:, 0], values[:, 1] = 2e-3 * x + 3e-3 * y, -1e-3 * x + 5e-3 * y
    values[:, 2], values[:, 3] = 7e5 / made.pressure_scale, 4e-3 * made.length
    w, mesh = made.solution, made.mesh.mesh
    u, strain = made.displacement(w), made.strain(w)
    assert mean(comm, u[0], mesh) == pytest.approx(2e-3 * LENGTH / 2 + 3e-3 * WIDTH / 2)
    assert mean(comm, made.pressure(w), mesh) == pytest.approx(7e5)
    expected = np.array([[2e-3, 1e-3, 0], [1e-3, 5e-3, 0], [0, 0, 4e-3]])
    found = [[mean(comm, strain[i, j], mesh) for j in range(3)] for i in range(3)]
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-18)


@pytest.mark.ranks
def test_forms_of_a_spring_bed_are_assembled(comm):
    """∫ k u·η - ∫ b·η: residual and Jacobian agree, and the load acts once it is updated."""
    made = BodyUnknowns(slab(comm), "plane-strain", False, SHEAR)
    test, trial = ufl.TestFunction(made.space), ufl.TrialFunction(made.space)
    load = fem.Constant(made.mesh.mesh, np.array([3.0, -1.0]))
    forms = WeakForms(
        made,
        5.0 * ufl.inner(made.solution, test) * ufl.dx,
        5.0 * ufl.inner(trial, test) * ufl.dx,
        ufl.inner(load, test) * ufl.dx,
    )
    made.solution.x.array.reshape(-1, 2)[:] = [2.0, 4.0]
    area = LENGTH * WIDTH

    def total(values):
        return comm.allreduce(values.reshape(-1, 2).sum(axis=0)) / area

    np.testing.assert_allclose(total(forms.residual()), [10.0, 20.0], rtol=1e-12)
    forms.update_load()
    np.testing.assert_array_equal(
        forms.assemble(fem.form(ufl.inner(load, test) * ufl.dx)), forms.load
    )
    np.testing.assert_allclose(total(forms.load), [3.0, -1.0], rtol=1e-12)
    np.testing.assert_allclose(total(forms.residual()), [7.0, 21.0], rtol=1e-12)
    A = forms.create_jacobian()
    for _ in range(2):
        forms.assemble_jacobian(A)
        x, y = A.createVecs()
        x.array[:] = np.tile([2.0, 4.0], len(x.array) // 2)
        A.mult(x, y)
        np.testing.assert_allclose(y.array_r - forms.load, forms.residual(), atol=1e-15)
        for item in (x, y):
            item.destroy()
    A.destroy()


@pytest.mark.serial
@pytest.mark.parametrize("components", [4, 6], ids=["plane", "3d"])
def test_stress_is_deviator_plus_mean(components):
    """Means over two points of a cell; out-of-plane shear is zero in the plane."""
    deviator = np.arange(4.0 * components).reshape(4, components)
    points = SimpleNamespace(cell_means=lambda values: values.reshape(2, 2, -1).mean(axis=1))
    material = SimpleNamespace(points=points, response=SimpleNamespace(stress=deviator))
    found = cell_stress(material, np.array([100.0, 200.0]))
    expected = np.zeros((2, 6))
    expected[:, :components] = [deviator[:2].mean(axis=0), deviator[2:].mean(axis=0)]
    expected += np.outer([100.0, 200.0], [1, 1, 1, 0, 0, 0])
    np.testing.assert_allclose(found, expected, rtol=1e-14)
