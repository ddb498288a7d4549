"""Block-iterative method: bodies solved one after the other, coupled by a penalty."""

from __future__ import annotations

from castx.contact.methods.description import ContactMethod, Key, UnknownKind
from castx.contact.methods.penalty import PENALTY_KEY, linear_pair_law
from castx.input.entries import Choice, Whole

METHOD = ContactMethod(
    name="block-iterative",
    summary=(
        "Penalty, bodies solved in turn; or one such sweep as "
        '`block_solver = "preconditioner"`.'
    ),
    formula="A_b du_b = -r_b for one block b after the other, p_c = ε⟨-g⟩",
    source="Chiumenti, section 7.3, iterative solution of the arrow-shaped system",
    advice="where memory is short; slow for stiff contact",
    unknowns=UnknownKind.DISPLACEMENTS,
    computed_by="castx.equilibrium.block_iterative.BlockIteration",
    keys=(
        PENALTY_KEY,
        Key(
            "blocks",
            Choice(("bodies", "interface")),
            "bodies",
            'The "bodies", or with "interface" their interiors and then all nodes of interfaces.',
        ),
        Key(
            "block_solver",
            Choice(("iteration", "preconditioner")),
            "iteration",
            '"iteration" sweeps over blocks, one is the "preconditioner" of a Krylov method.',
        ),
        Key(
            "block_iterations",
            Whole(1, 100_000),
            50,
            "Sweeps of one solve, at most; with bodies in turn as preconditioner it is ended.",
        ),
    ),
    pair_law=linear_pair_law,
    by_blocks=True,
)
