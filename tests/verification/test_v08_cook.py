"""V8: Cook's membrane, the elastic cases.

A tapered panel (48 long, 44 and 16 high), clamped at the left, sheared at the right edge: bending
with nearly locked volume. R. D. Cook (1974), Improved two-dimensional finite element, J. Struct.
Div. ASCE 100; references are converged values: plane stress 25.187 (25.16 to 25.21 in the
literature), plane strain E 70, ν 1/3, shear stress 6.25: 32.299; plane strain E 250, ν 0.4999,
F 100: 7.770; with 1/K = 0: 7.7695.

Linear triangles cut by the shorter diagonals are 0.8 to 1.3 % too stiff at n = 32 and 0.4 to 0.6 %
at n = 64, those cut by the longer ones 2.4 to 3.1 % and 0.9 to 1.3 %, whatever the stabilisation.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from castx.equilibrium.problem import MechanicalProblem
from castx.proof.verification.solids.cook import CASES as IN_CASE_FILES
from castx.proof.verification.solids.cook import INCOMPRESSIBLE, TIP, Membrane, draw_membrane
from tests.elastic_bodies import at, body, drawn, elastic, fixed, problem, pulled
from tests.verification.cook import inner_pressures

CASES = {**IN_CASE_FILES, "incompressible": INCOMPRESSIBLE}


def bent(
    comm,
    folder,
    case: Membrane,
    n: int,
    stabilisation: str,
    longer: bool = False,
    formulation: str = "mixed",
) -> MechanicalProblem:
    draw = partial(draw_membrane, n, longer=longer)
    mesh = drawn(comm, case.model, ["membrane"], folder / "cook.msh", draw)
    membrane = body(
        elastic(case.young, case.poisson),
        formulation=formulation,
        stabilisation=stabilisation,
        loads=(pulled("right", 0.0, case.shear),),
    )
    made = problem(mesh, {"membrane": membrane}, {"membrane": [fixed("left", "all")]})
    made.equilibrium.solve(0.0)
    return made


@pytest.mark.serial  # a matter of the mesh; ranks agree in the other tests
@pytest.mark.parametrize(("n", "tolerance"), [(32, 0.02), (64, 0.01)])
@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
@pytest.mark.parametrize("name", CASES)
def test_tip_displacement(comm, shared_tmp_path, name, stabilisation, n, tolerance):
    case = CASES[name]
    made = bent(comm, shared_tmp_path, case, n, stabilisation)
    assert at(comm, made, "membrane", *TIP)[1] == pytest.approx(case.tip, rel=tolerance)
    if name == "plane stress":
        middle = at(comm, made, "membrane", 48.0, 52.0)[1]
        assert middle == pytest.approx(23.967, rel=tolerance)


@pytest.mark.serial  # a matter of the mesh; ranks agree in the other tests
@pytest.mark.parametrize(("n", "least", "most"), [(32, 0.024, 0.031), (64, 0.009, 0.013)])
@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
@pytest.mark.parametrize("name", CASES)
def test_longer_diagonals_are_stiffer(comm, shared_tmp_path, name, stabilisation, n, least, most):
    case = CASES[name]
    made = bent(comm, shared_tmp_path, case, n, stabilisation, longer=True)
    error = 1 - at(comm, made, "membrane", *TIP)[1] / case.tip
    assert least < error < most


@pytest.mark.serial  # a matter of the mesh; ranks agree in the other tests
@pytest.mark.parametrize("name", CASES)
def test_error_falls_with_the_element_size(comm, shared_tmp_path, name):
    case = CASES[name]
    tips = [
        at(comm, bent(comm, shared_tmp_path, case, n, "osgs"), "membrane", *TIP)[1]
        for n in (16, 32)
    ]
    assert abs(tips[0] - case.tip) > 1.6 * abs(tips[1] - case.tip)


@pytest.mark.serial  # a matter of the mesh; ranks agree in the other tests
@pytest.mark.parametrize("longer", [False, True], ids=["shorter", "longer"])
@pytest.mark.parametrize("name", CASES)
def test_quadratic_displacements_need_a_quarter_of_the_cells(comm, shared_tmp_path, name, longer):
    """Less than 0.4 % with the shorter diagonals, 1.1 % with the longer ones."""
    case = CASES[name]
    made = bent(
        comm, shared_tmp_path, case, 16, "osgs", longer, formulation="taylor-hood"
    )
    error = 1 - at(comm, made, "membrane", *TIP)[1] / case.tip
    assert 0 < error < (0.011 if longer else 0.004)


@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
def test_no_pressure_checkerboard(comm, shared_tmp_path, stabilisation):
    """Second differences of p along the grid lines are those of a smooth field."""
    n = 32
    made = bent(comm, shared_tmp_path, CASES["incompressible"], n, stabilisation)
    inside = inner_pressures(comm, made, n)
    for axis in (0, 1):
        assert np.abs(np.diff(inside, 2, axis=axis)).max() < 0.02 * np.ptp(inside)
