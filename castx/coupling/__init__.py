"""One time step: passes between heat and mechanics until the interfaces agree.

Public: `step.CoupledProblem`, `building.build_problem`, `interface.CoupledInterface`,
`interface.Interfaces`, `change.StepChange`, `temperatures.Temperatures`,
`prescribed.PrescribedTemperatures`, `relaxation.Relaxation`, `dissipation.Dissipation`.
"""
