"""Files of a results folder: the folder and its lock, tables, fields, failures of the disk.

Public: `folder.claimed_folder`, `folder.make_room`, `folder.record_of`, `folder.write_whole`,
`folder.FolderLock`, `disk.Disk`, `series.Series`, `series.read_series`,
`run_json.read_record`, `sensitivity.read_sensitivity`, `sensitivity.Sensitivity`,
`estimate.read_estimate`, `estimate.Estimate`,
`collection.FieldSeries`, `vtu.Piece`, `vtu.write_piece`, `vtkhdf.BodyFile`,
`body_series.BodySeries`,
`measurements.measured_curves`, `measurements.read_measured`, `measurements.deviation`.
"""
