"""Do foundries drawn at random end: chills, cores, sand, coatings, stages, several castings?

    bin/with-fenicsx python3 bench/random_foundries.py --seed 1 --count 100 --folder DIR

The castings are those of bench/drawn_foundries.py. Each runs as a user would run it, in a process
of its own: as it is, or turned by a right angle, mirrored, with other numbers of nodes and cells,
other bodies first, or tight tolerances. A line judges it by its history and its last fields; the
last lines sum up.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import gmsh
import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.domain.source import gmsh_session
from castx.errors import CaseError
from castx.meshes.linear_mesh import SIMPLICES, LinearMesh, oriented
from castx.meshes.model import fill_model
from castx.results.files.series import read_series
from castx.results.reading import Results

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from bench.drawn_foundries import EXACT, Foundry, filled, foundry, meshed
from bench.random_castings import LAWS, database, toml

CHANGES = ("turned", "mirrored", "renumbered", "swapped", "tight")
PATIENCE = 400.0
"""Wall clock time after which a run counts as lost [s]."""
MOST_CUTS, MOST_ITERATIONS, MOST_PASSES = 2, 25, 20
BALANCE = 1e-3
"""Missing part of the forces on a body: the default tolerance of castx."""
ENERGY = 1e-5
"""Missing part of the heat: ten times what the default tolerances leave."""
VACUUM = 101_325.0
"""Largest suction of melt [Pa]."""
BEYOND = 1.0
"""How far temperatures may leave the range of what the case names [K]."""
COLUMNS = (
    ("number", 7), ("part", 34), ("cells", 6), ("alloy", 12), ("mould", 14), ("size m", 8),
    ("law", 21), ("element", 13), ("contact", 21), ("heat", 15), ("with", 32), ("ranks", 6),
    ("ended", 6), ("steps", 6), ("cuts", 5), ("passes", 7), ("its", 6), ("most passes", 12),
    ("most its", 9), ("energy", 9), ("error", 9), ("suction", 9), ("wall s", 7),
)  # fmt: skip
PARTS = ("feeder", "flange", "second", "lid", "core", "chill")


def write_mesh(foundry: Foundry, file: Path, changes: Sequence[str], seed: int = 1) -> None:
    """Write the mesh, mirrored, turned by a right angle and renumbered where this is asked for."""
    mesh, names, surfaces = meshed(foundry)
    points, cells, regions = mesh.points.copy(), mesh.cells, mesh.regions
    order: LongArray = np.arange(len(points))
    if "renumbered" in changes:
        chance = np.random.default_rng(seed)
        order, shuffled = chance.permutation(len(points)), chance.permutation(len(cells))
        cells, regions = np.argsort(order)[cells][shuffled], regions[shuffled]
    if "mirrored" in changes or "turned" in changes:
        points = moved(points, foundry.case["geometry"]["model"], changes)
    at = {surface[0]: (lambda _, test=surface[1]: test(mesh.points)[order]) for surface in surfaces}
    changed = LinearMesh(points[order], oriented(points[order], cells), regions, order)
    with gmsh_session():
        fill_model(changed, names, list(at.items()))
        gmsh.write(str(file))


def moved(points: FloatArray, model: str, changes: Sequence[str]) -> FloatArray:
    """Return points or vectors, mirrored and turned; half sections keep their axis."""
    if model == "axisymmetric":
        return points * [1.0, -1.0]
    if "mirrored" in changes:
        points = points * np.where(np.arange(points.shape[1]) == 0, -1.0, 1.0)
    if "turned" not in changes:
        return points
    return (
        np.column_stack([-points[:, 1], points[:, 0]])
        if points.shape[1] == 2
        else points[:, [2, 0, 1]]
    )


def written(foundry: Foundry, folder: Path, changes: Sequence[str] = (), method: str = "") -> Path:
    """Write a case and its mesh, changed and with another exact contact method."""
    folder.mkdir(parents=True, exist_ok=True)
    case = dict(foundry.case)
    if "loads" in case and {"mirrored", "turned"} & {*changes}:
        down = np.array([case["loads"]["gravity"]])
        case["loads"] = {"gravity": moved(down, case["geometry"]["model"], changes)[0].tolist()}
    rigid = {body["name"] for body in case["bodies"] if body.get("law") == "rigid"}
    found = []
    for item in case["interfaces"]:
        exact = item["contact"]["method"] in EXACT
        free = item["heat"].get("law") != "solid-fraction"  # which is that of the first body
        swaps = "swapped" in changes and exact and free and not rigid & {*item["bodies"]}
        other = {"method": method} if method and exact else {}
        order = item["bodies"][::-1] if swaps else item["bodies"]
        found.append({**item, "bodies": order, "contact": item["contact"] | other})
    case["interfaces"] = found
    if "tight" in changes:
        case["solver"] = {"mechanics_tolerance": 1e-9, "heat_tolerance": 1e-12}
        case["coupling"] = {**case.get("coupling", {}), "tolerance": 1e-8}
    write_mesh(foundry, folder / "mesh.msh", changes)
    (folder / "case.toml").write_text("\n".join(toml(case)) + "\n")
    return folder / "case.toml"


def run(file: Path, ranks: int) -> str:
    """Run a case in a process of its own; return how it failed, or nothing."""
    command = [
        sys.executable,
        "-m",
        "castx",
        "run",
        str(file),
        "--output",
        str(file.parent / "run"),
    ]
    if ranks > 1:
        command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), *command]
    environment = dict(os.environ, OMPI_MCA_mpi_yield_when_idle="1")  # other processes run beside
    try:
        ended = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE, env=environment
        )
    except subprocess.TimeoutExpired:
        return "time"
    said = ended.stdout + ended.stderr
    file.with_name("log.txt").write_text(said)
    if "Traceback" in said:
        return "traceback"
    return str(ended.returncode) if ended.returncode else ""


def named(case: Mapping[str, Any]) -> tuple[float, float]:
    """Return the lowest and highest temperature that a case names [°C]."""
    found = [body["temperature"] for body in case["bodies"]] + [20.0]
    return min(found), max(found)


def judged(foundry: Foundry, folder: Path) -> tuple[dict[str, float], list[str]]:
    """Return the counts of a run, and what is wrong with it."""
    history = read_series(folder / "run" / "history.csv")
    steps = {name: values[1:] for name, values in history.items()}
    of = {
        "steps": len(steps["time"]), "cuts": steps["cutbacks"].sum(),
        "passes": steps["passes"].sum(), "its": steps["mechanics_iterations"].sum(),
        "most passes": steps["passes"].max(), "most its": steps["mechanics_iterations"].max(),
        "energy": np.abs(steps["energy_error"]).max(),
        "suction": largest(steps, ".suction"), "error": largest(steps, ".force_error"),
    }  # fmt: skip
    low, high = named(foundry.case)
    exact = all(i["contact"]["method"] in ("none", "tied", *EXACT)
                for i in foundry.case["interfaces"])  # fmt: skip
    exact &= not idle_pairs(folder / "log.txt")
    least = {
        "solid fraction": (".solid_fraction", 0.0, 1.0, 1e-9),
        "coldest": (".min_temperature", low, high, BEYOND),
        "hottest": (".max_temperature", low, high, BEYOND),
        "melt suction": (".melt_suction", 0.0, VACUUM, 1.0),
        "unfed volume": (".unfed_volume", 0.0, math.inf, 1e-18),
        "gap": (".min_gap", 0.0 if exact else -math.inf, math.inf, 1e-9 * foundry.size),
    }
    wrong = []
    for what, (end, lower, upper, beyond) in least.items():
        values = [v for n, v in steps.items() if n.endswith(end) and not np.isnan(v).all()]
        if values and np.nanmin(values) < lower - beyond:
            wrong.append(f"{what} of {np.nanmin(values):.4g}, least {lower:.4g}")
        if values and np.nanmax(values) > upper + beyond:
            wrong.append(f"{what} of {np.nanmax(values):.4g}, at most {upper:.4g}")
    limits = {
        "cuts": MOST_CUTS, "most its": MOST_ITERATIONS, "most passes": MOST_PASSES,
        "energy": ENERGY, "error": BALANCE * (1 + 1e-9),
    }  # fmt: skip
    wrong += [f"{name} {of[name]:.4g}" for name, most in limits.items() if not of[name] <= most]
    return of, wrong + list(strength(foundry, folder))


def idle_pairs(log: Path) -> bool:
    """Return whether a run has said that some pairs carry no force, and may penetrate."""
    return log.exists() and "carry no force" in " ".join(log.read_text().split())


def largest(steps: Mapping[str, FloatArray], end: str) -> float:
    """Return the largest value of the columns with an end, zero without any."""
    found = [float(np.nanmax(values)) for name, values in steps.items() if name.endswith(end)]
    return max(found, default=0.0)


def strength(foundry: Foundry, folder: Path) -> Iterator[str]:
    """Yield castings that yield and whose last stress is beyond their strength."""
    results = Results(folder / "run")
    for body in foundry.case["bodies"]:
        metal = (
            foundry.case.get("materials", {})
            .get(body["material"], {})
            .get("extends", body["material"])
        )
        data = database(metal).get("tensile_strength")
        if data is None or body.get("law") not in LAWS[1:]:
            continue
        value = data["value"]
        strongest: FloatArray = (
            np.ravel(value)[1::2] if isinstance(value, list) else np.array([value])
        )
        most = float(strongest.max())
        try:
            stress = results.field("von_mises", body["name"]).values.max()
        except CaseError:
            continue  # taken out of the run
        if stress > most:
            yield f"{body['name']} of {stress:.3g} Pa, strength {most:.3g} Pa"


def line(
    number: int, foundry: Foundry, folder: Path, changes: Sequence[str] = ()
) -> dict[str, Any]:
    """Run a casting; return its line of the table, with what is wrong with it."""
    begin, place = time.perf_counter(), folder / f"{number:03d}"
    failed = run(written(foundry, place, changes), foundry.ranks)
    of: dict[str, float] = {}
    history = place / "run" / "history.csv"
    wrong: list[str] = []
    if history.exists() and len(history.read_text().splitlines()) > 2:
        of, wrong = judged(foundry, place)
    casting, mould = foundry.case["bodies"][-1], foundry.case["bodies"][0]
    first = foundry.case["interfaces"][-1]
    parts = [word for word in foundry.words if word in PARTS]
    element = casting.get("formulation", casting.get("stabilisation", "osgs"))
    cells = {
        "number": number, "part": " ".join([foundry.case["geometry"]["model"], *parts]),
        "cells": filled(foundry)[0].size, "alloy": casting["material"],
        "mould": mould["material"], "size m": f"{foundry.size:.2g}", "law": casting["law"][7:],
        "element": element if foundry.cells == SIMPLICES else "q1p0",
        "contact": first["contact"]["method"] + (" μ" if "friction" in first["contact"] else ""),
        "heat": first["heat"].get("law", "database"),
        "with": " ".join(w for w in foundry.words if w not in PARTS), "ranks": foundry.ranks,
        "ended": failed or "yes", "wall s": round(time.perf_counter() - begin),
    }  # fmt: skip
    return cells | of | {"wrong": ([f"did not end ({failed})"] if failed else []) + wrong}


def shown(value: Any) -> str:
    """Return a cell of the table."""
    if isinstance(value, float | np.floating):
        return f"{value:.0f}" if value == round(value) else f"{value:.1e}"
    return str(value)


def show(cells: Mapping[str, Any]) -> None:
    """Print a line of the table."""
    text = "".join(f"{shown(cells.get(name, ''))[: width - 1]:>{width}}" for name, width in COLUMNS)
    print(text + "".join(f"\n       ! {wrong}" for wrong in cells.get("wrong", ())), flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the castings; return 1 when something is wrong with one."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=20, help="castings (20)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (1)")
    parser.add_argument("--folder", type=Path, help="of case files and results")
    parser.add_argument("--only", nargs="*", type=int, help="numbers of castings")
    parser.add_argument("--changes", nargs="*", choices=CHANGES, default=[], help="of each casting")
    asked = parser.parse_args(arguments)
    folder = asked.folder or Path(tempfile.mkdtemp(prefix="foundries-"))
    show({name: name for name, _ in COLUMNS})
    lines = []
    for number in asked.only or range(asked.count):
        lines.append(
            line(number, foundry(random.Random(f"{asked.seed}/{number}")), folder, asked.changes)
        )
        show(lines[-1])
    with (folder / "table.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, [*(name for name, _ in COLUMNS), "wrong"])
        writer.writeheader()
        writer.writerows(lines)
    wrong = [cells["number"] for cells in lines if cells["wrong"]]
    print(f"{len(lines) - len(wrong)} of {len(lines)} castings are right; not: {wrong or 'none'}")
    for name in ("steps", "cuts", "passes", "its", "wall s"):
        print(f"{name} in all: {sum(cells.get(name, 0) for cells in lines):.0f}")
    print(f"files in {folder}")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
