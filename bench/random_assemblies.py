"""Do CAD assemblies drawn at random run, or are they refused with a place and a cure?

    bin/with-fenicsx python3 bench/random_assemblies.py --seed 1 --count 60 --folder DIR

A casting of boxes, cylinders and cones with bosses, holes and fillets is drawn by OpenCASCADE,
alone or in a block, in two halves, with core, chill and pin, turned and of any size; in some the
bodies miss or overlap each other. Each is written as STEP, `castx new` writes its case, and it runs
five steps. A line judges it: right are those that run with the volumes of CAD, and those that are
refused with a place or a file, and a cure; what OpenCASCADE itself cannot draw does not count. The
last lines sum up.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import random
import re
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import gmsh
import numpy as np

from castx.case.reading.read import load_case
from castx.domain.source import gmsh_session, named_mesh
from castx.errors import CaseError, MeshError
from castx.results.files.series import read_series

STEP = 0.02
"""Time that the first step takes in a part of 0.1 m [s]; it grows with the square of the size."""
PATIENCE = 900.0
"""Wall clock time after which a command counts as lost [s]."""
COARSER = 1.8
"""Size of the cells beside that of the case that castx writes, so that a run takes a minute."""
CURVATURE = 6
COARSE = 0.3
"""Missing or added share of a body's volume beyond which its mesh counts as wrong."""
CLOSED = 1e-4
"""Distance by which bodies miss each other where they do, beside the size of the part."""
COLUMNS = (
    ("number", 7), ("drawn", 44), ("size m", 8), ("bodies", 7), ("faces", 6), ("cells", 8),
    ("quality", 8), ("volume", 8), ("ended", 8), ("steps", 6), ("cuts", 5), ("CPU s", 7),
)  # fmt: skip
PLACE = re.compile(r"\([-+.\de]+, [-+.\de]+, [-+.\de]+\)")
Tags = list[tuple[int, int]]


class Drawing(NamedTuple):
    """Solids of the current gmsh model, in millimetres.

    Attributes:
        solids: their tags; the casting first.
        words: what was drawn.
    """

    solids: list[int]
    words: list[str]


def casting(dice: random.Random, drawing: Drawing, size: float) -> int:
    """Return a casting of about a size [mm] on z = 0: a base, bosses, holes, fillets."""
    occ = gmsh.model.occ
    kind = dice.choice(("box", "box", "cylinder", "cone"))
    sides = [size * dice.uniform(0.5, 1.0) for _ in range(3)]
    radius = sides[0] / 2
    if kind == "box":
        base = occ.addBox(-sides[0] / 2, -sides[1] / 2, 0, *sides)
    elif kind == "cylinder":
        base = occ.addCylinder(0, 0, 0, 0, 0, sides[2], radius)
    else:
        base = occ.addCone(0, 0, 0, 0, 0, sides[2], radius, radius * dice.uniform(0.3, 0.9))
    drawing.words.append(kind)
    for _ in range(dice.choice((0, 0, 1, 2))):
        base = with_boss(dice, drawing, base, sides)
    if dice.random() < 0.4:
        width = radius * dice.uniform(0.2, 0.5)
        axis = dice.choice(((0, 0, 3), (3, 0, 0)))
        foot = [-size * 1.5 * a / 3 + (sides[2] / 2 if i == 2 and a == 0 else 0)
                for i, a in enumerate(axis)]  # fmt: skip
        hole = occ.addCylinder(*foot, *(size * a for a in axis), width)
        base = only(occ.cut([(3, base)], [(3, hole)])[0])
        drawing.words.append("hole")
    if dice.random() < 0.5:
        base = filleted(dice, drawing, base, size * dice.uniform(0.02, 0.08))
    return int(base)


def with_boss(dice: random.Random, drawing: Drawing, base: int, sides: Sequence[float]) -> int:
    """Return a casting with a boss on top or at a side."""
    occ = gmsh.model.occ
    width = min(sides) * dice.uniform(0.15, 0.35)
    x, y = (dice.uniform(-0.2, 0.2) * side for side in sides[:2])
    if dice.random() < 0.5:
        boss = occ.addCylinder(x, y, sides[2] / 2, 0, 0, sides[2], width)
    else:
        boss = occ.addBox(0, y, sides[2] * 0.3, sides[0] * 0.9, width, width)
    drawing.words.append("boss")
    return only(occ.fuse([(3, base)], [(3, boss)])[0])


