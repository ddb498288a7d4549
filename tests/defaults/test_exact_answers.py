"""Cases with exact answers and no word of solvers: V12, V17 and V19, in their own tolerances."""

from __future__ import annotations

import numpy as np
import pytest

from castx.proof.verification.contact.closed_mould import WEIGHT, closed_mould
from castx.proof.verification.coupled import expanding_bars
from castx.proof.verification.coupled.expanding_bars import GIVEN, OPEN, Bars, mean
from castx.proof.verification.solids import solidifying_slab as slabs
from tests.defaults.runs import by_default
from tests.verification import solidifying_slab
from tests.verification.closed_mould import check as check_closed_mould

pytestmark = pytest.mark.sampled

RESOLUTION = 60


@pytest.mark.parametrize("kind", ["quadrilaterals", "triangles"])
def test_stress_in_a_solidifying_slab(comm, kind):
    """V12; strains are compared from the first step behind a second on."""
    slab, model = slabs.STEEL, slabs.FORMULATIONS[kind]
    case = slabs.slab_case(slab, *model, resolution=RESOLUTION, end=10.0)
    found = slabs.follow(by_default(comm, case), case, slab)
    begun = min(time for time in found.strain if time >= 1.0)
    exact = slabs.solve(slab)
    solidifying_slab.check(found, exact, RESOLUTION, (begun, 10.0))


@pytest.mark.parametrize("rigid", [True, False])
def test_a_casting_that_loses_all_walls_but_the_floor(comm, rigid):
    """V17; the weight is on the floor after every step."""
    for state in by_default(comm, closed_mould(rigid, seconds=10.0)):
        weight = state.totals["casting/mould.force.y"]
        assert weight == pytest.approx(WEIGHT, rel=1e-6)
    check_closed_mould(state)


@pytest.mark.parametrize("bars", [GIVEN, OPEN], ids=["closed", "open"])
def test_two_bars_with_a_coefficient_of_their_contact(comm, bars: Bars):
    """V19, by the mean over the faces: node by node linear elements alternate by O(h)."""
    case, exact = expanding_bars.bars_case(bars, "plane-strain", size=0.005), bars.exact()
    found = expanding_bars.answers(by_default(comm, case))
    assert found["cutbacks"][0] == 0
    assert mean(found, "h") == pytest.approx(exact["h"], rel=1e-4)
    assert found["q"][0] == pytest.approx(exact["q"], rel=1e-4)
    assert mean(found, "p") == pytest.approx(exact["p"], rel=1e-4)
    assert found["force"][0] == pytest.approx(exact["p"], rel=1e-4)
    np.testing.assert_allclose(found["gap"], exact["gap"], rtol=1e-4, atol=1e-12)
    for face in ("casting", "mould"):
        np.testing.assert_allclose(found[face], exact[face], rtol=1e-4)
