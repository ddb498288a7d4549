"""Cases of other programs, one file each or one for those that share their geometry.

Each file declares `CASES`.

Public: `pressed_conductance.blocks`, `contact_box.case`.
"""
