"""How far do answers hang on the path: on the mesh and on the steps that a casting freezes in?

    bin/with-fenicsx python3 bench/path_dependence.py DIR
    bin/with-fenicsx python3 bench/path_dependence.py DIR --case demos/parts/bracket.toml

Without a case a hub with two heavy sections and a neck between them, of AlSi7Mg in a mould of H13,
runs in three meshes (4, 2, 1.4 mm), each with default steps and with steps of half the changes. A
case runs in its own mesh with its steps and with half of them. Runs that are there are not run
again. Prints each number in all runs, and by how much they differ at most from their middle.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np

from castx.case.case import Case
from castx.case.reading.read import load_case, read_case
from castx.command.run import RunSettings, run_case
from castx.domain.source import gmsh_session
from castx.results.reading import Results

SIZES = (4e-3, 2e-3, 1.4e-3)
CHANGE, LONGEST = 20.0, 2.0
"""Default steps: change of the temperature [K], and longest one [s]."""
SOLID = 0.999
SECTIONS = ((0.020, 0.040), (0.007, 0.020), (0.024, 0.040))
"""Radius and height of the lower section, the neck and the upper section [m]."""
WALL = 0.055
"""Outer radius of the mould [m]."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what is not there, and print the numbers."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("output", type=Path, help="folder of the runs")
    parser.add_argument("--case", type=Path, help="in place of the hub")
    asked = parser.parse_args(arguments)
    asked.output.mkdir(parents=True, exist_ok=True)
    cases = of_file(asked.case) if asked.case else hubs(asked.output.resolve())
    rows = [answered(case, asked.output / name) for name, case in cases.items()]
    print("number |", " | ".join(cases), "| middle ± half of the range")
    for key in rows[0]:
        values = np.array([row.get(key, np.nan) for row in rows])
        low, high = np.nanmin(values), np.nanmax(values)
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        part = f" ({100 * half / abs(middle):.1f} %)" if middle else ""
        shown = " | ".join(f"{value:.4g}" for value in values)
        print(f"{key} | {shown} | {middle:.4g} ± {half:.2g}{part}")


def of_file(path: Path) -> dict[str, Case]:
    """Return a case with its steps, and with steps of half the changes."""
    given = load_case(path).time
    change, longest = given.temperature_change or CHANGE, given.largest_step or LONGEST
    return {
        f"steps over {part}": load_case(
            path,
            [f"time.temperature_change={change / part}", f"time.largest_step={longest / part}"],
        )
        for part in (1, 2)
    }  # fmt: skip


def hubs(folder: Path) -> dict[str, Case]:
    """Return the cases of the hub, whose meshes are written into a folder."""
    found = {}
    for size in SIZES:
        mesh = folder / f"hub_{1e3 * size:g}.msh"
        with gmsh_session():
            draw(size)
            gmsh.write(str(mesh))
        for part in (1, 2):
            name = f"{1e3 * size:g} mm, steps over {part}"
            found[name] = read_case(hub(mesh, part), folder / "hub.toml")
    return found


def draw(size: float) -> None:
    """Draw the meridian of the hub and its mould."""
    model = gmsh.model.geo
    levels = np.cumsum([0.0, *(height for _, height in SECTIONS)])
    profile = []
    for (radius, _), low, high in zip(SECTIONS, levels[:-1], levels[1:], strict=True):
        profile += [(radius, low), (radius, high)]
    corners = {
        "inner": [(0.0, levels[-1]), (0.0, 0.0)],
        "outer": [(WALL, levels[-1]), (WALL, 0.0)],
    }

    def points(places: Any) -> list[int]:
        return [model.addPoint(r, z, 0.0, size) for r, z in places]

    wall, inner, outer = points(profile), points(corners["inner"]), points(corners["outer"])

    def lines(ends: Sequence[int]) -> list[int]:
        return [model.addLine(a, b) for a, b in pairwise(ends)]

    shared = lines(wall)
    top, axis, base = lines([wall[-1], *inner, wall[0]])
    mould = lines([wall[-1], *outer, wall[0]])
    casting = model.addPlaneSurface([model.addCurveLoop([*shared, top, axis, base])])
    around = model.addPlaneSurface([model.addCurveLoop([*shared, *mould])])
    model.synchronize()
    for number, name in ((casting, "casting"), (around, "mould")):
        gmsh.model.addPhysicalGroup(2, [number], name=name)
    for numbers, name in (([top], "top"), ([base], "base"), ([mould[1]], "outside"),
                          ([mould[2]], "foot")):  # fmt: skip
        gmsh.model.addPhysicalGroup(1, numbers, name=name)
    gmsh.model.mesh.generate(2)


