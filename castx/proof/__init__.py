"""Proof of castx: `verification` by exact solutions, `validation` by experiments.

Public: `verification.registry.VERIFICATIONS`, `verification.verdict.verified`,
`validation.experiment.experiments`.
"""
