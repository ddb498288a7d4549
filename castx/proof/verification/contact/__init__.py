"""Contact of bodies: exact solutions, one file each, and the runs compared with them.

Public: `shrink_fit.ShrinkFit`, `closed_mould.closed_mould`, `pressed_blocks.blocks_case`,
`squeezed_bars.pressure`, `cut_cube.contact_pressure`.
"""
