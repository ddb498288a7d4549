"""Heat and solidification: exact solutions, one file each, and the runs compared with them.

Public: `neumann.Neumann`, `schwarz.Schwarz`, `freezing_range.FreezingRange`,
`radiation.Lumps`, `plates.Plates`.
"""
