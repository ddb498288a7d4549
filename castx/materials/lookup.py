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
        Refusal: a circle of `extends`, one that is not known, or properties that do not fit
            together; paths start with ("materials", name).
    """
    if name not in case_materials and name not in database_names():
        raise CaseError(f"unknown material {name!r}; {among(name, _known(case_materials))}")
    entry = _resolve(name, case_materials, ())
    return Material(name, entry.description, entry.sources)


def _resolve(
    name: str, case_materials: Mapping[str, MaterialDescription], below: tuple[str, ...]
) -> Entry:
    """Return a complete material; `below` names the materials of the case that extend it."""
    if name not in case_materials or name in below:
        return database_entry(name)
    own = case_materials[name]
    parent = own.extends
    if parent is None:
        return Entry("", "", own, {})
    chain = (*below, name)
    in_case = parent in case_materials and parent not in chain
    if not in_case and parent not in database_names():
        circle = " → ".join((*chain, parent))
        text = (
            f"a circle: {circle}; one of them must stand alone"
            if parent in chain
            else f"unknown material {parent!r}; {among(parent, _known(case_materials))}"
        )
        raise refuse(text, "materials", name, "extends")
    return _merge(name, own, _resolve(parent, case_materials, chain))


def _merge(name: str, own: MaterialDescription, parent: Entry) -> Entry:
    """Return the parent with the given properties in place of its own."""
    given = own.model_fields_set - {"extends"}
    left_out = {"extends"} | given | _replaced(own, parent.description)
    kept = parent.description.model_fields_set - left_out
    properties: dict[str, Any] = {key: getattr(parent.description, key) for key in kept}
    properties |= {key: getattr(own, key) for key in given}
    try:
        description = MaterialDescription.read(properties)
    except Refusal as refusal:
        raise refusal.inside("materials", name) from None
    sources: dict[str, Source] = {
        key: source for key, source in parent.sources.items() if key.partition(".")[0] in kept
    }
    return Entry(parent.summary, parent.material_class, description, sources)


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
