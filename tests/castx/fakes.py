"""A state of two bodies made from formulas, for everything that reads a `Snapshot`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.geometry import Geometry
from castx.domain.mesh import CastingMesh, build_mesh
from castx.domain.pairs.node_pairs import NodePairs, node_pairs
from castx.results.states.snapshot import ProcessState
from castx.solvers.counters import StepCounters

Formula = Callable[[FloatArray], FloatArray]


def cylinder_mesh(
    comm: MPI.Intracomm,
    model: str = "axisymmetric",
    size: float = 4e-3,
    cells: str = "simplices",
) -> CastingMesh:
    """Return a cylinder, radius 20 mm and height 40 mm, in a mould 10 mm thick."""
    sizes = {"radius": 0.02, "height": 0.04, "wall": 0.01, "size": size, "cells": cells}
    sector = {"sector": "quarter"} if model == "3d" else {}
    description = {"model": model, "generator": "cylinder_in_mould", **sizes, **sector}
    return build_mesh(Geometry.model_validate(description), ["casting", "mould"], comm)


def slab_mesh(comm: MPI.Intracomm, size: float, length: float = 0.02) -> CastingMesh:
    """Return a plane slab of four elements' width, cooled from x = 0."""
    sizes = {"length": length, "width": 4 * size, "size": size}
    description = {"model": "plane-strain", "generator": "slab", **sizes}
    return build_mesh(Geometry.model_validate(description), ["casting"], comm)


def casting_pairs(mesh: CastingMesh) -> dict[str, NodePairs]:
    """Return the pairs between casting and mould."""
    return {"casting/mould": node_pairs(mesh, "casting", "mould")}


@dataclass
class FakeSnapshot:
    """A snapshot whose fields are formulas of the position (points, gdim), otherwise zero."""

    time: float
    step: int
    mesh: CastingMesh
    pairs: dict[str, NodePairs] = field(default_factory=dict)
    formulas: dict[str, Formula] = field(default_factory=dict)
    totals: dict[str, float] = field(default_factory=dict)
    counters: StepCounters = field(default_factory=StepCounters)
    process: ProcessState = field(default_factory=ProcessState)

    hindered: tuple[str, ...] = ()

    def is_hindered(self, body: str) -> bool:
        return body in self.hindered

    def nodal(self, body: str, name: str) -> FloatArray:
        gdim = self.mesh.parent.geometry.dim
        points = self.mesh.bodies[body].nodes.tabulate_dof_coordinates()[:, :gdim]
        default = np.zeros((len(points), gdim) if name == "displacement" else len(points))
        return self._evaluate(name, points, default)

    def cellwise(self, body: str, name: str) -> FloatArray:
        space = self.mesh.bodies[body].nodes
        corners = space.tabulate_dof_coordinates()[space.dofmap.list]
        points = corners.mean(axis=1)[:, : self.mesh.parent.geometry.dim]
        default = np.zeros((len(points), 6) if name == "stress" else len(points))
        return self._evaluate(name, points, default)

    def paired(self, interface: str, name: str) -> FloatArray:
        points = self.pairs[interface].points
        return self._evaluate(name, points, np.zeros(len(points)))

    def _evaluate(self, name: str, points: FloatArray, default: FloatArray) -> FloatArray:
        return self.formulas[name](points) if name in self.formulas else default


def fake_probe(name: str, at: tuple[float, ...], *quantities: str, **owner: str | float) -> Any:
    """Return a probe as the case describes it; `owner` is body=…, interface=…, below=…, depth=…."""
    place = {"body": None, "interface": None, "below": None, "depth": 0.0, **owner}
    return SimpleNamespace(name=name, at=at, quantities=quantities, **place)
