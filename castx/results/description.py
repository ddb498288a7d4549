"""What run.json says of a case: its bodies, materials and interfaces with their sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from castx.case.coherency import coherency_records
from castx.case.stages import Schedule
from castx.coupling.thin_walls import thin_wall_records
from castx.foundry.alloy import Alloy
from castx.foundry.stress.shape import is_axis, plane_of
from castx.materials.lookup import find_material

if TYPE_CHECKING:
    from collections.abc import Mapping

    from castx.case.case import Case
    from castx.domain.mesh import CastingMesh
    from castx.domain.pairs.node_pairs import NodePairs

ROOM_TEMPERATURE = 20.0
"""At which strengths are compared [°C]."""


def describe(case: Case, mesh: CastingMesh, pairs: Mapping[str, NodePairs]) -> dict[str, Any]:
    """Return case, bodies and interfaces with their sizes for run.json; collective."""
    thin = thin_wall_records(case, mesh)
    sizes = {
        body.name: {
            "material": body.material,
            "law": body.law,
            "temperature": body.temperature.text,
            "freezes": freezing_range(case, body.material),
            "coherency": coherency_records(case).get(body.name),
            "tensile_strength": tensile_strength(case, body.material),
            "tearing": Alloy(find_material(body.material, case.materials)).tearing_indices,
            "nodes": mesh.bodies[body.name].nodes.dofmap.index_map.size_global,
            "cells": cell_count(mesh, body.name),
            "symmetry": symmetry_planes(mesh, body.name),
            "thin_walls": thin.get(body.name),
        }
        for body in case.bodies
    }
    written = case.content.get("interfaces", [])
    keys = {"/".join(entry["bodies"]): entry.get("heat", {}) for entry in written}
    interfaces = {
        interface.name: {
            "pairs": mesh.comm.allreduce(len(pairs[interface.name].secondary_local)),
            "contact": interface.contact.method,
            "heat": None if interface.heat is None else interface.heat.law,
            "heat_keys": keys.get(interface.name, {}),
        }
        for interface in case.interfaces
    }
    return {
        "case": {"name": case.name, "file": str(case.path.resolve()), "digest": case.digest},
        "model": mesh.model,
        "scheme": case.coupling.scheme,
        "front": case.foundry.at.text,
        "end": Schedule(case.stages, case.time.end).end,
        "bodies": sizes,
        "interfaces": interfaces,
        "ranks": mesh.comm.size,
    }


def symmetry_planes(mesh: CastingMesh, name: str) -> list[dict[str, Any]]:
    """Return the planes of symmetry of a body, n·x = offset, as JSON knows them; collective."""
    body = mesh.bodies[name]
    planes = [
        plane_of(body, mesh.model, surface)
        for surface in body.symmetry_planes
        if not is_axis(body, mesh.model, surface)
    ]
    return [
        {"normal": plane.normal.tolist(), "offset": plane.offset}
        for plane in planes
        if plane is not None
    ]


def freezing_range(case: Case, name: str) -> list[float] | None:
    """Return solidus and liquidus of a material [°C], None if it does not melt."""
    material = find_material(name, case.materials)
    if material.solidus is None or material.liquidus is None:
        return None
    return [material.solidus, material.liquidus]


def cell_count(mesh: CastingMesh, body: str) -> int:
    """Return the number of cells of a body on all ranks."""
    topology = mesh.bodies[body].mesh.topology
    return int(topology.index_map(topology.dim).size_global)


def tensile_strength(case: Case, name: str) -> float | None:
    """Return the tensile strength of a material at room temperature [Pa], None if it has none."""
    table = find_material(name, case.materials).description.tensile_strength
    return None if table is None else float(table(np.array([ROOM_TEMPERATURE]))[0])
