"""Tied bodies: facing nodes move as one."""

from __future__ import annotations

from castx.contact.methods.description import ContactMethod, UnknownKind

METHOD = ContactMethod(
    name="tied",
    summary="Never part, nor slide.",
    formula="u_secondary = u_primary",
    source="Chiumenti, section 8, condensed multipliers of the last paragraph, in all directions",
    advice="inserts",
    unknowns=UnknownKind.TIED,
    computed_by="castx.contact.condensed.CondensedContact",
    exact=True,
    fallback=False,
)
