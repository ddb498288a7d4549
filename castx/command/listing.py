"""Tables for the terminal: materials, interfaces, all numbers of one of them, versions in use."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from castx.environment import versions
from castx.input.variation import ARGUMENTS
from castx.materials.database import database_entry, database_names
from castx.materials.description import MaterialDescription
from castx.materials.inelastic import FLOW_RULES
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.materials.sources import Property, numbers, unit_of
from castx.report.interface_law import heat_transfer_coefficient
from castx.results.files.folder import RECORD
from castx.results.files.run_json import read_record
from castx.transfer.database import (
    SourcedNumber,
    interface_entry,
    interface_names,
    plain_numbers,
)

WIDTH = 48
"""Characters that a line of a table may have beside the names, in a terminal of 80 columns."""

OPEN_GAP = 1e-4
"""Gap for which the list of interfaces shows the coefficient [m]."""

DATA = {
    "h": ("heat", ("density", "heat_capacity", "conductivity")),
    "e": ("elastic", ("young_modulus", "poisson_ratio", "expansion")),
    "p": ("plastic", ("yield_stress",)),
    "c": ("creep", ()),
    "l": ("liquid", ("liquid",)),
}
"""Kinds of data by letter, with the keys that they need; creep needs the keys of any flow rule."""


def material_list(case_materials: Mapping[str, MaterialDescription]) -> Group:
    """Return the table of all materials: class, freezing range, kinds of data, summary.

    Args:
        case_materials: of a case, listed first; empty for the database alone.
    """
    table = Table("material", "class", "freezes, °C", "data", box=SIMPLE_HEAD, pad_edge=False)
    for column in table.columns:
        column.no_wrap = True
    table.add_column("is")
    for name in [*case_materials, *(n for n in database_names() if n not in case_materials)]:
        material = find_material(name, case_materials)
        if name in case_materials:
            group, what = "", origin_text(case_materials[name])
        else:
            group, what = database_entry(name).material_class, database_entry(name).summary
        table.add_row(name, group, freezing_text(material), data_text(material), what)
    legend = ", ".join(f"{letter} {kind}" for letter, (kind, _) in DATA.items())
    return Group(table, Text(f"data: {legend}; all numbers of one: castx materials NAME"))


def origin_text(description: MaterialDescription) -> str:
    """Return where a material of a case comes from."""
    parent = description.extends
    return "of the case" + (f", extends {parent}" if parent else "")


def freezing_text(material: Material) -> str:
    """Return where a material freezes [°C]."""
    if material.solidus is None or material.liquidus is None:
        return "–"
    if material.solidus == material.liquidus:
        return f"{material.solidus:g}"
    return f"{material.solidus:g} to {material.liquidus:g}"


def data_text(material: Material) -> str:
    """Return the letters of the kinds of data that a material has, a dot for each one missing."""
    description = material.description
    has = {
        letter: all(getattr(description, key) is not None for key in keys)
        for letter, (_, keys) in DATA.items()
    }
    has["c"] = any(
        all(getattr(description, key) is not None for key in rule.needed)
        for rule in FLOW_RULES.values()
    )
    return "".join(letter if given else "·" for letter, given in has.items())


def material_table(name: str, case_materials: Mapping[str, MaterialDescription]) -> Group:
    """Return all numbers of a material, and their sources below.

    Args:
        name: of the case or the database.
        case_materials: of a case; empty for the database alone.

    Raises:
        CaseError: there is no such material.
    """
    properties = find_material(name, case_materials).properties()
    spreads = (item.spread.source for item in properties if item.spread)
    sources = list(dict.fromkeys([*(item.source for item in properties), *spreads]))
    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    grid.add_column(no_wrap=True)
    for item in properties:
        heading = Text(item.name, style="bold")
        heading.append(f" [{sources.index(item.source) + 1}]", style="not bold")
        if item.valid is not None:
            heading.append(f"\n  {item.valid[0]:g} to {item.valid[1]:g} °C", style="not bold dim")
        if item.spread is not None:
            number = sources.index(item.spread.source) + 1
            heading.append(f"\n  {spread_text(item)} [{number}]", style="not bold dim")
        grid.add_row(heading, value_text(item))
    notes = [Text(f"[{number}] {source}") for number, source in enumerate(sources, start=1)]
    parts: list[RenderableType] = [title_text(name, case_materials), Text(), grid, Text(), *notes]
    return Group(*parts)


def title_text(name: str, case_materials: Mapping[str, MaterialDescription]) -> Text:
    """Return a heading: name and summary."""
    own = name in case_materials
    what = origin_text(case_materials[name]) if own else database_entry(name).summary
    return Text.assemble((name, "bold"), f": {what}")


def spread_text(item: Property) -> str:
    """Return the range of a property in the unit in which it is shown, or factors; "" if none."""
    if item.spread is None:
        return ""
    known = unit_of(item.name)
    factor = 1.0 if item.spread.by_factor or known is None else known.factor
    low, high = number_text(item.spread.low * factor), number_text(item.spread.high * factor)
    return f"{'times ' if item.spread.by_factor else ''}{low} to {high}"


def value_text(item: Property) -> Text:
    """Return a number with its unit, or a table as lines of temperatures over lines of values."""
    known = unit_of(item.name)
    unit, factor = (known.people, known.factor) if known else (item.unit, 1.0)
    cells = []
    for at, value in numbers(item.value):
        shown = value if isinstance(value, str) else number_text(value * factor)
        cells.append(("" if at is None else f"{at:.5g}", shown))
    return cells_text(cells, unit)


def cells_text(cells: Sequence[tuple[str, str]], unit: str, head: str = "°C") -> Text:
    """Return a number with its unit, or lines of arguments over lines of values.

    Args:
        cells: arguments and values, as text; of a single number the argument is "".
        unit: of the values.
        head: unit of the arguments.
    """
    if not cells[0][0]:
        return Text(f"{cells[0][1]} {unit}")
    label = max(len(unit), len(head))
    width = max(len(text) for cell in cells for text in cell) + 2
    columns = max((WIDTH - label) // width, 1)
    lines = []
    for start in range(0, len(cells), columns):
        part = cells[start : start + columns]
        line = head.ljust(label) + "".join(at.rjust(width) for at, _ in part)
        lines.append(Text(line, style="dim"))
        lines.append(Text(unit.ljust(label) + "".join(v.rjust(width) for _, v in part)))
    return Text("\n").join(lines)


def number_text(value: float) -> str:
    """Return a number with five digits, without the noise of a change of units."""
    return f"{value:.5g}"


def interface_list() -> Group:
    """Return the table of all interfaces: coefficient closed and open, and a summary."""
    table = Table("interface", box=SIMPLE_HEAD, pad_edge=False)
    for column in ("closed", f"{1e3 * OPEN_GAP:g} mm"):
        table.add_column(column, justify="right", no_wrap=True)
    table.add_column("is")
    table.columns[0].no_wrap = True
    for name in interface_names():
        entry = interface_entry(name)
        h = heat_transfer_coefficient(entry.heat, gap=[0.0, OPEN_GAP])
        coefficients = (f"{value:.3g}" if value < 1e3 else f"{value:.0f}" for value in h)
        table.add_row(name, *coefficients, f"{entry.summary}; {entry.process}")
    legend = (
        "coefficients in W/m²/K, without radiation; all numbers of one: castx interfaces NAME; "
        'in a case: heat = { from = "NAME" }'
    )
    return Group(table, Text(legend))


def interface_table(name: str) -> Group:
    """Return all numbers of an interface of the database, and their sources below.

    Raises:
        CaseError: there is no such interface.
    """
    entry = interface_entry(name)
    sources = list(dict.fromkeys(number.source for number in entry.numbers))
    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    grid.add_column(no_wrap=True)
    for number in entry.numbers:
        heading = Text(number.name, style="bold")
        heading.append(f" [{sources.index(number.source) + 1}]", style="not bold")
        if number.ranges:
            heading.append(f"\n  {ranges_text(number)}", style="not bold dim")
        grid.add_row(heading, sourced_text(number))
    about = (entry.alloy, entry.mould, entry.layer, entry.process)
    labels = ("alloy", "mould", "between them", "process")
    lines = [Text(f"{label}: {text}") for label, text in zip(labels, about, strict=True)]
    title = Text.assemble((name, "bold"), f": {entry.summary}")
    notes = [Text(f"[{at}] {source}") for at, source in enumerate(sources, start=1)]
    return Group(title, *lines, Text(), grid, Text(), *notes)


def ranges_text(number: SourcedNumber) -> str:
    """Return the ranges of a number."""
    factor, unit = (1e6, " µm") if number.unit == "m" else (1.0, "")
    each = (f"{low * factor:g} to {high * factor:g}" for low, high in number.ranges)
    return ", ".join(each) + unit


def sourced_text(number: SourcedNumber) -> Text:
    """Return a number with its unit, several of them, or a table as lines."""
    if isinstance(number.value, str):
        return Text(number.value)
    factor, unit = (1e6, "µm") if number.unit == "m" else (1.0, number.unit)
    values = [number_text(factor * value) for value in plain_numbers(number.value)]
    if not isinstance(number.value, dict):
        return Text(f"{', '.join(values)} {unit}".strip())
    over = number.value["over"]
    head = ARGUMENTS[over].dimension.shown
    arguments = (f"{row[0]:.5g}" for row in number.value["table"])
    return cells_text(list(zip(arguments, values, strict=True)), unit, head)


def profile_table(folder: Path) -> Table:
    """Return the table of costs of the parts of a run, from its run.json.

    Args:
        folder: the results of a run with a profile.
    """
    table = Table("part", box=SIMPLE_HEAD, pad_edge=False)
    costs = read_record(folder / RECORD).get("profile", {})
    total = sum(cost["time"] for cost in costs.values())
    several = any(cost["messages"] for cost in costs.values())
    columns = ("time, s", "share, %", "mean rank, %", "Gflop/s")
    for column in (*columns, *(("messages", "MB", "sums") if several else ())):
        table.add_column(column, justify="right")
    for part, cost in costs.items():
        time = cost["time"]
        share, mean = 100 * _over(time, total), 100 * _over(cost["mean_time"], time)
        speed = 1e-9 * _over(cost["flops"], time)
        sent, sums = 1e-6 * cost["sent"], cost["reductions"]
        traffic = f"{cost['messages']:.0f}", f"{sent:.1f}", f"{sums:.0f}"
        numbers = f"{time:.2f}", f"{share:.1f}", f"{mean:.0f}", f"{speed:.2f}"
        table.add_row(part, *numbers, *(traffic if several else ()))
    return table


def _over(part: float, whole: float) -> float:
    return part / whole if whole > 0 else 0.0


def version_table() -> Table:
    """Return the versions of castx and of its dependencies."""
    table = Table("package", "version", box=SIMPLE_HEAD)
    for package, version in versions().items():
        table.add_row(package, version)
    return table
