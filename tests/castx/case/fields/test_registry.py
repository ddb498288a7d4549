"""The registry of output fields: what it finds, and what it refuses."""

from pathlib import Path
from types import SimpleNamespace

import pytest

import castx.case.fields
from castx.case.fields import registry
from castx.case.fields.declaration import FieldPlace, OutputField
from castx.case.fields.registry import output_fields, probed, read_from_states

pytestmark = pytest.mark.serial
PROJECT = Path(__file__).parents[4]


def declared(**changes):
    whole = {
        "name": "mine", "title": "Mine", "unit": "1", "place": FieldPlace.CELL,
        "read": lambda state: state.plastic_strain(),
    }  # fmt: skip
    return OutputField(**(whole | changes))


@pytest.fixture
def found_in(monkeypatch):
    """Return what the registry finds in files that declare given fields."""

    def found(**files):
        modules = [SimpleNamespace(name=name) for name in reversed(files)]
        monkeypatch.setattr(registry.pkgutil, "iter_modules", lambda path: modules)
        monkeypatch.setattr(
            registry, "import_module", lambda name: SimpleNamespace(**files[name.split(".")[-1]])
        )
        return output_fields.__wrapped__()

    return found


def test_every_file_of_the_room_declares_fields():
    folder = Path(castx.case.fields.__path__[0])
    files = {path.stem for path in folder.glob("*.py")} - {"__init__", *registry.OTHERS}
    texts = {stem: (folder / f"{stem}.py").read_text() for stem in files}
    assert all("\nFIELDS = (" in text for text in texts.values())
    declarations = sum(text.count("    OutputField(\n") for text in texts.values())
    assert declarations == len(output_fields())


def test_fields_of_all_files_are_found_by_name(found_in):
    a, b, c = (declared(name=name) for name in "abc")
    found = found_in(one={"FIELDS": (c, a)}, two={"FIELDS": (b,)}, registry={})
    assert list(found.items()) == [("a", a), ("b", b), ("c", c)]


@pytest.mark.parametrize(
    "changes, missing",
    [
        ({"title": ""}, "lacks title"),
        ({"unit": ""}, "lacks unit"),
        ({"place": None}, "lacks place"),
        ({"read": None}, "lacks read, or else followed=True"),
        ({"unit": "", "read": None}, "lacks unit, read, or else followed=True"),
        ({"followed": True}, "lacks a choice between read and followed=True"),
    ],
)
def test_a_field_that_lacks_something_is_refused_by_name(found_in, changes, missing):
    with pytest.raises(TypeError) as refusal:
        found_in(own={"FIELDS": (declared(**changes),)})
    assert str(refusal.value) == f"castx/case/fields/own.py: the field 'mine' {missing}"


def test_two_fields_of_one_name_are_refused(found_in):
    with pytest.raises(TypeError, match=r"two\.py: the field 'mine' is declared twice"):
        found_in(one={"FIELDS": (declared(),)}, two={"FIELDS": (declared(),)})


@pytest.mark.parametrize("content", [{}, {"FIELDS": ()}])
def test_a_file_without_fields_is_refused(found_in, content):
    with pytest.raises(TypeError, match=r"castx/case/fields/own\.py declares no FIELDS"):
        found_in(own=content)


def test_probes_record_what_has_a_dimension():
    assert probed(FieldPlace.PAIR) == ("contact_pressure", "gap", "heat_transfer_coefficient")
    assert "pressure" in probed(FieldPlace.NODE) and "stress" not in probed(FieldPlace.NODE)
    assert "stress" in probed(FieldPlace.NODE, FieldPlace.CELL)
    assert not any(output_fields()[name].followed for name in probed(*FieldPlace))


def test_fields_that_are_read_are_told_from_those_that_are_followed():
    assert "von_mises" in read_from_states(FieldPlace.CELL)
    assert "heat_flux" not in read_from_states(FieldPlace.CELL)
    assert "gap" not in read_from_states(FieldPlace.NODE)


def unread(names, folder):
    """Return the names that stand in no test of a folder as a text of their own."""
    text = "".join(path.read_text() for path in folder.rglob("test_*.py"))
    return sorted(name for name in names if f'"{name}"' not in text)


def test_every_field_is_read_by_a_test():
    missing = unread(output_fields(), PROJECT / "tests")
    assert not missing, f"no test reads the output fields {missing}"


def test_a_field_that_no_test_reads_is_named(tmp_path):
    (tmp_path / "test_one.py").write_text('state.nodal("casting", "known")  # not the "other one"')
    assert unread(["other", "known"], tmp_path) == ["other"]
