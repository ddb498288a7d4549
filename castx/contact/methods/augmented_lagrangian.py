"""Augmented Lagrangian method: the penalty adds to a pressure that improves between iterations."""

from __future__ import annotations

from castx.contact.methods.description import ContactMethod, Key, UnknownKind
from castx.contact.methods.penalty import PENALTY_KEY, linear_pair_law
from castx.input.entries import Choice, Whole

METHOD = ContactMethod(
    name="augmented-lagrangian",
    summary=(
        "Penalty, corrected until nothing penetrates, after each `augmentation = \"iteration\"` or "
        'in a `"loop"`.'
    ),
    formula="p_c = ⟨λ - ε g⟩, λ ← ⟨λ - ε g⟩",
    source="Chiumenti, section 7.2, λ(i+1) = λ(i) + t_n",
    advice="as `penalty`, without its error",
    unknowns=UnknownKind.DISPLACEMENTS,
    computed_by="castx.contact.augmented.AugmentedMultipliers",
    keys=(
        PENALTY_KEY,
        Key(
            "augmentation",
            Choice(("iteration", "loop")),
            "loop",
            'Multipliers improve after every "iteration", or in a "loop" after those that balance.',
        ),
        Key("augmentations", Whole(0, 10_000), 30, "Updates in one solve, at most."),
    ),
    pair_law=linear_pair_law,
    updates_multipliers=True,
)
