"""How well do sensors in a freezing cylinder and its mould tell h(t), by runs of a case file?

    bin/with-fenicsx python3 bench/sensor_accuracy.py results/sensor_accuracy [--size "1 mm"]

The cylinder of tests/verification/test_sensors_in_a_cylinder.py as a case file, with runs as those
of castx identify: eight of them, kept in the folder. Prints for each set of sensors the deviation
of h in % at its knots, the change of h if all sensors lie 0.3 mm farther from the interface than is
assumed, and the deviation if their depths are known to 0.3 mm, beside a table that was computed
independently, and the largest difference in %.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from castx.arrays import FloatArray
from castx.case.reading.read import load_case
from castx.foundry.identification.covariance import deviations
from castx.foundry.identification.sensors import Candidate
from castx.input.toml_written import toml_text
from castx.studies.asked.candidates import CandidateSensor
from castx.studies.asked.unknowns import SoughtNumber
from castx.studies.inverse.design import slope_tables, with_slopes
from castx.studies.inverse.parameters import Parameters
from castx.studies.runs.local import LocalProcesses
from castx.studies.runs.runner import Runner, study_folder

KNOTS = [0.0, 1.0, 3.0, 8.0, 20.0, 40.0, 60.0]
COEFFICIENT = [3000.0, 2500.0, 1800.0, 1000.0, 600.0, 400.0, 300.0]
FAR = 3e-4
SETS: dict[str, tuple[str, ...]] = {
    "mould 2 + 8, casting 3": ("mould 2", "mould 8", "casting 3"),
    "mould 2 + 8": ("mould 2", "mould 8"),
    "mould 8": ("mould 8",),
    "casting 3": ("casting 3",),
    "axis": ("axis",),
}
KNOWN: dict[str, list[float]] = {
    "mould 2 + 8, casting 3": [4.0, 2.7, 1.5, 1.0, 0.8, 1.0, 2.3, -14, -8, -3, 6.4, 3.5, 1.8],
    "mould 2 + 8": [5.1, 3.0, 1.6, 1.0, 0.8, 1.0, 2.3, -22, -6, -3, 10, 3.8, 2.1],
    "mould 8": [30, 17, 6.1, 2.8, 2.0, 2.3, 6.3, -23, -6, -3, 38, 18, 7.0],
    "casting 3": [7.1, 7.8, 6.7, 5.0, 4.0, 4.8, 11, -6, -6, -3, 9.2, 9.9, 7.4],
    "axis": [32, 34, 38, 30, 21, 30, 223, -1, 1, -1, 32, 34, 38],
}
"""Deviation at all knots, change by a shift at 0, 1 and 3 s, deviation with free depths there."""


def case_of(size: str, step: float = 0.25) -> dict[str, object]:
    """Return the content of the case.

    Args:
        size: of the cells.
        step: of time [s].
    """
    alloy = {"density": 2600, "heat_capacity": 1000, "conductivity": 150,
             "latent_heat": 1.03e9 / 2600, "solidus": 557, "liquidus": 613}  # fmt: skip
    mould = {"density": 7800, "heat_capacity": 500, "conductivity": 35}
    return {
        "geometry": {"generator": "cylinder_in_mould", "model": "axisymmetric",
                     "cells": "quadrilaterals", "radius": "30 mm", "height": size,
                     "wall": "25 mm", "size": size},
        "materials": {"metal": alloy, "die": mould},
        "bodies": [{"name": "casting", "material": "metal", "temperature": 670},
                   {"name": "mould", "material": "die", "temperature": 200}],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "constant", "closed": 1000}}],
        "coupling": {"scheme": "thermal"},
        "time": {"end": 60.0, "fixed_step": step},
        "output": {"fields": ["temperature"]},
    }  # fmt: skip


def places() -> list[CandidateSensor]:
    """Return the sensors."""
    at = {"at": [0.03, 1e-4], "below": "casting/mould"}
    rows = [
        {"name": "mould 2", "body": "mould", "depth": "2 mm", **at},
        {"name": "mould 8", "body": "mould", "depth": "8 mm", **at},
        {"name": "casting 3", "body": "casting", "depth": "3 mm", **at},
        {"name": "axis", "body": "casting", "at": [0.0, 1e-4], "direction": [1, 0]},
    ]
    return [CandidateSensor.read(row) for row in rows]


def row_of(sensors: Sequence[Candidate]) -> list[float]:
    """Return deviations, change by a shift, and deviations with free depths [%]."""
    known = sum((one.sensitivity.T @ one.sensitivity for one in sensors), np.zeros((7, 7)))
    pulled = sum((one.sensitivity.T @ one.by_depth for one in sensors), np.zeros(7))
    free = sum((one.information() for one in sensors), np.zeros((7, 7)))
    covariance: FloatArray = np.asarray(np.linalg.inv(known))
    shift = covariance @ pulled * FAR
    spread = deviations(np.asarray(np.linalg.inv(free)))
    found = [*deviations(covariance), *shift[:3], *spread[:3]]
    return [100.0 * float(value) for value in found]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return 1 where a deviation is more than 20 % off."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="of the runs")
    parser.add_argument("--size", default="1 mm", help="of the cells")
    asked = parser.parse_args(arguments)
    sought = SoughtNumber.read({"of": "interfaces.0.heat.closed", "name": "h", "over": "time",
                                "knots": KNOTS, "start": COEFFICIENT})  # fmt: skip
    with study_folder(asked.folder.resolve()) as folder:
        case_file = folder / "case.toml"
        case_file.write_text(toml_text(case_of(asked.size)))
        runner = Runner(case_file, (), folder, LocalProcesses())
        parameters = Parameters.of([sought], load_case(case_file).content)
        unknowns = parameters.unknowns()
        tables = slope_tables(runner, parameters, unknowns, places())
    time = np.asarray(np.arange(0.5, 60.25, 0.5), dtype=np.float64)
    sensors = {one.name: with_slopes(one, tables, unknowns, time) for one in places()}
    worst = 0.0
    for name, members in SETS.items():
        found, known = row_of([sensors[one] for one in members]), KNOWN[name]
        off = [100.0 * (a / b - 1.0) for a, b in zip(found, known, strict=True)]
        worst = max(worst, *(abs(one) for one in off[:7] + off[10:]))
        print(f"{name:24}", *(f"{value:7.3g}" for value in found))
        print(f"{'':24}", *(f"{value:7.3g}" for value in known))
    print(f"largest difference of a deviation: {worst:.0f} %")
    return int(worst > 20.0)


if __name__ == "__main__":
    raise SystemExit(main())