def filleted(dice: random.Random, drawing: Drawing, base: int, radius: float) -> int:
    """Return a casting with fillets or chamfers on some edges, or without if there is no room."""
    occ = gmsh.model.occ
    occ.synchronize()
    edges = [tag for _, tag in gmsh.model.getBoundary([(3, base)], oriented=False, recursive=False)]
    edges = [t for _, t in gmsh.model.getBoundary([(2, f) for f in edges], False, False, False)]
    chosen = dice.sample(sorted(set(edges)), min(len(set(edges)), dice.choice((1, 3, 6))))
    copy = occ.copy([(3, base)])
    try:
        made = occ.fillet([base], chosen, [radius])
    except Exception:  # gmsh raises nothing more special
        return only(copy)
    occ.remove(copy, recursive=True)
    drawing.words.append("fillets")
    return only(made)


def only(made: Tags) -> int:
    """Return the largest solid of a result, and remove the others."""
    occ = gmsh.model.occ
    solids = sorted((tag for dim, tag in made if dim == 3), key=lambda tag: -occ.getMass(3, tag))
    for tag in solids[1:]:
        occ.remove([(3, tag)], recursive=True)
    return solids[0]


def block(dice: random.Random, drawing: Drawing, size: float) -> None:
    """Add a block round all solids that are there, open above or closed, in one or two parts."""
    occ = gmsh.model.occ
    bounds = np.array([occ.getBoundingBox(3, tag) for tag in drawing.solids])
    low, high = bounds[:, :3].min(axis=0), bounds[:, 3:].max(axis=0)
    wall = size * dice.uniform(0.15, 0.5)
    top = high[2] + (0.0 if dice.random() < 0.5 else wall)
    low, high = low - wall, np.array([high[0] + wall, high[1] + wall, top])
    middle = low + (high - low) * dice.uniform(0.35, 0.65)
    axis = dice.choice((None, 0, 2))
    ends = [(low, high)]
    if axis is not None:
        first, second = high.copy(), low.copy()
        first[axis] = second[axis] = middle[axis]
        ends = [(low, first), (second, high)]
    inside = [(3, tag) for tag in drawing.solids]
    made = []
    for start, end in ends:
        whole = occ.addBox(*start, *(end - start))
        made.append(only(occ.cut([(3, whole)], inside, removeTool=False)[0]))
    drawing.solids.extend(made)
    drawing.words.append("block" if axis is None else f"halves {'xyz'[axis]}")


def addition(dice: random.Random, drawing: Drawing, size: float) -> None:
    """Add a core through the casting, a chill under it or a pin on top, cut out of the casting."""
    occ = gmsh.model.occ
    part = drawing.solids[0]
    x0, y0, z0, x1, y1, z1 = occ.getBoundingBox(3, part)
    kind = dice.choice(("core", "chill", "pin"))
    if kind == "core":
        width = (y1 - y0) * dice.uniform(0.08, 0.2)
        length = x1 - x0
        start = (x0 - 0.1 * length, (y0 + y1) / 2, z0 + (z1 - z0) * 0.4)
        tool = occ.addCylinder(*start, 1.2 * length, 0, 0, width)
    elif kind == "chill":
        sides = [0.4 * (x1 - x0), 0.4 * (y1 - y0)]
        tool = occ.addBox(
            -sides[0] / 2, -sides[1] / 2, z0 - 0.1 * size, *sides, size * dice.choice((0.1, 0.15))
        )
    else:
        tool = occ.addCone(0, 0, z1 - 0.2 * (z1 - z0), 0, 0, 0.4 * size, 0.06 * size, 0.1 * size)
    others = [(3, tag) for tag in drawing.solids[1:]]
    if others:
        left = occ.cut([(3, tool)], others, removeTool=False)[0]
        if not any(dim == 3 for dim, _ in left):
            return
        tool = only(left)
    drawing.solids[0] = only(occ.cut([(3, part)], [(3, tool)], removeTool=False)[0])
    drawing.solids.append(tool)
    drawing.words.append(kind)


