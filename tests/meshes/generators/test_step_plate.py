"""A plate with steps in its mould: places of the sections, symmetry, interface, refusals."""

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.errors import CaseError
from castx.meshes.generators.step_plate import step_plate
from tests.meshes.gmsh_meshes import BOTH, cell_set, generated, refused

pytestmark = pytest.mark.serial

WEDGE = {"lengths": [0.03, 0.05, 0.02], "thicknesses": [0.02, 0.008, 0.014], "wall": 0.01}
MODELS = pytest.mark.parametrize("model", ["plane-strain", "3d"])
LID = pytest.mark.parametrize("lid", [True, False])


def plate(model="plane-strain", **arguments):
    deep = {"depth": 0.03} if model == "3d" else {}
    arguments = {"size": 0.007, **WEDGE, **deep, **arguments}
    return generated(step_plate, ["casting", "mould"], model=model, **arguments)


def volume(mesh, body):
    corners = mesh.points[mesh.cells[mesh.bodies == body]]
    share = {"triangle": 1.0 / 2.0, "tetrahedron": 1.0 / 6.0}.get(mesh.kind.name, 1.0)
    return share * mesh.kind.corner_volumes(corners)[:, 0].sum()


@BOTH
@LID
@MODELS
def test_sections_have_their_volumes_and_the_mould_is_the_rest(model, lid, cells):
    """0.03·0.02 + 0.05·0.008 + 0.02·0.014 = 12.8 cm² of 0.12 m times 3 or 4 cm."""
    mesh = plate(model, lid=lid, cells=cells)
    deep, all_deep = (0.03, 0.05) if model == "3d" else (1.0, 1.0)
    casting = 12.8e-4 * deep
    assert volume(mesh, 0) == pytest.approx(casting, rel=1e-9)
    whole = 0.12 * (0.04 if lid else 0.03) * all_deep
    assert volume(mesh, 1) == pytest.approx(whole - casting, rel=1e-9)


@BOTH
@MODELS
def test_the_casting_lies_below_the_top_of_its_sections(model, cells):
    mesh = plate(model, cells=cells)
    middle = mesh.points[mesh.cells].mean(axis=1)
    top = np.select([middle[:, 0] < 0.03, middle[:, 0] < 0.08], [0.02, 0.008], 0.014)
    inside = (middle[:, 0] > 0.0) & (middle[:, 0] < 0.1)
    inside &= (middle[:, -1] > 0.0) & (middle[:, -1] < top)
    if model == "3d":
        inside &= np.abs(middle[:, 1]) < 0.015
    assert np.array_equal(mesh.bodies == 0, inside)


@BOTH
def test_a_plate_in_space_is_its_own_mirror_image(cells):
    mesh = plate("3d", cells=cells, interface_size=0.004)
    assert cell_set(mesh, [1.0, -1.0, 1.0]) == cell_set(mesh)


@BOTH
@LID
@pytest.mark.parametrize("size", [0.007, 0.003])
def test_every_cell_of_the_casting_has_a_node_inside_it(size, lid, cells):
    for model in ("plane-strain", "3d"):
        mesh = plate(model, lid=lid, size=size if model != "3d" else 0.007, cells=cells)
        shared = np.zeros(len(mesh.points), dtype=bool)
        shared[mesh.cells[mesh.bodies == 1]] = True
        assert not shared[mesh.cells[mesh.bodies == 0]].all(axis=1).any()


@LID
def test_the_thickest_section_alone_is_open_without_a_lid(lid):
    mesh = plate(lid=lid)
    owner = {frozenset(side) for cell in mesh.cells[mesh.bodies == 0]
             for side in zip(cell, np.roll(cell, 1), strict=True)}  # fmt: skip
    free = mesh.points[[face for face in mesh.faces if frozenset(face) in owner]]
    assert len(free) == 0 if lid else free[:, :, 0].max() == pytest.approx(0.03)
    assert lid or (free[:, :, 1] == pytest.approx(0.02) and free[:, :, 0].min() == 0.0)


def test_all_steps_are_refined():
    mesh = plate(size=0.008, interface_size=0.001, cells="quadrilaterals")
    places = np.unique(np.round(mesh.points[:, 0], 9))
    for step in (0.0, 0.03, 0.08, 0.1):
        here = int(np.abs(places - step).argmin())
        assert places[here] == pytest.approx(step, abs=1e-12)
        assert np.diff(places)[here - 1 : here + 1].max() < 0.0015
    assert np.diff(places).max() > 0.004


def test_thicknesses_that_differ_by_round_off_make_no_flat_cells():
    mesh = plate(thicknesses=[0.02, 0.005, 0.5e-2 * (1.0 + 1e-15)], cells="quadrilaterals")
    assert np.diff(np.unique(mesh.points[:, 1])).min() > 1e-3


@pytest.mark.parametrize(
    "arguments, text",
    [
        ({"model": "axisymmetric"}, "axisymmetric generator is cylinder_in_mould"),
        ({"model": "3d"}, 'the model "3d" needs a depth'),
        ({"model": "plane-stress", "lengths": [1.0, 1.0]}, "2 lengths, but 3 thicknesses"),
        ({"model": "plane-stress", "lengths": [1, 0, 1]}, "each of lengths must be positive"),
        ({"model": "plane-stress", "thicknesses": [1, 0, 1]}, "each of thicknesses must be pos"),
        ({"model": "plane-stress", "wall": 0.0}, "wall must be positive"),
    ],
)
def test_impossible_geometries_are_refused(arguments, text):
    refused(step_plate, text, **{**WEDGE, **arguments})


def test_a_case_says_which_list_is_too_short():
    case = {"generator": "step_plate", "model": "plane-strain", "size": 0.01, **WEDGE}
    with pytest.raises(CaseError, match="thicknesses: one is needed for each of the 3 lengths"):
        Geometry.read({**case, "thicknesses": [0.02, 0.01]})
