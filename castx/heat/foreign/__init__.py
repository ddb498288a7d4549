"""Files of other programs, read in a process of their own: readers crash, hang and fill memory.

Public: `guarded.interpolated`, `guarded.Interpolated`, `child.main`.
"""
