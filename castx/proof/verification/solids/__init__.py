"""Deformation and flow: exact solutions, one file each, and the runs compared with them.

Public: `hollow.Hollow`, `viscoplastic_bars.exact_maxwell`, `viscoplastic_bars.exact_norton`,
`solidifying_slab.Slab`, `solidifying_slab.Solution`, `cook.Membrane`.
"""
