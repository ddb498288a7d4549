"""Time of a first run by the cells of its mesh, before anything of it is known.

A run to a cold casting takes some hundred steps. What a step costs hangs on the passes between heat
and mechanics, of which there are one to twenty, so that the time is known to a factor of four only.
"""

from __future__ import annotations

STEPS = 100
"""Of a run from the pouring to the cold casting; boxes, lugs and trays in dies took 75 to 105."""
COST = (2e-4, 1e-3)
"""Time of a step for each cell, on one processor, with mechanics [s]: a box of 3,170 cells took
0.29 ms, one of 2,365 in a die of two halves 0.5 ms, and an impeller of 10,930 in a rigid shell
0.09 ms in twice as many steps, all beside other runs."""


def first_run_time(cells: int) -> str:
    """Return about how long a run of so many cells takes on one processor, in words."""
    low, high = (STEPS * cost * cells for cost in COST)
    if high < 60.0:
        return "less than a minute"
    unit, length = ("minutes", 60.0) if low < 3600.0 else ("hours", 3600.0)
    first, last = (float(f"{max(time / length, 1.0):.1g}") for time in (low, high))
    return f"some {first:g} to {last:g} {unit}"
