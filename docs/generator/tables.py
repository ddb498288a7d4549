"""Tables of the manual that follow from the registries and the database.

A table stands in a page between `<!-- table: NAME -->` and `<!-- end of table -->`. Run
`python3 -m docs.generator.tables` to write all of them anew; `tests/test_docs.py` compares them.
"""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Protocol

from castx.case.fields.declaration import FieldPlace, OutputField
from castx.case.fields.registry import output_fields, probed
from castx.case.geometry import GENERATORS
from castx.contact.methods.registry import method_table
from castx.input.sourced import UNKNOWN_SOURCE
from castx.materials.database import database_entry, database_names
from castx.materials.inelastic import FLOW_RULES, HARDENING_RULES, RuleRow, rule_table
from castx.meshes.generators.declaration import MODELS, Generator
from castx.report.interface_law import heat_transfer_coefficient
from castx.transfer.conditions.registry import heat_conditions
from castx.transfer.database import SourcedNumber, interface_entry, interface_names
from castx.transfer.declaration import HeatKey
from castx.transfer.registry import law_table

PROJECT = Path(__file__).parents[2]
_MARKED = re.compile(r"(<!-- table: ([\w ]+) -->\n).*?(<!-- end of table -->)", re.S)


def contact_methods() -> str:
    """Return the table of all contact methods."""
    rows = [
        (f"`{row.name}`", row.summary.rstrip("."), _names(row.keys), row.advice)
        for row in method_table()
    ]
    return _table(("`method`", "closed pairs", "keys", "use it"), rows)


def contact_method_equations() -> str:
    """Return the formulas of all contact methods and where they stand."""
    return _equations(method_table(), "castx/contact/methods")


def heat_laws() -> str:
    """Return the table of all gap heat laws."""
    rows = [
        (
            f"`{row.name}`",
            f"{row.formula}<br>{row.summary}",
            _keys(row.needed.split(", ")),
            _keys(row.useful.split(", ")),
        )
        for row in law_table()
    ]
    return _table(("`law`", "h [W/m²/K]", "keys that it needs", "keys that it may use"), rows)


def heat_law_equations() -> str:
    """Return the formulas of all gap heat laws and where they stand."""
    return _equations(law_table(), "castx/transfer/laws")


def surface_heat_conditions() -> str:
    """Return the table of all heat conditions of surfaces."""
    rows = [
        (f"`{kind.name}`", f"{kind.formula}<br>{kind.summary}", "<br>".join(_meanings(kind.keys)))
        for kind in heat_conditions().values()
    ]
    return _table(("`type`", "flux q into the body [W/m²], or temperature", "keys"), rows)


def _meanings(keys: Iterable[HeatKey[object]]) -> Iterator[str]:
    for key in keys:
        default = "" if key.default is None else f" = {key.default:g}"
        yield f"{_keys([key.text])}{default}: {key.meaning}"


def heat_condition_equations() -> str:
    """Return the formulas of all heat conditions and where they stand."""
    return _equations(heat_conditions().values(), "castx/transfer/conditions")


def generators() -> str:
    """Return the table of all generators of meshes."""
    rows = []
    for name, generator in GENERATORS.items():
        models = ", ".join(f'`"{model}"`' for model in generator.models)
        surfaces = "<br>".join(
            f"{body}: {_names(surfaces)}" for body, surfaces in generator.surfaces.items()
        )
        what = f"{generator.summary}<br>{'all models' if generator.models == MODELS else models}"
        rows.append((f"`{name}`", what, "<br>".join(_arguments(generator)), surfaces))
    return _table(("`generator`", "what it is", "arguments", "bodies and surfaces"), rows)


def _arguments(generator: Generator) -> Iterator[str]:
    """Yield the arguments of a generator with their defaults and the models that have them."""
    parameters = inspect.signature(generator.mesh).parameters
    for name, argument in generator.arguments.items():
        default = parameters[name].default
        given = default is inspect.Parameter.empty or default is None
        value = "" if given else f" = {json.dumps(default)}"
        models = argument.needed if given else argument.models
        only = [model for model in generator.models if model in models]
        where = "" if len(only) == len(generator.models) else f" ({', '.join(only)})"
        yield f"`{name}`{value}: {argument.meaning}{where}"


class _Row(Protocol):
    """A row of a registry."""

    @property
    def name(self) -> str: ...
    @property
    def formula(self) -> str: ...
    @property
    def source(self) -> str: ...


def _equations(rows: Iterable[_Row], folder: str) -> str:
    return _table(
        ("name", "formula", "source", "where"),
        (
            (f"`{row.name}`", row.formula, row.source, f"`{folder}/{_file(row.name)}.py`")
            for row in rows
        ),
    )


def _file(name: str) -> str:
    return name.replace("-", "_")


