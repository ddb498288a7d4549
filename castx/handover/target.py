"""What results are handed over as."""

from __future__ import annotations

from enum import StrEnum


class Target(StrEnum):
    """What results are handed over as, by the name on the command line."""

    CALCULIX = "calculix"
    CSV = "csv"
    EXACA = "exaca"
    STL = "stl"
    MOULD = "mould"
