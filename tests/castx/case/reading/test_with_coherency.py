"""A case with another coherency is what --set would make of it."""

import pytest

from castx.case.reading.read import load_case
from castx.case.reading.with_coherency import with_coherency
from castx.errors import CaseError
from castx.materials.lookup import find_material
from tests.castx.command_line import ALLOY_CASE, content_of

pytestmark = pytest.mark.serial

CREEP = 'materials.AlSi7Mg={extends="AlSi7Mg", liquid={model="norton", '
CREEP += "coefficient=[[500.0, 1e-9], [600.0, 1e-7]], exponent=2.0, coherency="


def case_of(*overrides):
    return load_case(content_of(ALLOY_CASE), overrides)


def liquid_of(case):
    return find_material("AlSi7Mg", case.materials).liquid


def test_coherency_alone_changes():
    case = case_of()
    other = with_coherency(case, -0.05)
    assert liquid_of(other).coherency == pytest.approx(0.85, rel=1e-14)
    assert liquid_of(other).viscosity(600.0) == liquid_of(case).viscosity(600.0) == 1e6
    mine, theirs = (find_material("AlSi7Mg", found.materials) for found in (case, other))
    assert mine.description.density == theirs.description.density
    assert liquid_of(case).coherency == 0.9
    left = {key: value for key, value in other.content.items() if key != "materials"}
    assert left == case.content


@pytest.mark.parametrize(("shift", "coherency"), [(0.3, 1.0), (-2.0, 0.01)])
def test_it_stays_within_zero_and_one(shift, coherency):
    assert liquid_of(with_coherency(case_of(), shift)).coherency == coherency


def test_a_liquid_of_the_case_keeps_its_keys():
    found = with_coherency(case_of(CREEP + "0.5}}"), 0.25)
    expected = case_of(CREEP + "0.75}}")
    assert found.digest == expected.digest


def test_a_chain_of_materials_is_moved_by_what_the_body_has():
    chain = 'materials.mine={extends="theirs", density=2600}'
    base = 'materials.theirs={extends="AlSi7Mg", liquid={viscosity=2e6, coherency=0.5}}'
    found = with_coherency(case_of(base, chain, "bodies.0.material=mine"), 0.25)
    mine = find_material("mine", found.materials)
    assert (mine.liquid.coherency, mine.description.density) == (0.75, 2600.0)
    assert mine.liquid.viscosity(0.0) == 2e6
    assert find_material("theirs", found.materials).liquid.coherency == 0.5


@pytest.mark.parametrize(
    ("override", "reason"),
    [
        ("bodies.0.material=Al-pure", "metal that freezes at one temperature has no mush"),
        ("coupling.scheme=thermal", 'scheme = "thermal" nothing bears'),
    ],
)
def test_a_case_without_coherency_is_refused(override, reason):
    with pytest.raises(CaseError, match=reason):
        with_coherency(case_of(override), 0.05)
