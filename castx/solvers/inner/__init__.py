"""Solvers that precondition the mechanics: factors, sweeps over bodies with multigrid, multipliers.

Public: `direct.DirectSolver`, `nest.Block`, `nest.Blocks`, `sweep.BlockSweep`,
`block_solver.BlockSolver`, `stiff_part.StiffPart`, `uncoupled.Uncoupled`, `arrow_schur.ArrowSchur`,
`midside_schur.MidsideSchur`, `options.solves_directly`, `entries.diagonal`.
"""
