"""Processes of the database: each number has a unit and a source, and faults are named."""

from copy import deepcopy

import pytest

from castx.case.processes.names import process_names
from castx.case.processes.process import casting_process, read_process, refuse_options
from castx.errors import CaseError
from castx.materials.database import database_entry, database_names
from castx.transfer.database import interface_entry

pytestmark = pytest.mark.serial

NUMBER = {"value": 20, "unit": "K", "source": "usual"}
CONTENT = {
    "summary": "s", "alloy": "AlSi7Mg", "mould": "steel-H13", "mould_law": "rigid",
    "release": "opens", "interfaces": {"aluminium": "aluminium-steel-coated"},
    "superheat": NUMBER, "mould_temperature": NUMBER | {"unit": "°C"},
    "ambient": NUMBER | {"unit": "°C"}, "wall": {"value": 0.2, "source": "usual"},
    "outside_coefficient": NUMBER | {"unit": "W/m²/K"},
    "air_coefficient": NUMBER | {"unit": "W/m²/K"},
    "release_factor": {"value": 2, "source": "usual"},
}  # fmt: skip


@pytest.mark.parametrize("name", process_names())
def test_what_a_process_names_is_in_the_databases(name):
    process = casting_process(name)
    assert process.name == name
    assert set(process.sources) == set(process.numbers) and all(process.sources.values())
    assert database_entry(process.alloy).material_class in process.interfaces
    assert process.mould in database_names() or process.material
    for of_class, entry in process.interfaces.items():
        found = interface_entry(entry)
        assert found.alloy in (of_class, {"copper": "bronze"}.get(of_class)), entry


def test_numbers_are_read():
    process = read_process("mine", CONTENT, "mine.toml")
    assert process.numbers["superheat"] == 20.0 and process.sources["wall"] == "usual"
    assert (process.mould, process.material) == ("steel-H13", {})


def test_a_class_of_alloys_has_numbers_of_its_own():
    own = {"superheat": NUMBER | {"value": 35, "source": "a book"}}
    process = read_process("mine", CONTENT | {"classes": {"aluminium": own}}, "mine.toml")
    of_class = process.of_class("aluminium")
    assert process.name == of_class.name == "mine"
    assert (of_class.numbers["superheat"], of_class.sources["superheat"]) == (35.0, "a book")
    assert of_class.numbers["ambient"] == 20.0
    assert process.of_class("zinc") == process and process.numbers["superheat"] == 20.0


@pytest.mark.parametrize(
    "path, value, text",
    [
        (("superheat",), None, "superheat: missing"),
        (("superheat", "source"), "", "source"),
        (("superheat", "unit"), "degC", 'superheat.unit.*must be "K"'),
        (("wall",), None, "wall: either this or shell is needed"),
        (("shell",), {"value": 1, "unit": "m", "source": "usual"}, "either this or shell"),
        (
            ("mould_length",),
            {"value": 1, "unit": "m", "source": "usual"},
            "release_factor: either this or release_temperature or mould_length",
        ),
        (("foot_water",), NUMBER | {"unit": "L"}, 'foot_water.unit.*must be "L/m²/s"'),
        (("summary",), "", "summary.*missing"),
        (("superheet",), NUMBER, "superheet: unknown key"),
        (("refuses",), {"tops": "so"}, 'refuses.tops.*no option; known: split, top .*mean "top"'),
        (("refuses",), {"top": ""}, 'refuses.top = "": the reason in quotes'),
        (("classes",), {"zinc": {"superheat": NUMBER}}, "classes.zinc.superheat.*an interface"),
        (("classes",), {"aluminium": {"shell": NUMBER}}, "classes.aluminium.shell.*of a number"),
        (
            ("classes",),
            {"aluminium": {"superheat": NUMBER | {"source": ""}}},
            "classes.aluminium.superheat.source",
        ),
    ],
)
def test_faults_are_named(path, value, text):
    content = deepcopy(CONTENT)
    inner = content
    for key in path[:-1]:
        inner = inner[key]
    if value is None:
        del inner[path[-1]]
    else:
        inner[path[-1]] = value
    with pytest.raises(CaseError, match=text):
        read_process("mine", content, "mine.toml")


def test_a_strand_needs_its_numbers():
    length = {"value": 0.7, "unit": "m", "source": "usual"}
    content = {key: item for key, item in CONTENT.items() if key != "release_factor"}
    with pytest.raises(CaseError, match="speed_factor: missing; a strand needs it") as caught:
        read_process("mine", content | {"mould_length": length}, "mine.toml")
    assert "upper_water: missing" in str(caught.value) and "taper: missing" in str(caught.value)
    strands = [name for name in process_names() if casting_process(name).is_strand]
    assert strands == ["continuous"]


def test_what_a_process_cannot_have_is_refused_with_the_reason_and_others():
    process = read_process("mine", CONTENT | {"refuses": {"split": "it is one piece"}}, "mine.toml")
    refuse_options(process, ["top"])
    refuse_options(process, [])
    with pytest.raises(CaseError, match=r"--split: not with mine: it is one piece; .*sand$"):
        refuse_options(process, ["top", "split"])


def test_an_unknown_process_is_refused_with_those_there_are():
    with pytest.raises(CaseError, match=r"no process 'sandd'.*sand"):
        casting_process("sandd")
