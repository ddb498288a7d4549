"""Estimate of the force that draws a body out of its neighbours.

F = μ Σ p S over all closed pairs of the body: what Coulomb's friction holds at most if every pair
slides in the direction of drawing. Draught, adhesion, and the change of the pressures while the
body moves are left out.
"""

from __future__ import annotations

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
