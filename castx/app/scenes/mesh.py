"""The scene of a mesh: the facets of its bodies, and how many cells it has."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.app.scenes.triangles import triangulated
from castx.case.case import STUDIES
from castx.case.reading.read import read_case
from castx.domain.memory import refuse_too_large
from castx.domain.mesh import build_mesh
from castx.domain.summary import mesh_summary
from castx.input.toml_text import parse_toml
from castx.report.packing import packed
from castx.report.shells import shells_of

Answer = dict[str, Any]


def mesh_scene(text: str, path: Path) -> Answer:
    """Return the mesh of a case for a page, for JSON.

    Args:
        text: of the case file.
        path: of the case file, beside which other files are.

    Raises:
        CaseError: the case cannot be accepted.
        MeshError: it makes no mesh.
    """
    content = {key: value for key, value in parse_toml(text).items() if key not in STUDIES}
    case = read_case(content, path)
    names = [body.name for body in case.bodies]
    refuse_too_large(case.geometry, names, MPI.COMM_SELF, solved=False)
    mesh = build_mesh(case.geometry, names, MPI.COMM_SELF)
    flat = case.geometry.model != "3d"
    faces, triangles = [], []
    for shell in shells_of(mesh, [interface.name for interface in case.interfaces]):
        skins = {shell.body: shell.filled} if flat else shell.skins
        for name, polygons in skins.items():
            faces.append({"bodies": [shell.body], "text": name})
            triangles.append(triangulated(polygons))
    report, summary = mesh.report, mesh_summary(mesh)
    quality = None if report is None else report.quality
    return {
        "flat": flat,
        "faces": faces,
        "counts": packed(np.array([len(found) for found in triangles], dtype=np.uint32)),
        "points": packed(np.concatenate(triangles).astype(np.float32).reshape(-1)),
        "bodies": [
            {"name": b.name, "cells": b.cells, "nodes": b.nodes} for b in summary.bodies
        ],
        "edges": None if quality is None else [quality.shortest, quality.longest],
        "worst": None if quality is None else quality.worst,
        "remarks": [] if report is None else list(report.remarks),
    }  # fmt: skip