def hub(mesh: Path, part: int) -> dict[str, Any]:
    """Return the case of a mesh, with steps of a part of the usual changes."""
    return {
        "geometry": {"file": str(mesh), "model": "axisymmetric"},
        "bodies": [
            {"name": "casting", "material": "AlSi7Mg", "temperature": 680.0,
             "law": "thermo-elasto-viscoplastic"},
            {"name": "mould", "material": "steel-H13", "temperature": 200.0,
             "formulation": "displacement"},
        ],
        "interfaces": [{
            "bodies": ["casting", "mould"],
            "heat": {"law": "limited", "closed": 2300.0, "gas_conductivity": 0.05},
        }],
        "boundaries": [
            {"on": "casting/base", "displacement": {"normal": 0.0}},
            {"on": "mould/foot", "displacement": {"normal": 0.0}},
            {"on": "mould/outside",
             "heat": {"type": "convection", "coefficient": 10.0, "ambient": 20.0}},
        ],
        "foundry": {"feeders": ["casting/top"]},
        "time": {"end": 150.0, "first_step": 0.05, "largest_step": LONGEST / part,
                 "temperature_change": CHANGE / part},
    }  # fmt: skip


def answered(case: Case, folder: Path) -> dict[str, float]:
    """Return the numbers of a case, kept in its folder."""
    kept = folder / "answers.json"
    if not kept.is_file():
        output = case.output.model_copy(update={"folder": folder.resolve() / "run"})
        run_case(case.model_copy(update={"output": output}), RunSettings(MPI.COMM_SELF))
        kept.write_text(json.dumps(numbers(Results(folder / "run"))))
    loaded: dict[str, float] = json.loads(kept.read_text())
    return loaded


def percent(share: float | None) -> float:
    """Return a share in percent; what is not known is not a number."""
    return math.nan if share is None else 100.0 * share


def numbers(run: Results) -> dict[str, float]:
    """Return the numbers of the one casting of a run."""
    (casting,) = run.freezing
    history, end = run.history, run.stage_ends[-1]["bodies"][casting]
    stress, shape = end["stress"], end["distortion"]
    solid = history[f"{casting}.solid_fraction"]
    last = int(np.flatnonzero(solid >= SOLID)[0])
    frozen = np.interp(SOLID, solid[last - 1 : last + 1], history["time"][last - 1 : last + 1])
    return {
        "steps": float(len(history["time"]) - 1),
        "freezing time [s]": float(frozen),
        **of_gaps(run),
        "mean von Mises [MPa]": 1e-6 * stress["mean_von_mises"],
        "99 % of von Mises [MPa]": 1e-6 * stress["high_von_mises"],
        "largest von Mises [MPa]": 1e-6 * stress["von_mises"]["value"],
        "allowance, first axis [%]": percent(shape["allowance"][0]),
        "allowance, last axis [%]": percent(shape["allowance"][-1]),
        "distortion inward [µm]": 1e6 * shape["inward"]["value"],
        "distortion outward [µm]": 1e6 * shape["outward"]["value"],
        "lacks at the end [cm³]": 1e6 * history[f"{casting}.unfed_volume"][-1],
        **of_hot_spot(run.hot_spots),
    }


def of_gaps(run: Results) -> dict[str, float]:
    """Return the mean gap over the interfaces of the casting at the end, and the largest one."""
    (casting,) = run.freezing
    own = [name for name in run.interfaces if casting in name.split("/")]
    share = np.array([run.record["interfaces"][name]["pairs"] for name in own])
    mean = np.array([run.history[f"{name}.mean_gap"][-1] for name in own])
    most = max(float(np.nanmax(run.history[f"{name}.max_gap"])) for name in own)
    return {
        "mean gap [µm]": 1e6 * float(share @ mean / share.sum()),
        "largest gap [µm]": 1e6 * most,
    }


def of_hot_spot(found: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """Return place, moment and deficit of the worst pool that was cut off."""
    if not found:
        return {}
    worst = found[0]
    place = {
        f"hot spot, {axis} [mm]": 1e3 * x for axis, x in zip("xyz", worst["place"], strict=False)
    }
    return {
        **place,
        "hot spot, cut off [s]": worst["isolated"],
        "its deficit [cm³]": 1e6 * worst["deficit"],
    }


if __name__ == "__main__":
    main()
