"""Fields of motion: read from the nodes, shown in the units of a foundry."""

import pytest

from castx.case.fields.motion import FIELDS
from tests.castx.case.fields.samples import KnownState, by_name, displayed, followed

pytestmark = pytest.mark.serial


def test_displacements_are_those_of_the_nodes():
    state = KnownState()
    assert by_name(FIELDS)["displacement"].values(state) is state.moved


def test_the_deviation_is_followed_at_nodes_and_shown_in_millimetres():
    assert followed(FIELDS) == {"deviation": "nodes"}
    assert displayed(by_name(FIELDS)["deviation"], 2e-4) == "0.2 mm"
