"""The interfaces that come with castx: heat transfer of pairs of metal and mould, with sources.

Public: `entries.interface_names`, `entries.interface_entry`, `entries.InterfaceEntry`,
`entries.SourcedNumber`, `naming.with_entry`, `naming.changed`.
"""
