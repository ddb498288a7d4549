"""Docstrings as reStructuredText: what is text stays text, formulas and examples stay apart."""

import pytest

from docs.generator.docstrings import restructured

pytestmark = pytest.mark.serial


def test_code_is_marked_and_nothing_else():
    assert restructured("Take `a_b` times a* |x| n_ and n_m.") == (
        "Take ``a_b`` times a\\* \\|x\\| n\\_ and n_m."
    )


def test_formulas_stand_as_they_are():
    text = "The law is\n\n    q* = |x|\n\nwhere q* counts."
    assert restructured(text).split("::") == [
        "The law is\n\n\n",
        "\n\n    q* = |x|\n\nwhere q\\* counts.",
    ]


def test_a_formula_inside_a_paragraph_gets_room():
    assert restructured("with\n    a = b\nand more") == "with\n\n::\n\n    a = b\n\nand more"


def test_sections_are_left_to_napoleon():
    assert restructured("Do it.\n\nArgs:\n    x: |x| [m].") == (
        "Do it.\n\nArgs:\n    x: \\|x\\| [m]."
    )


def test_examples_stand_as_they_are():
    text = ">>> a = {\n...     'b': 1}\n>>> a\n{'b': 1} *\n\nText *"
    assert restructured(text) == text[:-1] + "\\*"
