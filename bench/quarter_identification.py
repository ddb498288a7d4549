"""What does `castx identify` find on a quarter of a cylinder in space, with more and more noise?

    bin/with-fenicsx python3 bench/quarter_identification.py results/quarter [--size "5 mm"]

A bar of 60 mm freezes for a minute in a steel mould, meshed as a quarter in tetrahedra. h falls
from 2500 to 500 W/m²/K; three thermocouples lie 2, 5 and 8 mm deep in the mould at different
heights and angles, their depths off by 0.3, -0.2 and 0.1 mm of 0.3 mm that are allowed. For noise
of 0.5, 1 and 2 K the command is started on the same case with other curves. Prints each number
with its band, whether the truth lies in it, and what the command says of its cost.
"""

from __future__ import annotations

import argparse
import csv
import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from castx.input.toml_written import toml_text

KNOTS, COEFFICIENT = [0.0, 5.0, 20.0, 60.0], [2500.0, 1500.0, 800.0, 500.0]
SENSORS = {
    "low": (2e-3, 3e-4, 10.0, 0.01), "middle": (5e-3, -2e-4, 45.0, 0.02),
    "high": (8e-3, 1e-4, 80.0, 0.03),
}  # fmt: skip
"""Depth, by how much it is off [m], angle [°], height [m]."""
NOISES = (0.5, 1.0, 2.0)


def probe(name: str, off: float) -> dict[str, Any]:
    """Return the probe of a sensor, deeper by some length [m]."""
    depth, _, angle, height = SENSORS[name]
    x, y = 0.03 * np.cos(np.radians(angle)), 0.03 * np.sin(np.radians(angle))
    return {"name": name, "body": "mould", "below": "casting/mould", "depth": depth + off,
            "at": [float(x), float(y), height], "quantities": ["temperature"]}  # fmt: skip


def case_of(size: str, closed: object, probes: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Return the content of the case.

    Args:
        size: of the cells.
        closed: coefficient of heat transfer.
        probes: sensors.
    """
    alloy = {"density": 2600, "heat_capacity": 1000, "conductivity": 150,
             "latent_heat": 396154, "solidus": 557, "liquidus": 613}  # fmt: skip
    mould = {"density": 7800, "heat_capacity": 500, "conductivity": 35}
    return {
        "geometry": {"generator": "cylinder_in_mould", "model": "3d", "sector": "quarter",
                     "radius": "30 mm", "height": "40 mm", "wall": "25 mm", "size": size},
        "materials": {"metal": alloy, "die": mould},
        "bodies": [{"name": "casting", "material": "metal", "temperature": 670},
                   {"name": "mould", "material": "die", "temperature": 200}],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "constant", "closed": closed}}],
        "boundaries": [{"on": "mould/outside",
                        "heat": {"type": "convection", "coefficient": 20, "ambient": 25}}],
        "coupling": {"scheme": "thermal"},
        "time": {"end": 60.0, "fixed_step": 1.0},
        "output": {"fields": ["temperature"]},
        "probes": list(probes),
    }  # fmt: skip


def study_of(noise: float, file: str) -> dict[str, Any]:
    """Return the table [identify]."""
    curves = [{"of": f"{name}.temperature", "file": file, "column": name, "noise": noise,
               "depth_deviation": 3e-4} for name in SENSORS]  # fmt: skip
    unknown = {"of": "interfaces.0.heat.closed", "name": "h", "over": "time", "knots": KNOTS,
               "start": 1000.0}  # fmt: skip
    return {"curves": curves, "unknowns": [unknown]}


def castx(*arguments: str) -> str:
    """Run castx and return what it says."""
    command = [sys.executable, "-m", "castx", *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def truth(folder: Path, size: str) -> dict[str, list[float]]:
    """Return the exact curves of a run."""
    at = np.linspace(0.0, KNOTS[-1], 241)
    h = np.exp(np.interp(at, KNOTS, np.log(COEFFICIENT)))
    closed = {"over": "time", "table": np.column_stack([at, h]).tolist()}
    probes = [probe(name, off) for name, (_, off, _, _) in SENSORS.items()]
    (folder / "truth.toml").write_text(toml_text(case_of(size, closed, probes)))
    castx("run", str(folder / "truth.toml"), "--output", str(folder / "truth"))
    with (folder / "truth" / "probes.csv").open() as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def identified(folder: Path, size: str, noise: float, exact: dict[str, list[float]]) -> None:
    """Start the command on noisy curves, and print what it finds."""
    random = np.random.default_rng(round(10 * noise))
    curves = [np.array(exact[f"{name}.temperature"]) for name in SENSORS]
    noisy = [curve + noise * random.normal(size=len(curve)) for curve in curves]
    name = f"noise_{noise:g}"
    np.savetxt(folder / f"{name}.csv", np.column_stack([exact["time"], *noisy]), delimiter=",",
               header=",".join(["time", *SENSORS]), comments="")  # fmt: skip
    case = case_of(size, 1000.0, [probe(sensor, 0.0) for sensor in SENSORS])
    case_file = folder / f"{name}.toml"
    case_file.write_text(toml_text({**case, "identify": study_of(noise, f"{name}.csv")}))
    said = castx("identify", str(case_file), "--output", str(folder / name))
    found = json.loads((folder / name / "identified.json").read_text())
    known = [*COEFFICIENT, *(off for _, off, _, _ in SENSORS.values())]
    print(f"noise {noise:g} K, χ²_r {found['chi_square']:.3f}")
    for one, true in zip(found["estimates"], known, strict=True):
        held = "holds" if one["low"] <= true <= one["high"] else "MISSES"
        print(f"  {one['name']:18} {one['value']:10.4g}  [{one['low']:.4g}, {one['high']:.4g}] "
              f"{held} {true:g}")  # fmt: skip
    print("  " + next(line for line in said.splitlines() if "processor time" in line), flush=True)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print what is found at each noise."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="of cases and runs")
    parser.add_argument("--size", default="5 mm", help="of the cells")
    asked = parser.parse_args(arguments)
    folder = asked.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    exact = truth(folder, asked.size)
    for noise in NOISES:
        identified(folder, asked.size, noise, exact)


if __name__ == "__main__":
    main()
