"""The command line, and a run from its case file to its results folder.

Public: `run.run`, `cli.execute`, `check.check_case`, `listing.material_list`,
`listing.material_table`, `progress.Progress`, `interruption.Interruption`,
`range_watch.RangeWatch`, `terminal.EnduringConsole`, `force_watch.ForceWatch`.
"""
