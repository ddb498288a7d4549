"""Balance of the forces on each body, and its tolerance.

Public: `convergence.ForceConvergence`, `net_forces.NetForces`
"""
