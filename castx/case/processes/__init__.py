"""Casting processes for first case files: one TOML file each, with a source for each number.

Public: `names.process_names`, `process.casting_process`, `process.CastingProcess`,
`plan.plan_of`, `plan.Plan`.
"""
