"""Many runs of one case: each in a process of its own, kept by what was changed.

Public: `executor.Executor`, `executor.Task`, `local.LocalProcesses`, `kept.KeptRun`,
`runner.Runner`, `answers.answers`, `curves.curve_bands`.
"""
