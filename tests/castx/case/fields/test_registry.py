"""The registry of output fields: what it finds, and what it refuses."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import castx.case.fields
from castx.case.fields import registry
from castx.case.fields.declaration import FieldPlace, OutputField
from castx.case.fields.registry import output_fields, probed, read_from_states
from docs.generator.tables import TABLES
from tests.castx.case.fields.samples import KnownState

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
    of_pairs = ("contact_pressure", "gap", "heat_transfer_coefficient", "wall_suction")
    assert probed(FieldPlace.PAIR) == of_pairs
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


def rows(text, name):
    """Return the cells of the table of a name in a page, by what the first one names."""
    table = re.search(rf"<!-- table: {name} -->\n(.*?)<!-- end of table -->", text, re.S)
    assert table is not None, f"the page has no table of {name}"
    lines = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table[1].splitlines()]
    return {cells[0].strip("`"): cells[1:] for cells in lines[2:]}


MANUAL = (PROJECT / "docs/manual/results.md").read_text()
FRESH = "".join(
    f"<!-- table: {name} -->\n{TABLES[name]()}<!-- end of table -->\n"
    for name in ("output fields", "probe quantities")
)


@pytest.mark.parametrize("page", [MANUAL, FRESH], ids=["manual", "generated"])
@pytest.mark.parametrize("name", output_fields())
def test_every_field_stands_in_the_table_of_the_manual(page, name):
    field, found = output_fields()[name], rows(page, "output fields")
    cure = "run bin/with-fenicsx python3 -m docs.generator.tables"
    assert name in found, f"docs/manual/results.md lacks {name!r}: {cure}"
    title, unit, place, mechanical = found[name]
    assert (title, unit) == (field.title, field.unit)
    assert place.split(",")[0] == field.place.value and (mechanical == "yes") == field.mechanical
    quantities = rows(page, "probe quantities")
    recorded = quantities["an interface" if field.place is FieldPlace.PAIR else "a body"][0]
    assert (f"`{name}`" in recorded) == (field.dimension is not None)


def test_the_example_for_contributors_is_a_whole_field():
    """Uniaxial tension has a triaxiality of 1/3, pressure alone none, since it has no deviator."""
    text = (PROJECT / "CONTRIBUTING.md").read_text().partition("## An output field\n")[2]
    example = re.search(r"```python\n(.*?)```", text, re.S)
    assert example is not None
    defined = {"__name__": "example"}
    exec(compile(example[1], "CONTRIBUTING.md", "exec"), defined)
    (field,) = defined["FIELDS"]
    assert field.omissions() == [] and field.name not in output_fields()
    state = KnownState()
    state.tensors = np.array([[6e6, 0, 0, 0, 0, 0], [0, -3e6, 0, 0, 0, 0], [5e6] * 3 + [0] * 3])
    assert field.values(state) == pytest.approx([1 / 3, -1 / 3, 0.0])
