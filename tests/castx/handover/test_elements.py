"""Elements of CalculiX: nodal forces by the principle of virtual work, orders of nodes, points."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.handover.elements import GAUSS, MIRRORED, MIRRORED_TETRAHEDRON, Elements
from tests.castx.handover.made_results import box

pytestmark = pytest.mark.serial
STRESS = np.array([3.0, -1.0, 2.0, 0.7, 0.4, -0.9])
KINDS = [("3d", 4), ("3d", 8), ("plane-strain", 3), ("plane-stress", 3), ("plane-strain", 4)]


def cells_of(model, corners):
    points, cells = box(corners if model == "3d" or corners == 3 else -4)
    return points, cells


def points_in(corners, model):
    return {4: 1, 8: 8}[corners] if model == "3d" else {3: 1, 4: 4}[corners]


@pytest.mark.parametrize(("model", "corners"), KINDS)
def test_forces_of_a_uniform_stress_are_those_on_the_faces(model, corners):
    points, cells = cells_of(model, corners)
    stress = np.tile(STRESS, (len(cells), points_in(corners, model), 1))
    elements = Elements.of(model, points, cells, stress)
    forces, sizes = elements.forces()
    far = points[:, 0] > 0.03 - 1e-9
    area = 0.02 * (0.01 if model == "3d" else 1.0)
    traction = STRESS[[0, 3, 4]] if model == "3d" else np.array([3.0, 0.7, 0.0])
    inner = np.zeros(3) if model != "3d" else None
    np.testing.assert_allclose(forces.sum(axis=0), 0.0, atol=1e-15)
    middle = far & (np.abs(points[:, 1] - 0.01) < 1e-9)
    if model != "3d":
        np.testing.assert_allclose(forces[middle].sum(axis=0), 0.5 * area * traction, atol=1e-15)
        centre = np.linalg.norm(points - [0.015, 0.01, 0.0], axis=1) < 1e-9
        np.testing.assert_allclose(forces[centre][0], inner, atol=1e-15)
    # Work of the displacement u = A x is the stress times its strain times the volume.
    gradient = np.arange(9.0).reshape(3, 3)
    if model != "3d":
        gradient[2] = gradient[:, 2] = 0.0
    volume = 0.03 * 0.02 * (0.01 if model == "3d" else 1.0)
    tensor = STRESS[[[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
    work = np.sum(forces * (points @ gradient.T))
    assert work == pytest.approx(volume * np.sum(tensor * gradient), rel=1e-12)
    assert (sizes >= np.linalg.norm(forces, axis=1) - 1e-15).all()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_points_of_a_brick_come_with_the_first_direction_fastest(axis):
    points, cells = box(8, (1, 1, 1), (1.0, 1.0, 1.0))
    z, y, x = (c.ravel() for c in np.meshgrid(GAUSS, GAUSS, GAUSS, indexing="ij"))
    place = 0.5 * (1.0 + np.column_stack([x, y, z]))[:, axis]
    stress = np.zeros((1, 8, 6))
    stress[0, :, 0] = place
    forces, _ = Elements.of("3d", points, cells, stress).forces()
    # ∫ σ_xx ∂u/∂x with u = x times the coordinate: σ ∂u/∂x = s² (or 2 s² along x).
    work = forces[:, 0] @ (points[:, 0] * points[:, axis])
    expected = {0: 0.5, 1: 1.0 / 3.0, 2: 1.0 / 3.0}[axis]  # nodal x² is linear in x: slope 1
    assert work == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("model", "corners"), [*KINDS, ("axisymmetric", 3), ("axisymmetric", 4)])
def test_cells_turned_over_have_the_same_forces(model, corners):
    points, cells = cells_of(model, corners)
    points[:, 0] += 0.01 * (model == "axisymmetric")
    count = points_in(corners, model)
    stress = np.random.default_rng(1).normal(size=(len(cells), count, 6))
    if model != "3d":
        stress[..., 4:] = 0.0
    solid = model == "3d"
    nodes, order = MIRRORED_TETRAHEDRON if solid and corners == 4 else MIRRORED[corners]
    turned = cells[:, nodes], stress[:, order]
    first, second = (
        Elements.of(model, points, *given) for given in ((cells, stress), turned)
    )
    np.testing.assert_array_equal(first.cells, second.cells)
    np.testing.assert_allclose(first.forces()[0], second.forces()[0], atol=1e-15)


@pytest.mark.parametrize("corners", [3, 4])
def test_forces_of_axisymmetric_cells_are_those_of_the_full_turn(corners):
    points, cells = cells_of("axisymmetric", corners)
    points = points + np.array([0.02, 0.0, 0.0])
    rr, zz, tt = 2.0, -1.0, 5.0
    stress = np.zeros((len(cells), points_in(corners, "axisymmetric"), 6))
    stress[..., :3] = rr, zz, tt
    elements = Elements.of("axisymmetric", points, cells, stress)
    assert elements.name == f"CAX{corners}" and elements.stress.shape[1] == {3: 2, 4: 8}[corners]
    forces, _ = elements.forces()
    volume = np.pi * (0.05**2 - 0.02**2) * 0.02
    # CalculiX's sector of two degrees has flat faces: 1e-4 less.
    assert forces[:, 0] @ points[:, 0] == pytest.approx(volume * (rr + tt), rel=3e-4)
    assert forces[:, 1] @ points[:, 1] == pytest.approx(volume * zz, rel=3e-4)


def test_a_model_without_element_is_refused():
    points, cells = box(3)
    with pytest.raises(CaseError, match="no element for cells of 3 corners in the model general"):
        Elements.of("generalised-plane-strain", points, cells, np.zeros((len(cells), 1, 6)))
