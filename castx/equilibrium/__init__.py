"""Equilibrium of all bodies in contact: residual, Newton iteration, linear systems, memory.

Public: `problem.MechanicalProblem`, `building.MechanicsSettings`, `equilibrium.Equilibrium`,
`forces.MomentumBalance`, `newton.Newton`
"""
