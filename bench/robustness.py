"""Castings drawn at random, run as a user would: do they all reach their end without help?

    bin/with-fenicsx python3 bench/robustness.py [COUNT] [SEED] [--folder DIR] [--only NUMBER ...]

Each casting (60 unless said otherwise) is an axisymmetric or plane part of a generator, with alloy,
mould material, size from 5 mm to 1 m, superheat, mould temperature, closed-gap coefficient,
interface law, law of the material, contact method and step limits drawn independently. A line tells
what its run took; the last lines sum up. Case files and results stay in the folder.
"""

from __future__ import annotations

import argparse
import csv
import json
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

from castx.contact.methods.registry import names
from castx.materials.inelastic import FLOW_RULES
from castx.transfer.keys import GAS_CONDUCTIVITY, OPEN, RADIATION, ROUGH
from castx.transfer.registry import gap_heat_laws

LIQUIDUS = {
    "Al-pure": 660.3, "AlSi7Mg": 613.0, "AlSi9Cu3": 590.0, "AlCu4.5": 645.0, "Cu-pure": 1084.6,
    "CuSn12": 999.0, "G20Mn5": 1510.0, "GJL-250": 1195.0, "GJS-400": 1160.0,
}  # fmt: skip
ALLOYS = tuple(LIQUIDUS)
MOULDS = ("steel-H13", "steel-carbon", "sand-silica")
LAWS = ("thermo-elastic", "thermo-elasto-plastic", "thermo-elasto-viscoplastic")
METHODS = names(lambda method: method.fallback)
ELEMENTS = 7
"""Elements across the casting."""
PATIENCE = 1800.0
"""Wall clock time after which a run counts as lost [s]."""
COLUMNS = (
    ("number", 4), ("generator", 18), ("alloy", 18), ("mould", 13), ("size m", 8), ("h", 7),
    ("law of heat", 15), ("law", 27), ("contact", 21), ("steps", 6), ("cuts", 5),
    ("fallbacks", 10), ("passes", 7), ("its", 6), ("reached", 8), ("solid", 6), ("exit", 5),
    ("wall s", 7),
)  # fmt: skip


def logarithmic(dice: random.Random, low: float, high: float) -> float:
    """Return a number whose logarithm is uniform, with three digits."""
    return float(f"{math.exp(dice.uniform(math.log(low), math.log(high))):.3g}")


def heat_law(dice: random.Random) -> dict[str, Any]:
    """Return an interface law with numbers in their usual ranges, and keys that it may use."""
    laws = gap_heat_laws()
    law = laws[dice.choice((*laws, "limited"))]
    joined = {key.name for key in (OPEN, GAS_CONDUCTIVITY, *ROUGH)}  # depend on other keys
    also = [key for key in law.useful if key.name not in joined and dice.random() < 0.4]
    if law.exchange == "none":
        also = [RADIATION]  # without it nothing passes
    return law.example(lambda low, high: logarithmic(dice, low, high), also)


def geometry(dice: random.Random, size: float) -> tuple[dict[str, Any], list[dict[str, Any]], str]:
    """Return the part, the conditions that hold it, and the name of the body that is no casting."""
    cells = {"cells": "quadrilaterals"} if dice.random() < 0.3 else {}
    common = {"size": size / ELEMENTS, **cells}
    kind = dice.choice(("cylinder_in_mould", "cylinder_in_mould", "core_in_ring", "box_in_mould"))
    normal = {"normal": 0.0}
    if kind == "cylinder_in_mould":
        shape = {
            "generator": kind, "model": "axisymmetric", "radius": size,
            "height": size * round(dice.uniform(1.0, 3.0), 1),
            "wall": size * round(dice.uniform(0.5, 2.0), 1),
        }  # fmt: skip
        if dice.random() < 0.5:
            shape["floor"] = 0.5 * size
            return shape | common, [{"on": "mould/base", "displacement": normal}], "mould"
        held = [{"on": f"{name}/base", "displacement": normal} for name in ("casting", "mould")]
        return shape | common, held, "mould"
    if kind == "core_in_ring":
        core = size * round(dice.uniform(0.5, 2.0), 1)
        shape = {
            "generator": kind, "model": "axisymmetric", "core_radius": core,
            "outer_radius": core + size, "height": 2 * size,
        }  # fmt: skip
        held = [{"on": f"{name}/base", "displacement": normal} for name in ("casting", "core")]
        cooling = {"type": "convection", "coefficient": logarithmic(dice, 20.0, 2000.0)}
        held.append({"on": "casting/outside", "heat": {**cooling, "ambient": 25.0}})
        return shape | common, held, "core"
    model = dice.choice(("plane-strain", "generalised-plane-strain"))
    shape = {
        "generator": kind, "model": model, "box": [2 * size, size], "wall": size,
        "lid": dice.random() < 0.3,
    }  # fmt: skip
    return shape | common, [{"on": "mould/base", "displacement": {"all": 0.0}}], "mould"


