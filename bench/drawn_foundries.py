"""Which foundry does a draw at random make?

    bin/with-fenicsx python3 bench/drawn_foundries.py --seed 1 --number 7

Castings of blocks on a grid, plane, axisymmetric or in space: with feeder, flange, core, chill, lid
or a second casting in the same mould, of metal, sand or rigid sand; poured, or solid from the
start. Elements, flow through the mush, contact, heat, coupling, steps, stages and ranks are drawn
independently. bench/random_foundries.py runs them.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.linear_mesh import QUADRILATERALS, SIMPLICES, LinearMesh
from castx.meshes.model import Surface, everything_else, plane
from castx.meshes.structured import grid, swept

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from bench.random_castings import (
    LAWS,
    PLANE_MODELS,
    G,
    database,
    heat_law,
    logarithmic,
    melts,
    toml,
)

ALLOYS = (
    "Al-pure", "AlSi12", "AlSi10Mg", "AlSi7Mg", "AlSi9Cu3", "AlCu4.5", "AZ91", "ZnAl4Cu1",
    "Cu-pure", "CuSn12", "CuZn39Pb1Al", "316L", "G20Mn5", "GJL-250", "GJS-600",
)  # fmt: skip
AT_ONCE = ("Al-pure", "AlCu4.5", "Cu-pure")
"""They freeze at one temperature, the second in part, which cells do not take."""
METALS = ("steel-H13", "steel-carbon", "GJL-250", "Cu-pure")
SANDS = ("sand-silica", "sand-chromite")
EXACT = ("condensed", "multipliers")
CASTINGS = ("casting", "second")
AIR = {"type": "convection", "coefficient": 30.0, "ambient": 20.0}
Case = dict[str, Any]


class Block(NamedTuple):
    """A body, or a part of one, between two corners that count cells."""

    body: str
    low: tuple[int, ...]
    high: tuple[int, ...]


class Foundry(NamedTuple):
    """A case with the blocks of its mesh.

    Attributes:
        case: the case file.
        blocks: later ones replace earlier ones.
        size: of a cell [m].
        cells: "simplices" or "quadrilaterals".
        words: what was drawn.
        ranks: of the run.
    """

    case: Case
    blocks: list[Block]
    size: float
    cells: str
    words: list[str]
    ranks: int


def blocks(dice: random.Random, model: str, words: list[str]) -> list[Block]:
    """Return a mould with a casting at the origin, and what is drawn beside them."""
    deep, wall = model == "3d", dice.choice((1, 2) if model == "3d" else (2, 3))
    most = 3 if deep else 5
    wide, high, depth = (dice.randint(2, most) for _ in range(3))
    core = dice.randint(1, 3) if model == "axisymmetric" and dice.random() < 0.3 else 0
    z = (0, depth) if deep else None

    def block(body: str, x: tuple[int, int], up: tuple[int, int], out: int = 0) -> Block:
        sides = [x, *([(z[0] - out, z[1] + out)] if z else []), up]
        return Block(body, tuple(low for low, _ in sides), tuple(end for _, end in sides))

    right, top = core + wide, high
    parts = [block("casting", (core, right), (0, high))]
    if dice.random() < 0.35:
        words.append(dice.choice(("feeder", "flange")))
        end = right + 2 if words[-1] == "flange" else core + max(1, wide // 2)
        top = high + dice.randint(1, 2)
        parts.append(block("casting", (core, end), (high, top)))
        right = max(right, end)
    elif dice.random() < 0.25:
        words.append("second")
        if model == "axisymmetric":
            top = high + 1 + dice.randint(2, 4)
            parts.append(block("second", (core, right), (high + 1, top)))
        else:
            parts.append(block("second", (right + 1, right + 3), (0, dice.randint(2, high))))
            right += 3
    roof = wall if dice.random() < 0.3 else 0
    words += ["lid"] if roof else []
    left = 0 if model == "axisymmetric" else -wall
    found = [block("mould", (left, right + wall), (-wall, top + roof), wall)]
    if core:
        words.append("core")
        found.append(block("core", (0, core), (-wall, top + roof)))
    if dice.random() < 0.3:
        words.append("chill")
        down = -wall if dice.random() < 0.4 else -1
        found.append(block("chill", (core, core + dice.randint(1, wide)), (down, 0)))
    return found + parts


def filled(foundry: Foundry) -> tuple[LongArray, list[str], FloatArray]:
    """Return the number of the body of each cell of the grid, the bodies, and its lowest corner."""
    names = list(dict.fromkeys(block.body for block in foundry.blocks))
    low = np.array(foundry.blocks[0].low)
    cells = np.zeros(np.array(foundry.blocks[0].high) - low, dtype=np.int64)
    for block in foundry.blocks:
        inside = zip(block.low - low, block.high - low, strict=True)
        cells[tuple(slice(start, end) for start, end in inside)] = names.index(block.body)
    return cells, names, low


def meshed(foundry: Foundry) -> tuple[LinearMesh, list[str], list[Surface]]:
    """Return the mesh, its bodies and its surfaces: base, top, outside."""
    cells, names, low = filled(foundry)
    x, *between, z = [
        foundry.size * (start + np.arange(count + 1))
        for start, count in zip(low, cells.shape, strict=True)
    ]

    def at(middle: FloatArray) -> LongArray:
        places = np.floor(middle / foundry.size).astype(int) - low[: middle.shape[1]]
        return np.asarray(np.ravel_multi_index(tuple(places.T), cells.shape[: middle.shape[1]]))

    if between:
        layers = cells.reshape(-1, cells.shape[2])
        plan = grid(x, between[0], at, foundry.cells)
        mesh = swept(
            plan, z, lambda column, up: layers[column, math.floor(up / foundry.size) - low[2]]
        )
    else:
        mesh = grid(x, z, lambda middle: cells.ravel()[at(middle)], foundry.cells)
    near, up = 1e-6 * foundry.size, mesh.dimension - 1
    surfaces = [plane("base", up, z[0], near), plane("top", up, z[-1], near)]
    if foundry.case["geometry"]["model"] == "axisymmetric":
        surfaces.append(plane("outside", 0, x[-1], near))
    else:
        surfaces.append(everything_else("outside"))
    return mesh, names, surfaces


def feeds(foundry: Foundry) -> bool:
    """Return whether the casting reaches the top of its mould."""
    cells, names, _ = filled(foundry)
    return bool((cells[..., -1] == names.index("casting")).any())


def touching(foundry: Foundry) -> list[tuple[str, str]]:
    """Return the pairs of bodies that share a face of the grid."""
    cells, names, _ = filled(foundry)
    found: set[tuple[int, int]] = set()
    for axis in range(cells.ndim):
        one, two = np.delete(cells, -1, axis).ravel(), np.delete(cells, 0, axis).ravel()
        pairs = zip(one.tolist(), two.tolist(), strict=True)
        found |= {(min(pair), max(pair)) for pair in pairs}
    return [(names[a], names[b]) for a, b in sorted(found) if a != b]


def casting_body(dice: random.Random, name: str, alloy: str, foundry: Foundry) -> Case:
    """Return a casting, poured or solid from the start, with its elements."""
    data, model = database(alloy), foundry.case["geometry"]["model"]
    solidus, liquidus = temperatures(alloy)
    solid = dice.random() < 0.1
    heat = 0.7 * solidus if solid else liquidus + round(dice.uniform(5.0, 80.0), 1)
    law = dice.choice((*LAWS, "thermo-elasto-viscoplastic"))
    body = {"name": name, "material": alloy, "temperature": heat, "law": law}
    simplices = foundry.cells == SIMPLICES
    if model == "plane-stress" and (not simplices or law != LAWS[0]):
        foundry.case.setdefault("materials", {})[f"{name}-metal"] = {
            "extends": alloy, "liquid": "none"
        }  # fmt: skip
        body["material"] = f"{name}-metal"
    elif simplices and "arm_spacing" in data and not solid and dice.random() < 0.25:
        return body | {"feeding": "darcy", "stabilisation": dice.choice(("osgs", "gls"))}
    if simplices and model != "plane-stress" and dice.random() < 0.2:
        body["formulation"] = "taylor-hood"
    elif simplices and dice.random() < 0.3:
        body["stabilisation"] = "gls"
    if dice.random() < 0.2 and not solid:
        body["freezing"] = dice.choice(("nodes", "nodes" if alloy in AT_ONCE else "cells"))
    return body


def bodies(dice: random.Random, foundry: Foundry, alloy: str) -> list[Case]:
    """Return the bodies of the case."""
    melting = float(database(alloy)["liquidus"]["value"])
    metals = [metal for metal in METALS if melts(metal) > melting + 100.0]
    found, names = [], filled(foundry)[1]
    for name in names:
        if name in CASTINGS:
            found.append(casting_body(dice, name, alloy, foundry))
            continue
        sand = {"mould": 0.35, "core": 0.6, "chill": 0.0}[name]
        body: Case = {"name": name, "temperature": dice.choice((20.0, 20.0, 150.0))}
        if dice.random() < sand:
            law = dice.choice(("rigid", "drucker-prager"))
            if foundry.case["geometry"]["model"] == "plane-stress":
                law = "rigid"  # the other law is not written for it
            body |= {"material": dice.choice(SANDS), "law": law, "temperature": 20.0}
        else:
            body["material"] = dice.choice(metals)
            if dice.random() < 0.5:
                body["formulation"] = "displacement"
        found.append(body)
    return found


def contact(
    dice: random.Random, pair: Sequence[str], rigid: set[str], poured: bool, method: str
) -> Case:
    """Return how two bodies touch, if they do by a method or none."""
    if rigid.issuperset(pair):
        return {"method": "none"}
    if not poured:  # a core stands on its own, a chill would fall
        apart = ("none",) if "chill" not in pair else ()
        return {"method": method if rigid & {*pair} else dice.choice((*apart, "tied", method))}
    found: Case = {"method": method}
    if method in ("condensed", "penalty") and dice.random() < 0.2:
        found["friction"] = round(dice.uniform(0.05, 0.4), 2)
    if dice.random() < 0.1:
        found["initial_gap"] = 1e-5
    return found


def interface_heat(dice: random.Random) -> Case:
    """Return the heat of an interface: a law, an entry of the database, or a coating."""
    kind = dice.random()
    if kind < 0.25:
        folder = files("castx.transfer") / "database"
        entries = sorted(entry.name for entry in folder.iterdir() if entry.name.endswith(".toml"))
        return {"from": dice.choice(entries).removesuffix(".toml")}
    if kind < 0.4:
        coat = {"thickness": logarithmic(dice, 5e-5, 5e-4), "conductivity": 0.5}
        return {"from": "aluminium-steel-coating-layer", "coating": coat}
    return heat_law(dice)


def interfaces(dice: random.Random, foundry: Foundry) -> list[Case]:
    """Return the interfaces of the case; the casting is the first of its bodies."""
    rigid = {body["name"] for body in foundry.case["bodies"] if body.get("law") == "rigid"}
    heat, found = interface_heat(dice), []
    method = dice.choice((*EXACT * 4, "augmented-lagrangian", "penalty"))
    for pair in touching(foundry):
        poured = [name for name in pair if name in CASTINGS]
        order = sorted(pair, key=lambda name: (name in rigid, name not in poured, name))
        touch = contact(dice, order, rigid, bool(poured), method)
        through = heat if poured else {"law": "constant", "closed": 2000.0}
        found.append({"bodies": order, "contact": touch, "heat": through})
    return found


def steps(dice: random.Random, case: Case, through: float, words: list[str]) -> None:
    """Give a case its end, which is about that of freezing, its steps and its stages."""
    end = float(f"{through * dice.uniform(0.4, 1.5):.3g}")
    case["time"] = {"end": end}
    if dice.random() < 0.2:
        words.append("tolerance")
        asked = {"temperature": 3.0, "gap": 5e-6, "strain": 5e-5}
        case["time"]["tolerance"] = dict(dice.sample(sorted(asked.items()), dice.randint(1, 3)))
    elif dice.random() < 0.15:
        words.append("large steps")
        case["time"] |= {"temperature_change": 100.0, "largest_step": end / 5}
    scheme = dice.choice((*("iterated",) * 8, "staggered", "one-way"))
    if scheme != "iterated":
        words.append(scheme)
        case["coupling"] = {"scheme": scheme}
    names = [body["name"] for body in case["bodies"]]
    if dice.random() < 0.25:
        words.append("opened")
        stages: list[Case] = [{"at": 0.7 * end, "remove": [n for n in names if n == "mould"]}]
        if dice.random() < 0.5:
            stages.append(
                {"at": 0.85 * end,
                 "spray": {"on": ["casting"], "coefficient": 2000.0, "ambient": 20.0}}
            )  # fmt: skip
        case["stages"] = stages
    elif dice.random() < 0.1 and "second" not in names:
        words.append("cycles")
        case["stages"] = [
            {"at": 0.6 * end, "remove": ["casting"]},
            {"at": end, "repeat": 2, "renew": ["casting"]},
        ]


def foundry(dice: random.Random) -> Foundry:
    """Return a foundry that says nothing about its solvers."""
    model = dice.choice((*("axisymmetric",) * 4, *PLANE_MODELS, "3d", "3d"))
    words: list[str] = []
    cells = QUADRILATERALS if dice.random() < 0.3 else SIMPLICES
    case: Case = {"geometry": {"file": "mesh.msh", "model": model}}
    found = Foundry(
        case, blocks(dice, model, words), logarithmic(dice, 0.001, 0.03), cells, words,
        dice.choice((1, 1, 1, 1, 1, 2)),
    )  # fmt: skip
    alloy = dice.choice(ALLOYS)
    case["bodies"] = bodies(dice, found, alloy)
    case["interfaces"] = interfaces(dice, found)
    case["boundaries"] = [*supports(found), {"on": "mould/outside", "heat": AIR}]
    if dice.random() < 0.9:
        case["loads"] = {"gravity": [0.0] * (len(found.blocks[0].low) - 1) + [-G]}
    poured = [body for body in case["bodies"] if body["name"] in CASTINGS]
    if any("feeding" in body for body in poured):
        words.append("darcy")
        case["foundry"] = {"feeders": ["casting/top"] if feeds(found) else []}
    if any(body["temperature"] < temperatures(alloy)[0] for body in poured):
        words.append("solid")
    steps(dice, case, freezing(found, temperatures(alloy)[1]), words)
    case["output"] = {"fields": ["temperature", "solid_fraction", "von_mises"]}
    return found


def temperatures(alloy: str) -> tuple[float, float]:
    """Return solidus and liquidus [°C]."""
    data = database(alloy)
    return float(data["solidus"]["value"]), float(data["liquidus"]["value"])


def supports(foundry: Foundry) -> list[Case]:
    """Return what holds the bodies that stand on the base and are not rigid."""
    low = foundry.blocks[0].low[-1]
    standing = {block.body for block in foundry.blocks if block.low[-1] == low}
    return [
        {"on": f"{body['name']}/base", "displacement": {"normal": 0.0}}
        for body in foundry.case["bodies"]
        if body["name"] in standing and body.get("law") != "rigid"
    ]


def freezing(foundry: Foundry, liquidus: float) -> float:
    """Return about the time in which the last casting freezes [s]."""
    last, case = foundry.blocks[-1], foundry.case
    thick = foundry.size * int(np.subtract(last.high, last.low).min())
    released, drop = 3e9 * thick / 3, liquidus - 200.0
    effusivity = 1_200.0 if case["bodies"][0]["material"] in SANDS else 12_000.0
    closed = float(case["interfaces"][0]["heat"].get("closed", 2000.0))
    return float(released / (closed * drop) + (released / (effusivity * drop)) ** 2)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the case that the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1, help="of the draw (1)")
    parser.add_argument("--number", type=int, default=0, help="of the casting (0)")
    asked = parser.parse_args(arguments)
    drawn = foundry(random.Random(f"{asked.seed}/{asked.number}"))
    print("\n".join(toml(drawn.case)))
    print(f"# {' '.join(drawn.words)}; {drawn.cells} of {drawn.size} m, {drawn.ranks} ranks")


if __name__ == "__main__":
    main()
