"""Proof of castx: by exact solutions, by cases that other programs keep, and by experiments.

Public: `verification.registry.VERIFICATIONS`, `verification.verdict.verified`,
`foreign.registry.FOREIGN_CASES`, `validation.experiment.experiments`.
"""
