"""What `castx verify` and `castx validate` do and show.

Public: `verify.verify`, `verify.verification_list`, `validate.validate`,
`validate.experiment_list`.
"""
