"""PETSc options of the inner solvers of the mechanics: multigrid of a body, and factors."""

from __future__ import annotations

from collections.abc import Mapping

MULTIGRID: Mapping[str, object] = {
    "ksp_type": "preonly",
    "pc_type": "gamg",
    "pc_gamg_threshold": 0.0,
    "pc_gamg_coarse_eq_limit": 1000,
    "pc_gamg_reuse_interpolation": True,
    "mg_levels_ksp_type": "richardson",
    "mg_levels_pc_type": "sor",
}
"""Multigrid of one body, symmetric indefinite where its pressure is an unknown."""


FACTORS: Mapping[str, object] = {
    "ksp_type": "preonly",
    "pc_type": "lu",
    "pc_factor_mat_solver_type": "mumps",
    "mat_mumps_icntl_14": 60,
}
"""Sparse LU factorisation (MUMPS) with room for fill-in."""


def solves_directly(linear: str, unknowns: int, largest: int) -> bool:
    """Return whether linear systems are solved by factors.

    Args:
        linear: "direct", "iterative" or "automatic", by size.
        unknowns: of all ranks.
        largest: number of unknowns up to which "automatic" takes factors.
    """
    return linear == "direct" or (linear == "automatic" and unknowns <= largest)
