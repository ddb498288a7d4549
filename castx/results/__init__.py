"""Results of a run: what is written of its states, the files, and how they are read.

`states` is what a step leaves; `files` are folders, tables and fields on disk.

Public: `reading.Results`, `reading.BodyField`, `reading.InterfaceFields`,
`writing.ResultsWriter`, `fields.Fields`, `field_files.field_files`, `history.History`,
`probes.Probes`, `record.RunRecord`, `locate.place_in_body`, `locate.place_on_surface`.
"""
