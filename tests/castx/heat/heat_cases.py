"""Castings in moulds for tests of the heat problem: materials, meshes, balances, problems."""

from __future__ import annotations

from typing import Any

import numpy as np

from castx.case.geometry import Geometry
from castx.case.heat_transfer import InterfaceHeat
from castx.domain.mesh import CastingMesh, build_mesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.heat.balance import HeatBalance
from castx.heat.body import HeatBody
from castx.heat.interface import HeatExchange
from castx.heat.newton import residual
from castx.heat.problem import HeatProblem, heat_balance
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.tables import Table
from castx.transfer.pair_state import PairState
from tests.heat_conditions import surface_heat

ALUMINIUM = {
    "density": 2700.0,
    "heat_capacity": {"solid": [[20, 900], [660, 1180]], "liquid": 1050},
    "conductivity": {"solid": [[20, 237], [660, 210]], "liquid": 95},
    "latent_heat": 397e3,
    "solidus": 660,
    "liquidus": 660,
}
ALLOY = {
    "density": 2700.0, "heat_capacity": 1100.0, "conductivity": {"solid": 180.0, "liquid": 90.0},
    "latent_heat": 390e3, "solidus": 560.0, "liquidus": 620.0,
}  # fmt: skip
STEEL = {"density": 7800.0, "heat_capacity": 460.0, "conductivity": [[20, 28], [600, 32]]}
PLAIN_STEEL = STEEL | {"conductivity": 30.0}
FALLING = {"over": "temperature", "table": [[0, 900], [400, 1500], [800, 600]]}
GAS = {"over": "temperature", "table": [[0, 0.025], [1000, 0.07]]}
SERIES = {"law": "series", "closed": {**FALLING, "of": "mean"}, "gas_conductivity": GAS}
SOLID = {"law": "solid-fraction", "closed": {**FALLING, "of": "primary"}, "open": 150}
LAWS: dict[str, tuple[dict[str, Any], float | None]] = {
    "series": (SERIES, None),
    "radiation": ({"law": "none"}, 0.4),
    "both": (SERIES, 0.4),
    "solid-fraction": (SOLID, 0.4),
}
SURROUNDINGS = (
    surface_heat("mould/outside", "radiation", emissivity=0.8, ambient=30.0),
    surface_heat("mould/outside", "convection", ambient=40.0,
                 coefficient={"over": "temperature", "table": [[0, 10], [500, 80]]}),
    surface_heat("casting/top", "convection", ambient=20.0,
                 coefficient={"over": "temperature", "table": [[0, 10], [900, 80]],
                              "of": "surface"}),
)  # fmt: skip


def material(properties) -> Material:
    return find_material("m", {"m": MaterialDescription.read(properties)})


def cylinder(
    comm, *, size=6e-3, length=1.0, model="axisymmetric", cells="simplices"
) -> CastingMesh:
    arguments = {"radius": 0.03, "height": 0.06, "wall": 0.02, "size": size}
    arguments = {name: value * length for name, value in arguments.items()}
    if model == "3d":
        arguments["sector"] = "quarter"
    description = {"model": model, "generator": "cylinder_in_mould", "cells": cells, **arguments}
    return build_mesh(Geometry.model_validate(description), ["casting", "mould"], comm)


def parts_under_law(
    mesh, law, radiation=None, kind: Any = "law", source: float | Table = 2e5
) -> tuple[list[HeatBody], list[HeatExchange]]:
    """Return bodies and interface of an alloy in steel under a law, as a case has it or built."""
    pairs = node_pairs(mesh, "casting", "mould")
    grey = None if radiation is None else np.full(len(pairs.areas), radiation)
    law = InterfaceHeat.read(law).conduction_law() if isinstance(law, dict) else law
    exchange = HeatExchange("casting/mould", pairs, kind, law, grey)
    heat_source = source if isinstance(source, Table) else Table.constant(source)
    bodies = [
        HeatBody("casting", material(ALLOY), 640.0, heat_source),
        HeatBody("mould", material(PLAIN_STEEL), 250.0),
    ]
    return bodies, [exchange]


def problem_under_law(
    mesh, law, radiation=None, surfaces=SURROUNDINGS, source: float | Table = 2e5, **settings
) -> HeatProblem:
    parts = parts_under_law(mesh, law, radiation, source=source)
    return HeatProblem(mesh, *parts, surfaces, **settings)


def balance_under_law(
    mesh, law, radiation=None, surfaces=SURROUNDINGS, kind: Any = "law"
) -> HeatBalance:
    """Return a balance whose bodies have temperatures from place to place, partly solid."""
    balance = heat_balance(mesh, *parts_under_law(mesh, law, radiation, kind), surfaces)
    for body, (mean, rise) in zip(balance.bodies, ((590.0, 1500.0), (220.0, 1200.0)), strict=True):
        z = body.mesh.points[: body.owned, 1]
        body.set_enthalpy(body.curve.enthalpy(mean + rise * (z - 0.031)))
    return balance


def open_pairs(mesh, lowest=0.0, highest=2e-4) -> tuple[PairState, PairState]:
    """Return pairs that open over a step, higher ones more."""
    height = node_pairs(mesh, "casting", "mould").points[:, 1] / 0.06
    start = PairState.of(0.2 * lowest * height, np.zeros(len(height)))
    return start, PairState.of(lowest + (highest - lowest) * height, np.zeros(len(height)))


def advanced(heat, mesh, steps, pairs=None, substeps=1):
    """Advance in steps and return the last report."""
    time = 0.0
    for step in steps:
        report = heat.advance(time, step, [pairs or open_pairs(mesh)], substeps)
        heat.commit()
        time += step
    return report


def residual_at(balance: HeatBalance, x: np.ndarray) -> np.ndarray:
    """Return the residual [W] of the owned unknowns."""
    vector, result = balance.residual.duplicate(), balance.residual.duplicate()
    vector.array[:] = x
    residual(balance, None, vector, result)
    return result.array_r.copy()


def largest(comm, values) -> float:
    return max(comm.allgather(float(np.abs(values).max(initial=0.0))))


def temperatures_at(comm, body, temperature, points) -> np.ndarray:
    """Return the temperatures of the nodes of a body at points, from whichever rank has them."""
    owned = body.nodes.dofmap.index_map.size_local
    rows = np.column_stack((body.points[:owned], temperature.x.array[:owned]))
    rows = np.concatenate(comm.allgather(rows))
    found = {tuple(row[:-1].round(9)): row[-1] for row in rows}
    return np.array([found[tuple(point.round(9))] for point in points])
