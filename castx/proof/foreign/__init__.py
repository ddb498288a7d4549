"""Test cases that other programs keep, run by castx beside their numbers and the exact ones.

The cases are in `cases`.

Public: `declaration.ForeignCase`, `declaration.Number`, `registry.FOREIGN_CASES`,
`page.write_page`, `rings.draw_rings`, `blocks.draw_blocks`.
"""
