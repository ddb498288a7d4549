"""A material by its name: of the case first, then of the database."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from castx.errors import CaseError
from castx.input.problems import Refusal, among, refuse
from castx.materials.database import Entry, database_entry, database_names
from castx.materials.description import ALLOY_LAWS, MaterialDescription
from castx.materials.inelastic import RATE_KEYS
from castx.materials.material import Material
from castx.materials.sources import Source

LONGEST_CHAIN = 20
"""Materials that may extend each other one after the other."""


def find_material(
    name: str, case_materials: Mapping[str, MaterialDescription] = MappingProxyType({})
) -> Material:
    """Return a material by its name, completed by the material that it extends.

    `extends` may name a material of the case or of the database; the material of the case that
    bears the name of a database entry and extends it stands in its place.

    >>> import castx
    >>> alloy = castx.find_material("AlSi7Mg")
    >>> alloy.solidus, alloy.liquidus, alloy.description.density
    (557.0, 613.0, 2680.0)

    Args:
        name: as in `bodies[…].material`.
        case_materials: the `[materials]` of the case; empty: the database alone.

    Raises:
        CaseError: no such material.
        Refusal: a circle of `extends`, a long chain, one that is not known, or properties that do
            not fit together; paths start with ("materials", name).
    """
    if name not in case_materials and name not in database_names():
        raise CaseError(f"unknown material {name!r}; {among(name, _known(case_materials))}")
    entry = _resolve(name, case_materials)
    return Material(name, entry.description, entry.sources)


def _resolve(name: str, case_materials: Mapping[str, MaterialDescription]) -> Entry:
    """Return a complete material; only the last of a chain is checked as a whole."""
    chain, base = _chain(name, case_materials)
    if base is not None:
        entry = database_entry(base)
    else:
        entry = Entry("", "", case_materials[chain.pop()], {})
    for link in reversed(chain):
        properties, sources = _merged(case_materials[link], entry)
        if link == name:
            try:
                description = MaterialDescription.read(properties)
            except Refusal as refusal:
                raise refusal.inside("materials", name) from None
        else:
            description = MaterialDescription.model_construct(set(properties), **properties)
        entry = Entry(entry.summary, entry.material_class, description, sources)
    return entry


def _chain(
    name: str, case_materials: Mapping[str, MaterialDescription]
) -> tuple[list[str], str | None]:
    """Return the materials of the case that extend each other, and the database entry behind them.

    The first is the one asked for. There is no entry where the last one stands alone.
    """
    chain: list[str] = []
    link = name
    while link in case_materials and link not in chain:
        chain.append(link)
        parent = case_materials[link].extends
        if parent is None:
            return chain, None
        if len(chain) > LONGEST_CHAIN:
            text = f"more than {LONGEST_CHAIN} materials extend each other; shorten the chain"
            raise refuse(text, "materials", name, "extends")
        link = parent
    if link not in database_names():
        text = (
            f"a circle: {' → '.join((*chain, link))}; one of them must stand alone"
            if link in chain
            else f"unknown material {link!r}; {among(link, _known(case_materials))}"
        )
        raise refuse(text, "materials", chain[-1], "extends")
    return chain, link


def _merged(
    own: MaterialDescription, parent: Entry
) -> tuple[dict[str, Any], dict[str, Source]]:
    """Return the properties of the parent with the given ones in place of its own, and sources."""
    given = own.model_fields_set - {"extends"}
    left_out = {"extends"} | given | _replaced(own, parent.description)
    kept = parent.description.model_fields_set - left_out
    properties: dict[str, Any] = {key: getattr(parent.description, key) for key in kept}
    properties |= {key: getattr(own, key) for key in given}
    sources = {
        key: source for key, source in parent.sources.items() if key.partition(".")[0] in kept
    }
    return properties, sources


def _known(case_materials: Mapping[str, MaterialDescription]) -> list[str]:
    return sorted({*case_materials, *database_names()})


def _replaced(own: MaterialDescription, parent: MaterialDescription) -> set[str]:
    """Return the keys of the parent that a new law of flow or of solidification takes away.

    Without a liquid nothing feeds, and all of the parent's shrinkage would strain the solid.
    """
    flow = set(RATE_KEYS) if "law" in own.model_fields_set and own.law != parent.law else set()
    if "liquid" in own.model_fields_set and own.liquid is None:
        flow.add("solidification_shrinkage")
    if "solid_fraction" not in own.model_fields_set or own.solid_fraction in ALLOY_LAWS:
        return flow
    replaced = flow | {"partition_coefficient", "melting_point"}
    return replaced if isinstance(own.solid_fraction, str) else replaced | {"solidus", "liquidus"}