def casting(dice: random.Random) -> dict[str, Any]:
    """Return a case."""
    alloy, material = dice.choice(ALLOYS), dice.choice(MOULDS)
    size = logarithmic(dice, 0.005, 1.0)
    shape, boundaries, other = geometry(dice, size)
    superheat = round(dice.uniform(0.0, 150.0), 1)
    law, method = dice.choice(LAWS), dice.choice(METHODS)
    melting = LIQUIDUS[alloy]
    rigid = material == "sand-silica"
    law_of_mould = "rigid" if rigid else "thermo-elastic"
    mould: dict[str, Any] = {"name": other, "material": material, "law": law_of_mould}
    mould["temperature"] = round(dice.uniform(20.0, min(500.0, 0.6 * melting)), 1)
    if not rigid:
        mould["formulation"] = "displacement"
    heat = heat_law(dice)
    freezing = time_to_freeze(size, heat.get("closed", 1000.0), melting, rigid)
    end = float(f"{freezing * dice.uniform(0.5, 3.0):.3g}")
    steps = {
        "end": end,
        "largest_step": end / dice.choice((10, 20, 50)),
        "first_step": end / logarithmic(dice, 100.0, 3000.0),
        "smallest_step": end * 1e-7,
        "temperature_change": dice.choice((10, 20, 50, 100)),
    }
    if other == "mould":
        boundaries.append({"on": "mould/outside", "heat": outside(dice)})
    if rigid:
        boundaries = [b for b in boundaries if b["on"] != f"{other}/base" or "heat" in b]
    body = {"name": "casting", "material": alloy, "law": law, "temperature": melting + superheat}
    contact = {"method": "rigid" if rigid and method == "condensed" else method}
    case = {
        "geometry": shape,
        "bodies": [body, mould],
        "interfaces": [{"bodies": ["casting", other], "contact": contact, "heat": heat}],
        "boundaries": boundaries,
        "time": steps,
        "output": {"fields": ["temperature"]},
    }
    if dice.random() < 0.7:
        case["loads"] = {"gravity": [0, 0, -9.81] if "axis" in shape["model"] else [0, -9.81, 0]}
    if law == "thermo-elasto-viscoplastic":
        draw_flow(dice, case, alloy)
    return case


def draw_flow(dice: random.Random, case: dict[str, Any], alloy: str) -> None:
    """Let the casting flow by a rule of castx, with its example if it is not that of the alloy."""
    rule = FLOW_RULES[dice.choice(tuple(FLOW_RULES))]
    if not rule.is_default:
        name = f"{alloy} {rule.name}"
        case["materials"] = {name: {"extends": alloy, "law": rule.name, **rule.example}}
        case["bodies"][0]["material"] = name


def outside(dice: random.Random) -> dict[str, Any]:
    """Return what the mould exchanges with its surroundings."""
    if dice.random() < 0.3:
        return {"type": "insulated"}
    return {"type": "convection", "coefficient": logarithmic(dice, 5.0, 2000.0), "ambient": 25.0}


