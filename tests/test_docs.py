"""The documentation says what the code does: places, formulas, tables, keys and links are right."""

from __future__ import annotations

import ast
import re
from html import unescape
from pathlib import Path

import pytest

from castx.case.case import Case
from castx.case.caveats import caveats
from castx.case.fields.registry import output_fields
from castx.case.geometry import GENERATORS
from castx.case.reading.read import load_case
from castx.contact.methods.registry import METHODS
from castx.input.entries import Description
from castx.materials.inelastic import FLOW_RULES, HARDENING_RULES
from castx.proof.foreign.registry import FOREIGN_CASES
from castx.proof.verification.registry import VERIFICATIONS
from castx.transfer.conditions.registry import heat_conditions
from castx.transfer.registry import gap_heat_laws
from docs.generator import api
from docs.generator.rooms import rooms, rows
from docs.generator.tables import pages, with_tables
from tests.test_architecture import ORDER

pytestmark = pytest.mark.serial

PROJECT = Path(__file__).parents[1]
DOCS = PROJECT / "docs"
WRITTEN = [
    *(PROJECT / name for name in ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md")),
    *pages(),
]
LONGEST_README = 130
MOST_ROWS = 20
ROW = re.compile(r"^\|[^|\n]*\|([^|\n]*)\| `([\w/]+\.py):?([\w.]*)` \|$", re.M)
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[\w-]*)?\)")
PLACE = re.compile(
    r"`((?:castx|forms|meshes|tests|demos|bench|bin|docs)/[\w/.-]*\.\w+)(?::[\w.]+)?`"
)
NAMES_OF_THE_FIRST_VERSION = """
condensed rigid multipliers augmented-lagrangian block-iterative exponential penalty tied
constant limited none perfect series solid-fraction
convection flux insulated radiation temperature
perzyna bingham garofalo norton linear prager voce
box_in_mould core_in_ring cylinder_in_mould slab stacked_blocks two_slabs
arm_spacing brittle_strain brittle_strain_index brittle_time clyne_davies cold_crack_index
contact_pressure cooling_rate deviation dimensionless_niyama displacement emptied enthalpy
feeding_path first_opening front_speed gap gradient heat_flux heat_transfer_coefficient
largest_principal_stress life modulus niyama passing_times plastic_strain point_stress pool
pore_fraction pressure smallest_principal_stress solid_fraction solidification_time strain_range
stress tearing_margin von_mises yield_strength
"""
"""Names of 0.1.0 in the registries: the changelog has no line for each."""
GENERATED = re.compile(r"(\.\./)?(notebooks|api)/")


def squeezed(text: str) -> str:
    return "".join(text.split()).replace("−", "-")


def docstring(path: Path, name: str) -> str:
    """Return the docstring of a class, function or method, without a name that of the file."""
    node: ast.AST = ast.parse(path.read_text())
    for part in name.split(".") if name else ():
        found = [
            child
            for child in getattr(node, "body", [])
            if isinstance(child, ast.ClassDef | ast.FunctionDef) and child.name == part
        ]
        if not found:
            return ""
        node = found[0]
    return ast.get_docstring(node) or ""  # type: ignore[arg-type]


def equation_rows() -> list[tuple[str, str, str]]:
    text = (DOCS / "equations.md").read_text()
    return [(formula.strip(), file, name) for formula, file, name in ROW.findall(text)]


def test_there_are_equations_of_every_section():
    text = (DOCS / "equations.md").read_text()
    assert len(equation_rows()) >= 45
    for section in ("2.1", "2.2", "2.3", "4", "5", "7", "8", "9.1", "9.2", "9.3"):
        assert re.search(rf"^## .*\b{re.escape(section)}\b", text, re.M), section


@pytest.mark.parametrize(("formula", "file", "name"), equation_rows())
def test_equations_stand_where_the_page_says(formula, file, name):
    path = PROJECT / file
    assert path.is_file(), f"docs/equations.md: there is no {file}"
    text = docstring(path, name)
    assert text, f"docs/equations.md: {file} has no {name} with a docstring"
    assert squeezed(formula) in squeezed(text), f"the docstring of {name} in {file} lacks {formula}"


def registered() -> list[str]:
    laws = (*gap_heat_laws(), *heat_conditions())
    return [*METHODS, *laws, *FLOW_RULES, *(rule.name for rule in HARDENING_RULES)]


@pytest.mark.parametrize(
    "page, name",
    [
        *((page, name) for page in ("equations.md", "manual") for name in registered()),
        *(("manual", name) for name in (*GENERATORS, *output_fields())),
    ],
)
def test_everything_registered_is_in_the_documentation(page, name):
    place = DOCS / page
    files = [place] if place.is_file() else sorted(place.glob("*.md"))
    text = "".join(path.read_text() for path in files)
    assert f"`{name}`" in text, (
        f"docs/{page} lacks {name!r}: run bin/with-fenicsx python3 -m docs.generator.tables"
    )


def test_the_changelog_names_every_law_rule_method_generator_and_field_since_the_first_version():
    first = set(NAMES_OF_THE_FIRST_VERSION.split())
    new = [name for name in [*registered(), *GENERATORS, *output_fields()] if name not in first]
    changelog = (PROJECT / "CHANGELOG.md").read_text()
    silent = [name for name in new if f"`{name}`" not in changelog]
    assert not silent, f"CHANGELOG.md, Unreleased, needs a line about {', '.join(silent)}"


