"""Formats in which results are handed over."""

from __future__ import annotations

from enum import StrEnum


class Target(StrEnum):
    """Format in which results are handed over, by the name on the command line."""

    CALCULIX = "calculix"
    CSV = "csv"
    EXACA = "exaca"
    STL = "stl"
    MOULD = "mould"