def time_to_freeze(size: float, closed: float, melting: float, sand: bool) -> float:
    """Return about how long a casting freezes [s]: by the interface, and by the mould."""
    heat = 1.5e9 * size / 2
    through = heat / (closed * max(melting - 300.0, 100.0))
    effusivity = 900.0 if sand else 12_000.0
    into = (heat / (effusivity * max(melting - 300.0, 100.0))) ** 2 * math.pi / 4
    return through + into + 0.2 * size**2 / 2e-5


def toml(case: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of a case file."""
    for key, value in case.items():
        if isinstance(value, list):
            yield from (f"[[{key}]]\n{keys(item)}" for item in value)
        else:
            yield f"[{key}]\n{keys(value)}"


def keys(table: Mapping[str, Any]) -> str:
    """Return the keys of a table, one in each line."""
    return "".join(f"{json.dumps(key)} = {inline(value)}\n" for key, value in table.items())


def inline(value: Any) -> str:
    """Return a value in one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {inline(item)}" for key, item in value.items()) + " }"
    return json.dumps(value)


def run(number: int, case: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Run a case in a process of its own; return a line of the table."""
    file, results = folder / f"{number:03d}.toml", folder / f"{number:03d}"
    file.write_text("\n".join(toml(case)))
    command = [sys.executable, "-m", "castx", "run", str(file), "--output", str(results)]
    begin = time.perf_counter()
    try:
        ended = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE, env=dict(os.environ)
        )
        code: int | str = ended.returncode
        (folder / f"{number:03d}.log").write_text(ended.stdout + ended.stderr)
    except subprocess.TimeoutExpired:
        code = "time"
    wall = time.perf_counter() - begin
    casting, mould = case["bodies"]
    interface = case["interfaces"][0]
    line = {
        "number": number, "generator": case["geometry"]["generator"], "alloy": casting["material"],
        "mould": mould["material"], "size m": f"{case['geometry']['size'] * ELEMENTS:.3g}",
        "h": interface["heat"].get("closed", ""), "law of heat": interface["heat"]["law"],
        "law": casting["law"], "contact": interface["contact"]["method"], "exit": code,
        "wall s": f"{wall:.0f}",
    }  # fmt: skip
    return line | taken(results, case["time"]["end"])


def taken(results: Path, end: float) -> dict[str, Any]:
    """Return what a run took, from its record."""
    try:
        record = json.loads((results / "run.json").read_text())
    except (OSError, ValueError):
        return {}
    totals = record["totals"]
    return {
        "steps": totals["steps"], "cuts": totals["cutbacks"], "passes": totals["passes"],
        "fallbacks": totals["fallbacks"],
        "its": totals["mechanics_iterations"], "reached": f"{record['time_reached'] / end:.0%}",
        "solid": f"{record['last'].get('casting.solid_fraction') or 0.0:.0%}",
    }  # fmt: skip


def show(cells: Mapping[str, Any]) -> None:
    """Print a line of the table."""
    print("".join(f"{cells.get(name, '')!s:>{width}}" for name, width in COLUMNS), flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the castings; return 1 when one did not reach its end."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("count", nargs="?", type=int, default=60)
    parser.add_argument("seed", nargs="?", type=int, default=1)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--only", nargs="*", type=int)
    asked = parser.parse_args(arguments)
    folder = asked.folder or Path(tempfile.mkdtemp(prefix="robustness-"))
    folder.mkdir(parents=True, exist_ok=True)
    show({name: name for name, _ in COLUMNS})
    lines = []
    for number in range(asked.count):
        if asked.only and number not in asked.only:
            continue
        # A generator of its own: each casting stays what it is when others change.
        lines.append(run(number, casting(random.Random(f"{asked.seed}/{number}")), folder))
        show(lines[-1])
    with (folder / "table.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, [name for name, _ in COLUMNS], extrasaction="ignore")
        writer.writeheader()
        writer.writerows(lines)
    lost = [line["number"] for line in lines if line["exit"] != 0]
    print(f"{len(lines) - len(lost)} of {len(lines)} reached their end; not: {lost or 'none'}")
    for name in ("steps", "cuts", "fallbacks"):
        print(f"{name} in all: {sum(line.get(name, 0) for line in lines)}")
    print(f"files in {folder}")
    return int(bool(lost))


if __name__ == "__main__":
    sys.exit(main())
