"""Registries: declarations are found by walking a package, and incomplete ones refused."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from castx.input.registry import declarations, modules_of, refuse_incomplete

pytestmark = pytest.mark.serial


@dataclass
class Rule:
    name: str
    text: str = ""


FILE = "from tests.castx.input.test_registry import Rule\n"


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Return what writes files of a package that can be imported, by its name."""
    monkeypatch.syspath_prepend(tmp_path)

    def write(name: str, **files: str) -> str:
        (tmp_path / name).mkdir()
        for file, text in {"__init__": "", **files}.items():
            (tmp_path / name / f"{file}.py").write_text(FILE + text)
        return name

    return write


def test_files_are_found_in_the_order_of_their_names(package):
    name = package("rules_in_order", second_one='RULE = Rule("second-one")', a='RULE = Rule("a")')
    found = declarations(name, "RULE", _class_of(name))
    assert list(found) == ["a", "second-one"]


def _class_of(package: str) -> type:
    from importlib import import_module

    return import_module(f"{package}.a").Rule


@pytest.mark.parametrize(
    "text, message",
    [
        ("", "rules_{}.b declares no RULE = Rule"),
        ("RULE = 5", "rules_{}.b declares no RULE = Rule"),
        ('RULE = Rule("c")', "rules_{}.b: RULE.name is 'c', not 'b' as its file is called"),
        ('RULE = Rule(text="d")', "^rules_{}.b: .*missing 1 required .* argument: 'name'"),
    ],
)
def test_a_file_without_its_declaration_is_refused(package, text, message):
    number = abs(hash(text))
    name = package(f"rules_{number}", a='RULE = Rule("a")', b=text)
    with pytest.raises(TypeError, match=message.format(number)):
        declarations(name, "RULE", _class_of(name))


def test_what_is_missing_is_named():
    with pytest.raises(TypeError, match=r"^the rule 'a' declares no text, no name$"):
        refuse_incomplete("the rule 'a'", Rule(""), ("text", "name"))
    refuse_incomplete("the rule 'a'", Rule("a", "b"), ("text", "name"))


def test_modules_come_in_order_without_those_left_out():
    package = "castx.contact.methods"
    found = [module.__name__ for module in modules_of(package, ("description", "registry"))]
    assert f"{package}.penalty" in found and f"{package}.registry" not in found
    assert found == sorted(found)
    assert len(list(modules_of(package))) == len(found) + 2
