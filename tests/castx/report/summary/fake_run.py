"""A results folder in memory, as the findings read it."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyvista

from castx.results.files.run_tables import Columns

TIME = np.array([0.0, 1.0, 2.0, 3.0])


def grid(time: float, left: float = 0.0) -> pyvista.UnstructuredGrid:
    """Return a strip of 4 by 2 nodes from x = left on, whose middle freezes last."""
    image = pyvista.ImageData(dimensions=(5, 2, 1), spacing=(0.01, 0.01, 0.0), origin=(left, 0, 0))
    found = image.cast_to_unstructured_grid()
    x = found.points[:, 0] - left
    depth = np.minimum(x, 0.04 - x) / 0.02  # from the ends to the middle
    found["solid_fraction"] = np.clip(time - depth, 0.0, 1.0)
    found["temperature"] = 600.0 + 10.0 * depth - 20.0 * time
    found["gap"] = 1e-5 * x * time
    found["niyama"] = np.where(x > 0.005, 1000.0 + 1e5 * x, np.nan)
    return found


def run(**changes: Any) -> SimpleNamespace:
    """Return a run of a casting in a mould that is all solid at 2 s."""
    history = {
        "time": TIME,
        "casting.solid_fraction": np.array([0.0, 0.6, 1.0, 1.0]),
        "casting/mould.max_gap": np.array([0.0, 1e-7, 5e-6, 4e-6]),
    }
    record = {
        "scheme": "iterated", "front": "f_s = 0.9", "interfaces": {"casting/mould": {"pairs": 2}},
        "bodies": {"casting": {}, "mould": {}}, "hot_spots": [], "stage_ends": [], "process": [],
    }  # fmt: skip
    parts = {
        "folder": Path("/nowhere"), "record": record, "history": Columns(history),
        "model": "plane-strain", "deviations": {}, "doubts": [],
        "freezing": ["casting"], "interfaces": ("casting/mould",), "times": list(TIME),
        "grids": lambda time=3.0: {"casting": grid(time), "mould": grid(time, 0.04)},
        "interface": lambda name, time: SimpleNamespace(
            points=np.array([[0.04, 0.0], [0.04, 0.01]]), values={"gap": np.array([0.0, 1e-6])}
        ),
    }  # fmt: skip
    return SimpleNamespace(**parts | changes)
