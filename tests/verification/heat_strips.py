"""Thin strips on which the heat problem is one-dimensional, for V1, V2, V3, V5 and V6."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from castx.case.geometry import Geometry
from castx.domain.mesh import CastingMesh, build_mesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.heat.body import HeatBody
from castx.heat.boundaries import SurfaceHeat
from castx.heat.interface import HeatExchange
from castx.heat.problem import HeatProblem
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material
from castx.materials.material import Material
from tests.heat_conditions import surface_heat
from tests.heat_resistance import LAYER


def material(**properties: Any) -> Material:
    """Return a material with density 1, so that capacities and latent heat are per volume."""
    description = MaterialDescription.read({"density": 1.0, **properties})
    return find_material("test", {"test": description})


def strip(
    comm,
    *,
    size: float,
    length: float,
    mould_length: float = 0.0,
    cells: str = "simplices",
    model: str = "plane-strain",
) -> CastingMesh:
    """Return a strip one element wide and deep, with a mould at x < 0 if that has a length."""
    bodies = ["casting", "mould"] if mould_length else ["casting"]
    mould = {"mould_length": mould_length} if mould_length else {}
    generator = "two_slabs" if mould_length else "slab"
    sizes = {"length": length, "width": size, "size": size, **mould}
    if model == "3d":
        sizes["depth"] = size
    description = {"model": model, "generator": generator, "cells": cells, **sizes}
    return build_mesh(Geometry.model_validate(description), bodies, comm)


def wall_at(temperature: float) -> SurfaceHeat:
    """Return the condition of a chilled wall of the casting."""
    return surface_heat("casting/wall", "temperature", value=temperature)


def casting_on_mould(
    mesh: CastingMesh, bodies: Sequence[HeatBody], kind: Any, surfaces: Sequence[SurfaceHeat] = ()
) -> HeatProblem:
    """Return the problem of a casting that touches a mould."""
    pairs = node_pairs(mesh, "casting", "mould")
    return HeatProblem(mesh, bodies, [HeatExchange("casting/mould", pairs, kind, LAYER)], surfaces)


def run(
    heat: HeatProblem,
    step: float,
    end: float,
    pairs: Sequence[Any] = (),
    look: Callable[[float], None] = lambda time: None,
) -> int:
    """Advance in equal steps, call `look` after each, and return the Newton iterations."""
    iterations = 0
    for k in range(round(end / step)):
        iterations += heat.advance(k * step, step, pairs).iterations
        heat.commit()
        look((k + 1) * step)
    return iterations


def profile(mesh: CastingMesh, heat: HeatProblem, body: str) -> tuple[np.ndarray, np.ndarray]:
    """Return x and temperature of the nodes at y = 0 of a body, along x, from all ranks."""
    nodes = mesh.bodies[body].nodes
    owned = nodes.dofmap.index_map.size_local
    points = nodes.tabulate_dof_coordinates()[:owned]
    below = np.isclose(points[:, 1], 0.0)
    rows = np.column_stack([points[:, 0], heat.temperature[body].x.array[:owned]])[below]
    rows = np.concatenate(mesh.comm.allgather(rows))
    return tuple(rows[np.argsort(rows[:, 0])].T)


def solid_thickness(mesh: CastingMesh, heat: HeatProblem, width: float) -> float:
    """Return ∫ f_s over the casting, per width [m]."""
    body = next(body for body in heat._bodies if body.name == "casting")
    local = body.volumes @ body.solid_fraction.x.array[: body.owned]
    return mesh.comm.allreduce(local) / width
