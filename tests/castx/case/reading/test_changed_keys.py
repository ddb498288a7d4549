"""Keys with new names: the old ones are read for one minor version, then refused, then unknown."""

import logging
import re
import tomllib
from copy import deepcopy
from pathlib import Path

import pytest

from castx.case.reading.changed_keys import CHANGED_KEYS, ChangedKey, with_new_names
from castx.case.reading.changes import refuse_changes
from castx.case.reading.read import load_case, read_case
from castx.errors import CaseError
from castx.input.problems import Refusal
from castx.version import __version__
from tests.castx.case_data import CYLINDER, REMOVED, cylinder

pytestmark = pytest.mark.serial

CHANGELOG = (Path(__file__).parents[4] / "CHANGELOG.md").read_text()
NOW = ".".join(__version__.split(".")[:2])
CLOSED = ChangedKey("interfaces.heat.contact_coefficient", "closed", NOW)
DENSITY = ChangedKey("materials.*.mass_density", "density", NOW)
TITLE = ChangedKey("title", "name", NOW)
OLD_TEXT = (
    CYLINDER.replace("closed =", "contact_coefficient =")
    .replace("density =", "mass_density =")
    .replace('name = "aluminium cylinder', 'title = "aluminium cylinder')
)
ALL = (CLOSED, DENSITY, TITLE)


def old_data():
    return tomllib.loads(OLD_TEXT)


def test_a_file_with_old_names_is_the_case_with_the_new_ones_and_each_is_told_once(
    tmp_path, caplog
):
    data, path = old_data(), tmp_path / "old.toml"
    before = deepcopy(data)
    with caplog.at_level(logging.WARNING, logger="castx"):
        case = read_case(data, path, changed=ALL)
    present = load_case(tomllib.loads(CYLINDER))
    assert data == before
    assert case.content == present.content and case.digest == present.digest
    assert (case.name, case.interfaces[0].heat.closed.table(0.0)) == (present.name, 2300.0)
    assert case.materials["steel"].density == pytest.approx(7800.0)
    assert [record.levelname for record in caplog.records] == ["WARNING"] * 3
    for message, old, new in zip(
        caplog.messages,
        (
            "interfaces[0].heat.contact_coefficient",
            "materials.aluminium.mass_density (and 1 more)",
            "title",
        ),
        ("closed", "density", "name"),
        strict=True,
    ):
        assert message.startswith(f"{path}: {old} is called {new} since castx {NOW}; change")


def test_a_file_with_new_names_is_read_without_a_word(caplog):
    with caplog.at_level(logging.WARNING, logger="castx"):
        read_case(cylinder(), Path("new.toml"), changed=ALL)
    assert caplog.messages == []


def test_without_an_entry_an_old_name_is_an_unknown_key():
    with pytest.raises(CaseError, match=r"contact_coefficient.*unknown key"):
        read_case(old_data(), Path("old.toml"), changed=(DENSITY, TITLE))


def test_both_names_are_refused_with_file_key_and_value():
    data = old_data()
    data["interfaces"][0]["heat"]["closed"] = 100
    text = (
        r"old.toml: interfaces\[0\].heat.contact_coefficient = 2300: is the old name of closed, "
        "which is there too; leave the old one out"
    )
    with pytest.raises(CaseError, match=text):
        read_case(data, Path("old.toml"), changed=ALL)


def test_a_checkpoint_of_the_version_before_is_of_the_same_case():
    refuse_changes(old_data(), cylinder(), "state.npz", ALL)
    with pytest.raises(CaseError, match=r"interfaces\[0\].heat.closed = 1 \(it was 2300\)"):
        refuse_changes(old_data(), cylinder(interfaces__0__heat__closed=1), "state.npz", ALL)
    with pytest.raises(CaseError, match=r"^state.npz: title = .*: is the old name of name"):
        refuse_changes(old_data() | {"name": "bar"}, cylinder(), "state.npz", ALL)


@pytest.mark.parametrize(
    "since, version, reads, over",
    [
        ("0.3", "0.2.9", True, False),  # entered before the version is out
        ("0.3", "0.3.0", True, False),
        ("0.3", "0.3.7", True, False),
        ("0.3", "0.4.0", False, False),
        ("0.3", "0.4.2", False, False),
        ("0.3", "0.5.0", False, True),
        ("0.3", "0.10.0", False, True),
        ("0.9", "1.0.0", False, False),
        ("0.9", "1.1.0", False, True),
        ("1.9", "1.10.0", False, False),
        ("1.9", "2.0.1", False, False),
        ("1.9", "3.0.0", False, True),
    ],
)
def test_an_old_name_is_read_in_one_minor_version_and_refused_in_the_next(
    since, version, reads, over
):
    key = ChangedKey("time.last", "end", since)
    assert (key.is_read(version), key.is_over(version)) == (reads, over)
    data = {"time": {"last": 3.0}}
    if reads:
        assert with_new_names(data, [key], version)[0] == {"time": {"end": 3.0}}
    else:
        with pytest.raises(Refusal, match=f"time.last: is called end since castx {since}; change"):
            with_new_names(data, [key], version)


@pytest.mark.parametrize(
    "data",
    [{}, {"interfaces": 3}, {"interfaces": [1, None]}, {"interfaces": [{"heat": "none"}]},
     {"interfaces": {"heat": []}, "materials": ["steel"], "title": REMOVED}],
)  # fmt: skip
def test_what_has_no_such_table_stays_as_it_is(data):
    given = {key: value for key, value in data.items() if value is not REMOVED}
    assert with_new_names(given, ALL) == (given, [])


@pytest.mark.parametrize(
    "old, new, since, text",
    [
        ("time.end", "end", "0.2", "time.end already has the name end"),
        ("time.", "end", "0.2", "a path such as a.b and a name are needed"),
        ("time.last", "time.end", "0.2", "a path such as a.b and a name are needed"),
        ("time.*", "end", "0.2", "a path such as a.b and a name are needed"),
        ("time.last", "end", "0.2.0", "'0.2.0' is no minor version such as 0.2"),
    ],
)
def test_declarations_that_mean_nothing_are_refused(old, new, since, text):
    with pytest.raises(ValueError, match=text):
        ChangedKey(old, new, since)


def over(changed, version):
    """Return the entries that can go."""
    return [key.old for key in changed if key.is_over(version)]


def untold(changed, changelog):
    """Return the entries that a changelog does not name by their old and their new name."""
    named = set(re.findall(r"`([^`]+)`", changelog))
    return [key.old for key in changed if not {key.name, key.new} <= named]


def test_no_entry_is_older_than_the_version_that_refuses_it():
    late, recent = ChangedKey("time.last", "end", "0.1"), ChangedKey("title", "name", "0.2")
    assert over([late, recent], "0.3.0") == ["time.last"]
    assert over(CHANGED_KEYS, __version__) == [], "take these entries out of CHANGED_KEYS"


def test_the_changelog_names_every_key_with_a_new_name():
    text = "- `closed` is the new name of `contact_coefficient` in `[interfaces.heat]`"
    assert untold([CLOSED, TITLE], text) == ["title"]
    assert untold(CHANGED_KEYS, CHANGELOG) == []
