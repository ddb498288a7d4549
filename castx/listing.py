"""Tables for the terminal: the materials of the database, and the versions in use."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Group
from rich.table import Table
from rich.text import Text

from castx.environment import versions
from castx.materials import database_entry, database_names, find_material


def material_list() -> Table:
    """Return the materials of the database with what they are and where they freeze."""
    table = Table("material", "freezes", "is", box=SIMPLE_HEAD)
    for name in database_names():
        material = find_material(name, {})
        table.add_row(name, freezing_text(name), database_entry(name).summary or material.name)
    return table


def freezing_text(name: str) -> str:
    """Return the freezing temperatures of a material of the database."""
    material = find_material(name, {})
    if material.solidus is None or material.liquidus is None:
        return "–"
    if material.solidus == material.liquidus:
        return f"{material.solidus:g} °C"
    return f"{material.solidus:g} to {material.liquidus:g} °C"


def material_table(name: str) -> Group:
    """Return all numbers of a material of the database, and their sources below.

    Raises:
        CaseError: there is no such material.
    """
    table = Table("property", "at", "value", "unit", "source", box=SIMPLE_HEAD, title=name)
    sources: list[str] = []
    before = ""
    for row in find_material(name, {}).rows():
        if row.source not in sources:
            sources.append(row.source)
        at = "" if row.temperature is None else f"{row.temperature:g} °C"
        value = row.value if isinstance(row.value, str) else f"{row.value:.6g}"
        number = str(sources.index(row.source) + 1)
        table.add_row(row.property if row.property != before else "", at, value, row.unit, number)
        before = row.property
    notes = [Text(f"{number}  {source}") for number, source in enumerate(sources, start=1)]
    return Group(table, *notes)


def version_table() -> Table:
    """Return the versions of castx and of what it runs on."""
    table = Table("package", "version", box=SIMPLE_HEAD)
    for package, version in versions().items():
        table.add_row(package, version)
    return table
