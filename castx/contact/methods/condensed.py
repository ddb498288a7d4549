"""Condensed contact: the gap of each pair is an unknown, a closed pair a Dirichlet condition."""

from __future__ import annotations

from castx.contact.methods.description import ContactMethod, UnknownKind

METHOD = ContactMethod(
    name="condensed",
    summary=(
        "Gap exactly zero, forces follow; the gaps are unknowns in place of motions of the "
        "secondary nodes."
    ),
    formula="u = P v, PᵀAP dv = -Pᵀr, v_k = -g0 where a pair is closed, f = (Pᵀr)_k",
    source="Chiumenti, section 8, condensed multipliers of the last paragraph, for two bodies",
    advice=(
        "always, unless there is a reason: exact, and its solver does not feel the contact"
    ),
    unknowns=UnknownKind.GAPS,
    computed_by="castx.contact.condensed.CondensedContact",
    exact=True,
    friction=True,
)
