"""The commands `castx verify` and `castx validate`.

Public: `verify.verify`, `verify.verification_list`, `validate.validate`,
`validate.experiment_list`.
"""
