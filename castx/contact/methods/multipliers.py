"""Lagrange multipliers: the contact pressure of each pair is one more unknown."""

from __future__ import annotations

from castx.contact.methods.description import ContactMethod, UnknownKind

METHOD = ContactMethod(
    name="multipliers",
    summary="Gap exactly zero, by a force of each pair as an unknown of its own.",
    formula="[A Bᵀ; B 0] [dv; dλ] = -[r + Bᵀλ; -S g], B = -S ∂g/∂v, λ ≥ 0, g ≥ 0, λ g = 0",
    source="Chiumenti, section 8, matrix form of the variation of Π_c = ∫ λ g dS",
    advice="to check `condensed`",
    unknowns=UnknownKind.MULTIPLIERS,
    computed_by="castx.contact.multipliers.MultiplierContact",
    exact=True,
)
