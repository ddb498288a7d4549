"""PETSc options of the heat problem."""

from __future__ import annotations

from typing import Any

PREFIX = "castx_heat_"

LARGEST_DIRECT = {2: 100_000, 3: 2_000}
"""Unknowns up to which "automatic" solves directly, by dimension of the mesh.

Measured on a cylinder: in 3-D GMRES is 1.7 times faster at 3200 nodes, 5 times at 13 000; in 2-D
equally fast at 16 000 nodes with steps of 5 s, slower with longer steps.
"""

DIRECT: dict[str, Any] = {
    "ksp_type": "preonly",
    "pc_type": "lu",
    "pc_factor_mat_solver_type": "mumps",
}
ITERATIVE: dict[str, Any] = {
    "ksp_type": "gmres",
    "ksp_gmres_restart": 100,
    "ksp_rtol": 1e-9,
    "pc_type": "bjacobi",
    "sub_pc_type": "ilu",
}
# A search for a smaller residual hurts: a front needs it to grow on its way, see `shorten_step` of
# `castx.heat.newton`.
NEWTON: dict[str, Any] = {
    "snes_type": "newtonls",
    "snes_linesearch_type": "basic",
    "snes_max_it": 50,
    "snes_stol": 0.0,
}


def default_options(linear: str, unknowns: int, dimension: int) -> dict[str, Any]:
    """Return the options of a linear solver.

    Args:
        linear: "direct", "iterative" or "automatic", by size.
        unknowns: of the problem.
        dimension: of the mesh.
    """
    if linear == "automatic":
        linear = "direct" if unknowns <= LARGEST_DIRECT[dimension] else "iterative"
    return NEWTON | {"direct": DIRECT, "iterative": ITERATIVE}[linear]
