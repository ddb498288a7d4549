"""Estimate of the force that draws a body out of its neighbours.

F = μ Σ p S over all closed pairs of the body: what Coulomb's friction bears at most if every pair
slides in the direction of drawing. Draught, adhesion, and the change of the pressures while the
body moves are left out.
"""

from __future__ import annotations

from collections.abc import Mapping

from mpi4py import MPI

import numpy as np

from castx.coupling.step import CoupledProblem


def normal_force(problem: CoupledProblem, body: str) -> float:
    """Return Σ p S over the pairs of a body [N]; collective.

    Of the full turn when axisymmetric, per metre of depth in plane models, of the meshed part in
    space.
    """
    total = 0.0
    interfaces = problem.interfaces
    for interface, state in zip(interfaces.described, interfaces.states, strict=True):
        if body in (interface.pairs.secondary, interface.pairs.primary):
            total += float(interface.pairs.areas @ np.maximum(state.pressure, 0.0))
    return float(problem.comm.allreduce(total, op=MPI.SUM))


def ejection_forces(
    problem: CoupledProblem, friction: Mapping[str, float]
) -> dict[str, dict[str, float]]:
    """Return the forces that draw bodies out of the present state [N]; collective.

    Args:
        problem: the state.
        friction: coefficients μ of the bodies that are drawn.

    Returns:
        For each body "friction" μ, "normal" Σ p S and "force" μ Σ p S.
    """
    forces = {}
    for body, coefficient in friction.items():
        normal = normal_force(problem, body)
        forces[body] = {"friction": coefficient, "normal": normal, "force": coefficient * normal}
    return forces
