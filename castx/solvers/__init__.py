"""PETSc: numbering of unknowns, nonlinear and linear solvers, and the messages of their failures.

Public: `communicator.keep_duplicate`, `layout.Layout`, `remote_entries.RemoteEntries`,
`snes.NonlinearSolver`, `snes.SolveReport`, `line_search.shorten_step`, `blocks.DirectSolver`,
`blocks.Block`, `blocks.BlockSweep`, `blocks.BlockSolver`, `stiff_part.StiffPart`,
`arrow_schur.ArrowSchur`, `worst_place.worst_place`, `finite.require_finite`, `diagnosis.diagnosis`.
"""
