"""The normals that an interface takes where its case leaves them to castx."""

from __future__ import annotations

from castx.case.case import Case
from castx.case.contact import AUTOMATIC, AVERAGED, NONE, PATCHES, InterfaceContact, is_tied
from castx.case.interfaces import Interface
from castx.materials.lookup import find_material


def with_normals(case: Case) -> tuple[Interface, ...]:
    """Return the interfaces with the normals that suit them in place of "automatic".

    At a concave corner of a mould the mean of the normals of both walls lets a node slide through
    the corner. A solid cannot follow, a liquid can, against nothing but its viscosity: it gets a
    normal for each wall.

    Args:
        case: the case as it was read.
    """
    liquid = set() if case.coupling.scheme == "thermal" else _poured(case)
    found = []
    for interface in case.interfaces:
        contact = interface.contact
        if contact.normals == AUTOMATIC:
            wets = bool(liquid.intersection(interface.bodies))
            normals = PATCHES if wets and _may_have_patches(contact) else AVERAGED
            contact = contact.model_copy(update={"normals": normals})
        found.append(interface.model_copy(update={"contact": contact}))
    return tuple(found)


def _poured(case: Case) -> set[str]:
    """Return the names of the bodies that start as a liquid that flows."""
    found = set()
    for body in case.bodies:
        material = find_material(body.material, case.materials).description
        flows = material.liquid is not None and body.law != "rigid"
        if flows and not body.starts_solid(material):
            found.add(body.name)
    return found


def _may_have_patches(contact: InterfaceContact) -> bool:
    tied = contact.method == NONE or is_tied(contact.method)
    return contact.pairing == "node-to-node" and contact.friction == 0 and not tied
