"""Proof by exact solutions: all verifications, their verdicts, and the page that shows them.

`verification` is what one declares, `states` how its answers are read from the states of a run.
One file for each exact solution: of heat and solidification in `heat`, of deformation and flow in
`solids`, of `contact`, of heat and deformation together in `coupled`, of functions of arrays in
`foundry`.

Public: `registry.VERIFICATIONS`, `registry.chosen`, `verdict.Verdict`, `verdict.verified`,
`page.write_page`, `verification.Verification`, `verification.Resolution`, `verification.Answer`,
`verification.Curve`, `verification.Comparison`, `verification.Outcome`, `states.states`,
`states.drawn_mesh`, `states.profile`.
"""
