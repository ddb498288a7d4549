"""Equilibrium of all bodies in contact: residual, Newton iteration, linear systems, memory.

`supports` is what holds bodies that contact does not.

Public: `problem.MechanicalProblem`, `building.MechanicsSettings`, `equilibrium.Equilibrium`,
`forces.MomentumBalance`, `newton.Newton`, `convergence.ForceConvergence`, `net_forces.NetForces`.
"""
