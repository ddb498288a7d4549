"""Proof by exact solutions: all verifications, their verdicts, and the page that shows them.

Public: `registry.VERIFICATIONS`, `registry.chosen`, `verdict.Verdict`, `verdict.verified`,
`page.write_page`.
"""
