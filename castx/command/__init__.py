"""The command line, and a run from its case file to its results folder.

Public: `run.run`, `sensitivity.run_sensitivity`, `cli.execute`, `check.check_case`,
`listing.material_list`, `listing.material_table`, `listing.interface_list`,
`listing.interface_table`, `progress.Progress`,
`interruption.Interruption`, `terminal.EnduringConsole`, `verify.verify`,
`verify.verification_list`, `validate.validate`, `validate.experiment_list`,
`range_watch.RangeWatch`, `deformation_watch.DeformationWatch`, `force_watch.ForceWatch`.
"""
