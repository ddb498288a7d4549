"""Checkpoints from which a run goes on, on any number of ranks, all of which write and read them.

Public: `file.Checkpoint`, `writing.Checkpoints`, `writing.header_to_restart_from`,
`archive.arranged`, `archive.write_contents`, `archive.read_contents`, `archive.read_verified`,
`chunks.ChunkedRows`, `checksums.shifted`, `shared_file.SharedFile`.
"""
