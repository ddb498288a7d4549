"""PETSc: numbering of unknowns, nonlinear and linear solvers, and the messages of their failures.

Public: `communicator.keep_duplicate`, `layout.Layout`, `remote_entries.RemoteEntries`,
`snes.NonlinearSolver`, `snes.SolveReport`, `line_search.shorten_step`,
`worst_place.worst_place`, `finite.require_finite`, `diagnosis.diagnosis`.
"""
