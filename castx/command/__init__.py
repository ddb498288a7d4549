"""The command line, and a run from its case file to its results folder.

Public: `run.run`, `cli.execute`, `check.check_case`,
`listing.material_list`, `listing.material_table`, `listing.interface_list`,
`listing.interface_table`, `progress.Progress`,
`terminal.EnduringConsole`, `verify.verify`,
`verify.verification_list`, `validate.validate`, `validate.experiment_list`.
"""
