"""Results of a run: snapshots of its states, the files that it writes, and how they are read.

Public: `reading.Results`, `reading.BodyField`, `reading.InterfaceFields`, `snapshot.Snapshot`,
`snapshot.ProcessState`, `writing.ResultsWriter`, `fields.Fields`, `history.History`,
`hot_spots.HotSpots`, `probes.Probes`, `record.RunRecord`, `solidification.Solidification`,
`locate.place_in_body`, `locate.place_on_surface`, `quantities.on_secondary_nodes`.
"""
