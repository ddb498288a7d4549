"""Checkpoints from which a run goes on, on any number of ranks.

Public: `file.Checkpoint`, `writing.Checkpoints`, `writing.header_to_restart_from`,
`archive.ArchiveWriter`, `archive.read_header`, `archive.read_array`, `gathering.Gathering`.
"""
