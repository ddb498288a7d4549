"""Do castings drawn at random end at default settings, in balance and alike by exact methods?

    bin/with-fenicsx python3 bench/random_castings.py --seed 1 --count 100 --folder DIR

Part, alloy, mould, law, liquid, gravity, contact method, friction, interface law and mesh are drawn
independently, and nothing is said about solvers and steps. Every casting runs by the drawn method
and, without friction, by `multipliers` and `condensed` too, whose gaps and forces are compared. A
line judges a casting by what its runs wrote in every accepted step; the last lines sum up.
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
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.contact.methods.registry import METHODS, names
from castx.materials.inelastic import FLOW_RULES
from castx.results.files.series import read_series
from castx.transfer.keys import GAS_CONDUCTIVITY, OPEN, RADIATION, ROUGH
from castx.transfer.registry import gap_heat_laws

ALLOYS = (
    "Al-pure", "AlSi7Mg", "AlSi9Cu3", "AlCu4.5", "Cu-pure", "CuSn12", "G20Mn5", "GJL-250",
    "GJS-400",
)  # fmt: skip
MOULDS = ("steel-H13", "steel-carbon", "GJL-250", "Cu-pure")
LAWS = ("thermo-elastic", "thermo-elasto-plastic", "thermo-elasto-viscoplastic")
EXACT = ("multipliers", "condensed")
METHOD_NAMES = names(lambda method: method.fallback)
PLANE_MODELS = ("plane-strain", "plane-strain", "plane-stress", "generalised-plane-strain")
G = 9.81
PATIENCE = 600.0
"""Wall clock time after which a run counts as lost [s]."""
BALANCE = 1e-3
"""Missing part of the forces on a body, and of the weight in contact and supports: the default
tolerance of castx."""
PULL = 2e-3
"""Pull of a pair that counts as one, beside the weight of the casting; without it none does."""
DEEP = 1e-3
"""Penetration of a mould by a method that has one, beside the length of its casting."""
ALIKE = 0.02
"""Difference between two exact methods, beside the largest gap of the run."""
COLUMNS = (
    ("number", 7), ("part", 29), ("alloy", 9), ("mould", 13), ("size m", 8), ("law", 21),
    ("liquid", 9), ("heat", 15), ("contact", 22), ("ended", 6), ("steps", 6), ("cuts", 5),
    ("frozen", 7), ("violated", 9), ("fallback", 9), ("finished", 9), ("its", 6), ("error", 9),
    ("pull", 9), ("deepest", 9), ("weight", 9), ("alike", 9), ("wall s", 7),
)  # fmt: skip
Case = dict[str, Any]


def logarithmic(dice: random.Random, low: float, high: float) -> float:
    """Return a number whose logarithm is uniform, with three digits."""
    return float(f"{math.exp(dice.uniform(math.log(low), math.log(high))):.3g}")


def part(dice: random.Random, size: float) -> dict[str, Any]:
    """Return the geometry of a casting of about a size [m] that rests in its mould."""
    kind = dice.choice((*("box", "cylinder") * 5, *("lid",) * 3, "space"))
    across = 3 if kind == "space" else dice.choice((3, 4, 5))
    common: dict[str, Any] = {
        "wall": round(size * dice.uniform(0.3, 0.8), 5), "size": round(size / across, 6)
    }  # fmt: skip
    if dice.random() < 0.3:
        common["cells"] = "quadrilaterals"
    if kind == "cylinder":
        return {
            "generator": "cylinder_in_mould", "model": "axisymmetric", "radius": size / 2,
            "height": round(size * dice.uniform(0.6, 1.6), 5), "floor": round(size * 0.4, 5),
        } | common  # fmt: skip
    sides = [round(size * dice.uniform(0.7, 1.3), 5) for _ in range(3 if kind == "space" else 2)]
    model = "3d" if kind == "space" else dice.choice(PLANE_MODELS)
    lid = {"lid": True} if kind == "lid" else {}
    return {"generator": "box_in_mould", "model": model, "box": sides} | lid | common


def heat_law(dice: random.Random) -> dict[str, Any]:
    """Return an interface law with numbers in their usual ranges, and keys that it may use."""
    laws = {name: law for name, law in gap_heat_laws().items() if law.exchange != "none"}
    law = laws[dice.choice((*laws, "limited", "series"))]
    joined = {key.name for key in (OPEN, GAS_CONDUCTIVITY, *ROUGH)}  # depend on other keys
    also = [key for key in law.useful if key.name not in joined and dice.random() < 0.3]
    if RADIATION in law.useful and RADIATION not in also and dice.random() < 0.2:
        also.append(RADIATION)
    return law.example(lambda low, high: logarithmic(dice, low, high), also)


def material(dice: random.Random, case: Case, alloy: str, law: str) -> None:
    """Give the casting its liquid and flow rule, those of the database in most cases."""
    changes: dict[str, Any] = {}
    liquid = dice.choice((*("database",) * 6, "none", "viscous", "norton"))
    coherency = round(dice.uniform(0.5, 0.95), 2)
    shape = case["geometry"]
    if shape["model"] == "plane-stress" and ("cells" in shape or law != LAWS[0]):
        liquid = "none"  # such bodies have no incompressible liquid
    if liquid == "none":
        changes["liquid"] = "none"
    elif liquid == "viscous":
        viscosity = logarithmic(dice, 1e4, 1e7)
        changes["liquid"] = {"model": liquid, "viscosity": viscosity, "coherency": coherency}
    elif liquid == "norton":
        creep = {"coefficient": logarithmic(dice, 1e-12, 1e-10), "exponent": 2.0}
        changes["liquid"] = {"model": liquid, "coherency": coherency, **creep}
    if law == "thermo-elasto-viscoplastic" and dice.random() < 0.5:
        rule = FLOW_RULES[dice.choice(tuple(FLOW_RULES))]
        changes |= {"law": rule.name, **rule.example}
    if changes:
        case["materials"] = {"alloy": {"extends": alloy, **changes}}
        case["bodies"][0]["material"] = "alloy"


def casting(dice: random.Random) -> Case:
    """Return a case that says nothing about solvers, and of its time no more than the end."""
    alloy = dice.choice(ALLOYS)
    properties = database(alloy)
    melting, size = float(properties["liquidus"]["value"]), logarithmic(dice, 0.002, 1.0)
    mould = dice.choice([m for m in MOULDS if melts(m) > melting + 100.0])
    shape, law = part(dice, size), dice.choice(LAWS)
    contact: dict[str, Any] = {"method": dice.choice((*METHOD_NAMES, *EXACT * 6))}
    if METHODS[contact["method"]].friction and dice.random() < 0.3:
        contact["friction"] = round(dice.uniform(0.05, 0.4), 2)
    bodies, heat = ["casting", "mould"], heat_law(dice)
    if dice.random() < 0.3 and heat["law"] != "solid-fraction":  # which is that of the first body
        bodies.reverse()
    case: Case = {
        "geometry": shape,
        "bodies": [
            {"name": "casting", "material": alloy, "law": law,
             "temperature": round(melting + dice.uniform(5.0, 80.0), 1)},
            {"name": "mould", "material": mould, "temperature": dice.choice((20.0, 150.0, 250.0))},
        ],
        "interfaces": [{"bodies": bodies, "contact": contact, "heat": heat}],
        "boundaries": [
            {"on": "mould/base", "displacement": {"normal": 0.0}},
            {"on": "mould/outside",
             "heat": {"type": "convection", "coefficient": 30.0, "ambient": 20.0}},
        ],
    }  # fmt: skip
    material(dice, case, alloy, law)
    if dice.random() < 0.9:
        down = [0.0, 0.0, -G] if shape["model"] == "3d" else [0.0, -G]
        case["loads"] = {"gravity": down}
    # Of a sixth of the size [J/m²], through the interface and into the mould.
    released, drop = 3e9 * size / 6, melting - 200.0
    through = released / (heat.get("closed", 2000.0) * drop)
    end = (through + (released / (12_000.0 * drop)) ** 2) * dice.uniform(0.4, 1.5)
    case["time"] = {"end": float(f"{end:.3g}")}
    case["output"] = {"fields": ["temperature"]}
    return case


def database(name: str) -> dict[str, Any]:
    """Return an entry of the database."""
    text = (files("castx.materials") / "database" / f"{name}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def melts(name: str) -> float:
    """Return the temperature at which a mould melts [°C], as far as its entry has one."""
    return float(database(name).get("solidus", {"value": math.inf})["value"])


def length(case: Case) -> float:
    """Return the longest side of the casting [m]."""
    shape = case["geometry"]
    return float(max(shape.get("box", ()), default=shape.get("height")))


def weight(case: Case) -> float:
    """Return the weight of the casting [N], of a full turn and of a metre of depth in the plane."""
    shape, alloy = case["geometry"], case["bodies"][0]["material"]
    alloy = case.get("materials", {}).get(alloy, {}).get("extends", alloy)
    volume = math.prod(shape.get("box", ()))
    if "radius" in shape:
        volume = math.pi * shape["radius"] ** 2 * shape["height"]
    density = float(database(alloy)["density"]["value"])
    return float(density * volume * G * ("loads" in case))


def toml(case: Mapping[str, Any]) -> Iterator[str]:
    """Yield the lines of a case file."""
    for key, value in case.items():
        tables = value if isinstance(value, list) else [value]
        mark = "[[{}]]" if isinstance(value, list) else "[{}]"
        for table in tables:
            yield mark.format(key)
            yield from (f"{json.dumps(name)} = {inline(item)}" for name, item in table.items())


def inline(value: Any) -> str:
    """Return a value in one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(k)} = {inline(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(inline(item) for item in value) + "]"
    return json.dumps(value)


def methods(case: Case) -> list[str]:
    """Return the drawn method, and without friction both exact ones."""
    contact = case["interfaces"][0]["contact"]
    return list(dict.fromkeys((contact["method"], *(() if "friction" in contact else EXACT))))


def run(case: Case, method: str, file: Path, ranks: int) -> dict[str, FloatArray] | str:
    """Run a case by a method in a process of its own; return its history, or how it failed."""
    interface = case["interfaces"][0]
    contact = {**interface["contact"], "method": method}
    changed = {**case, "interfaces": [{**interface, "contact": contact}]}
    file.write_text("\n".join(toml(changed)) + "\n")
    results = file.with_suffix("")
    command = [sys.executable, "-m", "castx", "run", str(file), "--output", str(results)]
    if ranks > 1:
        command = ["mpirun", "-n", str(ranks), *command]
    try:
        ended = subprocess.run(
            command, capture_output=True, text=True, timeout=PATIENCE, env=dict(os.environ)
        )
    except subprocess.TimeoutExpired:
        return "time"
    file.with_suffix(".log").write_text(ended.stdout + ended.stderr)
    return read_series(results / "history.csv") if ended.returncode == 0 else str(ended.returncode)


def judged(case: Case, history: Mapping[str, FloatArray]) -> dict[str, float]:
    """Return the worst of all accepted steps of a run: forces by what acts, lengths in metres."""
    steps = {name: values[1:] for name, values in history.items()}
    interface = "/".join(case["interfaces"][0]["bodies"])
    axis = "z" if case["geometry"]["model"] in ("3d", "axisymmetric") else "y"
    load, up = weight(case), 1.0 if interface.startswith("casting") else -1.0
    carried = up * steps[f"{interface}.force.{axis}"] + steps[f"casting.support_force.{axis}"]
    pull = steps["largest_pull"] / (load or 1.0)
    deepest = np.maximum(-steps[f"{interface}.min_gap"], 0.0)
    frozen, size = steps["frozen_pairs"] > 0, length(case)
    violated = frozen & ((pull > PULL) | (deepest > 1e-9 * size))
    errors = [values for name, values in steps.items() if name.endswith(".force_error")]
    return {
        "steps": len(frozen), "cuts": steps["cutbacks"].sum(),
        "frozen": steps["frozen_pairs"].sum(), "violated": np.count_nonzero(violated),
        "fallback": steps["fallbacks"].sum(), "finished": steps["unbalanced"].sum(),
        "its": steps["mechanics_iterations"].sum(), "error": np.max(errors),
        "pull": pull.max() if load else 0.0, "deepest": deepest.max(),
        "weight": np.abs(carried / load - 1.0).max() if load else 0.0,
        "depth": deepest.max() / size,
    }  # fmt: skip


def difference(case: Case, one: Mapping[str, FloatArray], two: Mapping[str, FloatArray]) -> float:
    """Return how far gaps and forces of two runs are apart at common times.

    Gaps count beside the largest one, or a hundred-thousandth of the casting if they are less;
    resultants, where there is a weight, beside the largest one, or the weight. Where a step was
    cut, times differ, and the other run is interpolated.
    """
    interface = "/".join(case["interfaces"][0]["bodies"])

    def apart(name: str, least: float) -> float:
        other = np.interp(one["time"], two["time"], two[name])
        return float(np.abs(one[name] - other).max() / max(np.abs(one[name]).max(), least))

    gaps = [apart(f"{interface}.{kind}_gap", 1e-5 * length(case)) for kind in ("mean", "max")]
    load = weight(case)
    forces = [name for name in one if load and name.startswith(f"{interface}.force.")]
    largest = max([load, *(float(np.abs(one[name]).max()) for name in forces)])
    return max(*gaps, *(apart(name, largest) for name in forces))


def line(number: int, case: Case, folder: Path, ranks: int) -> dict[str, Any]:
    """Run a casting by its methods; return its line of the table, with what is wrong with it."""
    begin = time.perf_counter()
    found = {
        method: run(case, method, folder / f"{number:03d}-{method}.toml", ranks)
        for method in methods(case)
    }
    done = {name: item for name, item in found.items() if not isinstance(item, str)}
    of_runs = [judged(case, history) for history in done.values()]
    worst = {key: max(values[key] for values in of_runs) for key in (of_runs or [{}])[0]}
    exact = [done[name] for name in EXACT if name in done]
    compared = len(methods(case)) > 1 and len(exact) == 2
    alike = difference(case, *exact) if compared else None
    shape, interface = case["geometry"], case["interfaces"][0]
    alloy, contact = case["bodies"][0]["material"], interface["contact"]
    own = case.get("materials", {}).get("alloy", {})
    cells = {
        "number": number, "part": shape["model"] + (" lid" if "lid" in shape else ""),
        "alloy": own.get("extends", alloy), "mould": case["bodies"][1]["material"],
        "size m": f"{length(case):.2g}", "law": case["bodies"][0]["law"][7:],
        "liquid": liquid_name(own), "heat": interface["heat"]["law"],
        "contact": contact["method"] + (" μ" if "friction" in contact else ""),
        "ended": f"{len(done)}/{len(found)}",
        "alike": alike, "wall s": round(time.perf_counter() - begin),
    }  # fmt: skip
    return cells | worst | {"wrong": list(wrongs(found, worst, alike))}


def liquid_name(own: Mapping[str, Any]) -> str:
    """Return how a casting is liquid, from the properties of its case."""
    liquid = own.get("liquid", "default")
    return str(liquid if isinstance(liquid, str) else liquid["model"])


def wrongs(
    found: Mapping[str, object], worst: Mapping[str, float], alike: float | None
) -> Iterator[str]:
    """Yield what is wrong with a casting."""
    for method, history in found.items():
        if isinstance(history, str):
            yield f"{method} did not end ({history})"
    limits: dict[str, tuple[float, Callable[[float], str]]] = {
        "violated": (0, lambda n: f"{n:.0f} steps with a frozen pair in violation"),
        "error": (BALANCE, lambda e: f"forces are missing by {e:.1e}"),
        "weight": (BALANCE, lambda e: f"the weight is missed by {e:.1e}"),
        "pull": (PULL, lambda e: f"a pair pulls by {e:.1e} of the weight"),
        "depth": (DEEP, lambda e: f"penetration of {e:.1e} of the size"),
    }
    for name, (limit, say) in limits.items():
        if worst and not worst[name] <= limit * (1 + 1e-9):
            yield say(worst[name])
    if alike is not None and not alike <= ALIKE:
        yield f"exact methods differ by {alike:.1e}"


def shown(value: Any) -> str:
    """Return a cell of the table."""
    if isinstance(value, float | np.floating):
        return f"{value:.0f}" if value == round(value) else f"{value:.1e}"
    return "" if value is None else str(value)


def show(cells: Mapping[str, Any]) -> None:
    """Print a line of the table."""
    text = "".join(f"{shown(cells.get(name, ''))[: width - 1]:>{width}}" for name, width in COLUMNS)
    print(text + "".join(f"\n       ! {wrong}" for wrong in cells.get("wrong", ())), flush=True)


def parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=20, help="castings (20)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (1)")
    parser.add_argument("--jobs", type=int, default=1, help="castings at a time (1)")
    parser.add_argument("--ranks", type=int, default=1, help="of each run (1)")
    parser.add_argument("--folder", type=Path, help="of case files and results")
    parser.add_argument("--only", nargs="*", type=int, help="numbers of castings")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the castings; return 1 when something is wrong with one."""
    asked = parsed(arguments)
    folder = asked.folder or Path(tempfile.mkdtemp(prefix="castings-"))
    folder.mkdir(parents=True, exist_ok=True)
    show({name: name for name, _ in COLUMNS})
    numbers = [n for n in range(asked.count) if not asked.only or n in asked.only]
    lines = []
    with ThreadPoolExecutor(asked.jobs) as pool:
        # A generator of its own: each casting stays what it is when others change.
        waiting = [
            pool.submit(line, n, casting(random.Random(f"{asked.seed}/{n}")), folder, asked.ranks)
            for n in numbers
        ]
        for future in waiting:
            lines.append(future.result())
            show(lines[-1])
    with (folder / "table.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, [*(name for name, _ in COLUMNS), "wrong", "depth"])
        writer.writeheader()
        writer.writerows(lines)
    wrong = [cells["number"] for cells in lines if cells["wrong"]]
    print(f"{len(lines) - len(wrong)} of {len(lines)} castings are right; not: {wrong or 'none'}")
    for name in ("steps", "cuts", "frozen", "violated", "finished", "its", "wall s"):
        print(f"{name} in all: {sum(cells.get(name, 0) for cells in lines):.0f}")
    print(f"files in {folder}")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