def flow_rules() -> str:
    """Return the table of all flow rules."""
    return _rules(rule_table(iter(FLOW_RULES.values())), "`law` of the material", "rate of ξ")


def hardening_rules() -> str:
    """Return the table of all hardening rules."""
    return _rules(rule_table(iter(HARDENING_RULES)), "rule", "hardening")


def flow_rule_equations() -> str:
    """Return the formulas of all flow rules and where they stand."""
    return _equations(rule_table(iter(FLOW_RULES.values())), "castx/materials/flow_rules")


def hardening_rule_equations() -> str:
    """Return the formulas of all hardening rules and where they stand."""
    return _equations(rule_table(iter(HARDENING_RULES)), "castx/materials/hardening")


def _rules(rows: Iterable[RuleRow], first: str, what: str) -> str:
    return _table(
        (first, what, "keys"),
        (
            (f"`{row.name}`", f"{row.formula}<br>{row.summary}", _keys(row.keys))
            for row in rows
        ),
    )


def materials() -> str:
    """Return the table of the materials of the database, by class."""
    entries = {name: database_entry(name) for name in database_names()}
    names = sorted(entries, key=lambda name: (entries[name].material_class, name))
    rows = [(f"`{name}`", entries[name].material_class, entries[name].summary) for name in names]
    return _table(("material", "class", "what it is"), rows)


def interfaces() -> str:
    """Return the table of the interfaces of the database."""
    rows = []
    for name in interface_names():
        entry = interface_entry(name)
        closed, opened = heat_transfer_coefficient(entry.heat, gap=[0.0, 1e-4])
        number = next((number for number in entry.numbers if number.name == "closed"), None)
        what = f"{entry.summary}; {entry.process}"
        rows.append(
            (f"`{name}`", what, entry.heat["law"], f"{closed:.0f}", _range(number), f"{opened:.0f}")
        )
    head = ("`from`", "what it is", "law", "closed [W/m²/K]", "range", "at 0.1 mm")
    return _table(head, rows)


def fields() -> str:
    """Return the table of all output fields."""
    rows = [
        (
            f"`{field.name}`",
            field.title,
            field.unit,
            _place(field),
            "yes" if field.mechanical else "–",
        )
        for field in output_fields().values()
    ]
    return _table(("field", "what it is", "unit", "values at", "needs mechanics"), rows)


def _place(field: OutputField) -> str:
    """Return where a field has its values; tensors have six of them there."""
    place = "" if field.place is None else field.place.value
    return f"{place}, 6 parts" if field.components == 6 else place


def probe_quantities() -> str:
    """Return the table of what probes record on bodies and on interfaces."""
    on_bodies = probed(FieldPlace.NODE, FieldPlace.CELL)
    rows = [("a body", _names(on_bodies)), ("an interface", _names(probed(FieldPlace.PAIR)))]
    return _table(("on", "quantities"), rows)


def _range(number: SourcedNumber | None) -> str:
    """Return the range of a number, marked where the number has a source."""
    if number is None:
        return "from its layers"
    low, high = number.ranges[0]
    mark = "" if number.source.startswith(UNKNOWN_SOURCE) else "✓ "
    return f"{mark}{low:g} to {high:g}"


def _keys(texts: Iterable[str]) -> str:
    """Return keys, some with units and defaults, such as "exponent = 1", as code and text."""
    return ", ".join(re.sub(r"^\w+", r"`\g<0>`", text) for text in texts if text) or "–"


def _names(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names) or "–"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(_cell(text) for text in line) + " |\n" for line in lines)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


TABLES: dict[str, Callable[[], str]] = {
    "contact methods": contact_methods,
    "contact method equations": contact_method_equations,
    "heat laws": heat_laws,
    "heat law equations": heat_law_equations,
    "generators": generators,
    "heat conditions": surface_heat_conditions,
    "heat condition equations": heat_condition_equations,
    "flow rules": flow_rules,
    "flow rule equations": flow_rule_equations,
    "hardening rules": hardening_rules,
    "hardening rule equations": hardening_rule_equations,
    "materials": materials,
    "interfaces": interfaces,
    "output fields": fields,
    "probe quantities": probe_quantities,
}


def with_tables(text: str) -> str:
    """Return a page with its tables written anew.

    Raises:
        KeyError: there is no table of a name.
    """
    return _MARKED.sub(lambda found: f"{found[1]}{TABLES[found[2]]()}{found[3]}", text)


def pages() -> list[Path]:
    """Return the pages that may hold tables."""
    return sorted((PROJECT / "docs").glob("*.md")) + sorted((PROJECT / "docs/manual").glob("*.md"))


def write_tables() -> None:
    """Write all tables anew in their pages."""
    for path in pages():
        text = path.read_text()
        if (fresh := with_tables(text)) != text:
            path.write_text(fresh)


if __name__ == "__main__":
    write_tables()
