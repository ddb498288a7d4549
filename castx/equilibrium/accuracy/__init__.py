"""How well the forces on each body balance, and when they do so well enough.

Public: `convergence.ForceConvergence`, `net_forces.NetForces`
"""
