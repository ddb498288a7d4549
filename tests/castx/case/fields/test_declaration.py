"""What a declaration lacks, in words."""

import pytest

from castx.case.fields.declaration import FieldPlace, OutputField
from tests.castx.case.fields.samples import KnownState

pytestmark = pytest.mark.serial


def declared(**changes):
    whole = {
        "name": "twice", "title": "Twice the gap", "unit": "m", "place": FieldPlace.PAIR,
        "read": lambda state: 2.0 * state.gap(),
    }  # fmt: skip
    return OutputField(**(whole | changes))


def test_a_whole_declaration_lacks_nothing_and_is_read():
    state = KnownState()
    assert declared().omissions() == []
    assert declared().values(state) == pytest.approx([2 * gap for gap in state.gaps])


@pytest.mark.parametrize("followed", [True, False])
def test_a_field_is_either_read_or_followed(followed):
    changes = {"followed": True} if followed else {"read": None}
    assert len(declared(**changes).omissions()) == 1
    assert declared(followed=True, read=None).omissions() == []


@pytest.mark.parametrize(
    "changes, missing",
    [
        ({"title": " "}, ["title"]),
        ({"unit": ""}, ["unit"]),
        ({"place": None}, ["place"]),
        ({"title": "", "unit": "", "place": None}, ["title", "unit", "place"]),
    ],
)
def test_what_is_missing_is_named(changes, missing):
    assert declared(**changes).omissions() == missing
