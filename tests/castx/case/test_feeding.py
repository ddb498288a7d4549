"""What a case says of how its melt is fed, and of what its mush lacks to let it flow."""

from __future__ import annotations

import pytest

from castx.case.feeding import feeding_texts
from castx.case.reading.read import load_case
from tests.castx.command_line import ALLOY_CASE, content_of

pytestmark = pytest.mark.serial


def said(*overrides: str) -> list[str]:
    return list(feeding_texts(load_case(content_of(ALLOY_CASE), overrides)))


def test_pockets_with_all_data_of_the_mush():
    (text,) = said()
    assert text.startswith('casting: trapped melt has one pressure in each pocket (feeding = "poc')
    assert text.endswith('AlSi7Mg has the data for flow through the mush, "darcy"')


def test_pockets_name_what_the_mush_lacks():
    """Iron has neither viscosity nor arms in the database; it swells, and so has a shrinkage."""
    (text,) = said("bodies.0.material=GJL-250", "bodies.0.temperature=1300")
    assert text.endswith('"darcy", GJL-250 lacks melt_viscosity, arm_spacing')


def test_pure_metal_has_no_mush():
    (text,) = said("bodies.0.material=Al-pure")
    assert text.endswith("Al-pure freezes at one temperature and has no mush to flow through")


@pytest.mark.parametrize(
    ("feeders", "by"),
    [([], "all free surfaces"), (["foundry.feeders=[]"], "nothing"),
     (['foundry.feeders=["casting/top"]'], "casting/top")],
)  # fmt: skip
def test_flow_names_its_feeders(feeders, by):
    (text,) = said("bodies.0.feeding=darcy", *feeders)
    assert text == f'casting: melt flows through its mush (feeding = "darcy"), fed by {by}'


@pytest.mark.parametrize(
    "override",
    [
        "coupling.scheme=thermal",
        "bodies.0.temperature=500",  # starts solid
        'materials.AlSi7Mg={extends="AlSi7Mg", liquid="none"}',
    ],
)
def test_nothing_is_said_where_no_liquid_counts(override):
    assert said(override) == []
