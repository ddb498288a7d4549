"""Declarations of verifications, and answers read from the states of a run.

Public: `verification.Verification`, `verification.Resolution`, `verification.Answer`,
`verification.Curve`, `verification.Comparison`, `verification.Outcome`, `states.states`,
`states.drawn_mesh`, `states.profile`.
"""
