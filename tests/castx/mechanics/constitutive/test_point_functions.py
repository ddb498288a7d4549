"""Functions of stress and tangent: values of a response, and what the forms take of them."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.flow import PLASTIC
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.law import ELASTIC
from castx.mechanics.constitutive.point_functions import PointFunctions
from castx.mechanics.constitutive.response import respond
from tests.castx.mechanics.constitutive.metals import strains
from tests.castx.mechanics.constitutive.test_mush import TIMES, law, step


@pytest.mark.serial
def test_all_parts_of_a_response_come_to_the_forms(points, body):
    made = law(PLASTIC)
    conditions = step(made, points, body, *TIMES[-2:])
    found = respond(
        conditions, PointHistory.initial(points, mush=True), strains(points, 2e-3, seed=4)
    )
    functions = PointFunctions(points, made)
    functions.take(found)
    assert found.beside is not None and found.beside.radial.any() and found.radial.any()
    for function, values in (
        (functions.stress, found.stress),
        (functions.isotropic, found.isotropic),
        (functions.radial, found.radial),
        (functions.direction, found.direction),
        (functions.beside_radial, found.beside.radial),
        (functions.beside_direction, found.beside.direction),
    ):
        np.testing.assert_array_equal(function.x.array, values.ravel())
    given = functions.tensors()
    assert given["beside"][0] is functions.beside_radial and given["radial"] is functions.radial


@pytest.mark.serial
def test_an_elastic_body_has_no_radial_part(points):
    given = PointFunctions(points, law(ELASTIC)).tensors()
    assert given["radial"] is given["direction"] is given["beside"] is None