@pytest.mark.parametrize("path", pages(), ids=lambda path: path.name)
def test_tables_follow_from_the_registries(path):
    text = path.read_text()
    assert with_tables(text) == text, "run bin/with-fenicsx python3 -m docs.generator.tables"


def case_file_keys(model: type[Description]) -> set[str]:
    """Return the keys of a description and of all descriptions in it."""
    found: set[str] = set()
    waiting: list[object] = [model]
    seen: set[object] = set()
    while waiting:
        item = waiting.pop()
        if item in seen:
            continue
        seen.add(item)
        waiting += getattr(item, "__args__", ())
        if isinstance(item, type) and issubclass(item, Description):
            found |= set(item.model_fields)
            waiting += [field.annotation for field in item.model_fields.values()]
    return found


def test_the_manual_has_every_key_of_the_case_file():
    text = "".join(path.read_text() for path in (DOCS / "manual").glob("*.md"))
    keys = case_file_keys(Case) - {"arguments", "cad"}
    assert len(keys) > 90
    assert not sorted(key for key in keys if not re.search(rf"\b{key}\b", text))


def test_the_case_of_the_readme_can_be_run(tmp_path):
    (case,) = re.findall(r"```toml\n(.*?)```", (PROJECT / "README.md").read_text(), re.DOTALL)
    (tmp_path / "case.toml").write_text(case)
    shown = load_case(tmp_path / "case.toml")
    assert [body.name for body in shown.bodies] == ["casting", "mould"]
    assert not list(caveats(shown))


def test_a_newcomer_finds_the_way_from_a_part_to_a_report_and_other_systems():
    start, install = ((PROJECT / "docs" / name).read_text() for name in ("index.md", "install.md"))
    first_row = next(line for line in start.splitlines() if line.startswith("| run it"))
    assert "(manual/cad_tutorial.md)" in first_row
    assert "(WSL 2)" in install and "## On a Mac" in install


@pytest.mark.parametrize(
    "words",
    [
        "heat transfer coefficient AlSi steel die",
        "stop run go on",
        "STEP file report",
        "how long run take",
        "ParaView fields",
    ],
)
def test_a_question_is_answered_in_a_paragraph_that_has_its_words(words):
    paragraphs = (PROJECT / "docs/manual/questions.md").read_text().lower().split("\n\n")
    assert [p for p in paragraphs if all(word.lower() in p for word in words.split())]


def test_the_search_leaves_out_the_pages_of_the_code(tmp_path, monkeypatch):
    monkeypatch.setattr(api, "PAGES", tmp_path)
    api.write_pages()
    pages = list(tmp_path.glob("*.rst"))
    assert len(pages) > 20
    assert not [path.name for path in pages if not path.read_text().startswith(":nosearch:\n\n")]


def test_the_readme_is_short():
    assert len((PROJECT / "README.md").read_text().splitlines()) <= LONGEST_README


def test_architecture_has_every_room_that_stands_at_the_top_in_few_rows():
    named = [room for row in rows() for room in row]
    order = [room for names in ORDER[1:-1] for room in names.split()]
    assert sorted(named) == sorted({room.partition("/")[0] for room in order})
    assert len(rows()) <= MOST_ROWS
    assert sorted(rooms()) == sorted(order)
    text = (PROJECT / "ARCHITECTURE.md").read_text()
    assert [name for name in ORDER[0].split() if f"`{name}`" not in text] == []


@pytest.mark.parametrize("path", WRITTEN, ids=lambda path: path.name)
def test_files_that_are_named_exist(path):
    named = set(PLACE.findall(path.read_text()))
    named = {name for name in named if "NAME" not in name}
    assert not sorted(name for name in named if not (PROJECT / name).exists())


@pytest.mark.parametrize("path", WRITTEN, ids=lambda path: path.name)
def test_links_lead_somewhere(path):
    links = [link for link in LINK.findall(path.read_text()) if "://" not in link]
    links = [link for link in links if not GENERATED.match(link)]
    assert not [link for link in links if not (path.parent / link).exists()]


def test_the_page_of_foreign_cases_has_all_of_them_and_misses_none():
    page = (DOCS / "static/foreign.html").read_text()
    shown = dict(re.findall(r'<h2 id="(\w+)">\w+ · (.+?)</h2>', page))
    expected = {number: case.title for number, case in FOREIGN_CASES.items()}
    assert {number: unescape(title) for number, title in shown.items()} == expected, (
        "run bin/with-fenicsx castx verify --foreign --output docs/static"
    )
    assert "missed" not in page


def test_the_page_of_the_verification_has_all_of_them_and_misses_none():
    page = (DOCS / "static/verification.html").read_text()
    shown = dict(re.findall(r'<h2 id="(\w+)">\w+ · (.+?)</h2>', page))
    expected = {number: verification.title for number, verification in VERIFICATIONS.items()}
    assert {number: unescape(title) for number, title in shown.items()} == expected, (
        "run bin/with-fenicsx castx verify --output docs/static"
    )
    assert "missed" not in page and "quick:" not in page
    assert len(page) < 1_500_000
