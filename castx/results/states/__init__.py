"""States of a run as results see them, and the quantities that are read from them.

Public: `snapshot.Snapshot`, `snapshot.ProcessState`, `quantities.on_secondary_nodes`.
"""
