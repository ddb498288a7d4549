"""Contact with a rigid body: a Dirichlet condition in the local frame of each node."""

from __future__ import annotations

from castx.contact.methods.description import ContactMethod, UnknownKind

METHOD = ContactMethod(
    name="rigid",
    summary='Gap exactly zero to a body with `law = "rigid"`.',
    formula="n · u = -g0 where a pair is closed, f = (Pᵀr)_k",
    source="Chiumenti, section 8, last paragraph",
    advice="moulds of sand, plaster, thick dies",
    unknowns=UnknownKind.GAPS,
    computed_by="castx.contact.condensed.CondensedContact",
    exact=True,
    friction=True,
    fallback=False,
    rigid_primary=True,
    solved_as="condensed",
)