def drawn(dice: random.Random, size: float) -> Drawing:
    """Draw an assembly of about a size [mm] into the current gmsh model."""
    occ = gmsh.model.occ
    drawing = Drawing([], [])
    drawing.solids.append(casting(dice, drawing, size))
    for _ in range(dice.choice((0, 0, 1, 1, 2, 3))):
        addition(dice, drawing, size)
    if len(drawing.solids) > 1 or dice.random() < 0.7:
        block(dice, drawing, size)
    fault = dice.choice(("", "", "", "", "miss", "overlap"))
    if fault and len(drawing.solids) > 1:
        by = size * CLOSED * dice.uniform(0.3, 3.0) * (1 if fault == "miss" else -1)
        occ.translate([(3, drawing.solids[0])], 0, 0, by)
        drawing.words.append(fault)
    if dice.random() < 0.4:
        direction = [dice.uniform(-1, 1) for _ in range(3)]
        occ.rotate([(3, tag) for tag in drawing.solids], 0, 0, 0, *direction, dice.uniform(0.1, 3))
        drawing.words.append("turned")
    occ.synchronize()
    return drawing


def written(dice: random.Random, file: Path) -> tuple[Drawing, float]:
    """Write an assembly as STEP; return it with its size [m]."""
    size = float(f"{math.exp(dice.uniform(math.log(5.0), math.log(1000.0))):.3g}")
    with gmsh_session():
        drawing = drawn(dice, size)
        stray = [e for e in gmsh.model.getEntities(3) if e[1] not in drawing.solids]
        gmsh.model.occ.remove(stray, recursive=True)
        gmsh.model.occ.synchronize()
        gmsh.write(str(file))
    return drawing, 1e-3 * size


def command(*arguments: str) -> tuple[int, str]:
    """Return exit code and words of castx; a code of -1 if it takes too long."""
    try:
        ended = subprocess.run(
            [sys.executable, "-m", "castx", *arguments], capture_output=True, text=True,
            timeout=PATIENCE, env={**os.environ, "COLUMNS": "10000"}, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return -1, "it took too long"
    return ended.returncode, ended.stdout + ended.stderr


def options(case: Path, size: float, steps: int) -> list[str]:
    """Return the keys that make a coarse mesh and a run of some steps of a part of a size [m]."""
    step = STEP * (size / 0.1) ** 2
    keys = {
        "geometry.size": COARSER * size_of_cells(case), "geometry.curvature": CURVATURE,
        "time.end": max(steps, 1) * step, "time.first_step": step, "time.largest_step": step,
        "time.smallest_step": 1e-3 * step, "time.temperature_change": 2000,
    }  # fmt: skip
    return [f"{key}={value:.6g}" for key, value in keys.items()]


def size_of_cells(case: Path) -> float:
    """Return the largest size of the cells of a case [m]."""
    cad = load_case(case).geometry.cad
    assert cad is not None
    return cad.size


def meshed(case: Path, overrides: Sequence[str]) -> dict[str, Any]:
    """Return the cells of a case, their worst quality, and the largest difference of volumes."""
    read = load_case(case, overrides)
    report = named_mesh(read.geometry, [body.name for body in read.bodies]).report
    assert report is not None
    off = max(abs(body.mesh / body.cad - 1.0) for body in report.bodies)
    faces = sum(measure.parts for measure in (*report.surfaces, *report.interfaces))
    return {
        "bodies": len(report.bodies), "faces": faces, "cells": report.quality.cells,
        "quality": report.quality.worst, "volume": off,
    }  # fmt: skip


def line(number: int, seed: int, folder: Path, steps: int) -> dict[str, Any]:
    """Draw, mesh and run an assembly; return its line of the table, with what is wrong with it."""
    begin = cpu_seconds()
    step, case = folder / f"{number:03d}.step", folder / f"{number:03d}.toml"
    case.unlink(missing_ok=True)
    try:
        drawing, size = written(random.Random(f"{seed}/{number}"), step)
    except Exception as error:  # gmsh raises nothing more special
        return {"number": number, "drawn": "-", "ended": "undrawn", "said": str(error), "wrong": []}
    cells: dict[str, Any] = {
        "number": number, "drawn": " ".join(drawing.words), "size m": f"{size:.2g}",
        "bodies": len(drawing.solids), "said": "",
    }  # fmt: skip
    code, said = command("new", str(step))
    if code == 0:
        try:
            overrides = options(case, size, steps)
            cells |= meshed(case, overrides)
        except (CaseError, MeshError) as error:
            code, said = 2, str(error)
    if code == 0 and steps:
        code, said = command("run", str(case), "--output", str(case.with_suffix("")),
                             *(word for item in overrides for word in ("--set", item)))  # fmt: skip
        history = case.with_suffix("") / "history.csv"
        if history.is_file():
            found = read_series(history)
            cells |= {"steps": len(found["time"]) - 1, "cuts": int(found["cutbacks"].sum())}
    (folder / f"{number:03d}.log").write_text(said)
    words = {0: "ran" if steps else "meshed", 2: "refused", -1: "time"}
    cells["ended"] = words.get(code, str(code))
    if code:
        cells["said"] = refusal(said)
    cells["wrong"] = list(wrongs(cells, steps))
    return cells | {"CPU s": round(cpu_seconds() - begin)}


def cpu_seconds() -> float:
    """Return the CPU time of this process and of those that it has waited for [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(own.ru_utime + own.ru_stime for own in used)


def refusal(said: str) -> str:
    """Return what castx has said at last, in one line."""
    lines = [text.strip() for text in said.splitlines() if text.strip()]
    start = next((i for i, text in enumerate(lines) if text.startswith("castx: ")), 0)
    return " ".join(lines[start:])


def wrongs(cells: Mapping[str, Any], steps: int) -> Iterator[str]:
    """Yield what is wrong with an assembly."""
    match cells["ended"]:
        case "ran" | "meshed":
            if steps and cells["steps"] < steps:
                yield f"{cells['steps']} steps"
            if cells["volume"] > COARSE:
                yield f"a volume is off by {cells['volume']:.2g}"
        case "refused":
            if not (PLACE.search(cells["said"]) or ".step" in cells["said"]):
                yield "the refusal has no place"
            if ";" not in cells["said"]:
                yield "the refusal has no cure"
        case ended:
            yield f"ended by {ended}"


def shown(value: Any) -> str:
    """Return a cell of the table."""
    return f"{value:.1e}" if isinstance(value, float) else str(value)


def show(cells: Mapping[str, Any]) -> None:
    """Print a line of the table."""
    text = "".join(f"{shown(cells.get(name, ''))[: width - 1]:>{width}}" for name, width in COLUMNS)
    said = f"\n       {cells['said'][:600]}" if cells.get("said") else ""
    print(text + said + "".join(f"\n       ! {wrong}" for wrong in cells.get("wrong", ())),
          flush=True)  # fmt: skip


def parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=20, help="assemblies (20)")
    parser.add_argument("--first", type=int, default=0, help="number of the first one (0)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (1)")
    parser.add_argument("--steps", type=int, default=5, help="of each run; 0: mesh alone (5)")
    parser.add_argument("--folder", type=Path, help="of STEP files, cases and results")
    parser.add_argument("--only", nargs="*", type=int, help="numbers of assemblies")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the assemblies; return 1 when something is wrong with one."""
    asked = parsed(arguments)
    folder = asked.folder or Path(tempfile.mkdtemp(prefix="assemblies-"))
    folder.mkdir(parents=True, exist_ok=True)
    show({name: name for name, _ in COLUMNS})
    lines = []
    for number in range(asked.first, asked.first + asked.count):
        if not asked.only or number in asked.only:
            lines.append(line(number, asked.seed, folder, asked.steps))
            show(lines[-1])
    with (folder / "table.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, [*(name for name, _ in COLUMNS), "said", "wrong"])
        writer.writeheader()
        writer.writerows(lines)
    lines = [cells for cells in lines if cells["ended"] != "undrawn"]
    ended = [cells["ended"] for cells in lines]
    wrong = [cells["number"] for cells in lines if cells["wrong"]]
    done = len(lines) - len(wrong) - ended.count("refused")
    print(f"{done} of {len(lines)} assemblies ran, {ended.count('refused')} were refused; "
          f"wrong: {wrong or 'none'}")  # fmt: skip
    print(f"steps in all: {sum(cells.get('steps', 0) for cells in lines)}, "
          f"cut: {sum(cells.get('cuts', 0) for cells in lines)}")  # fmt: skip
    print(f"files in {folder}")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
