"""The clamp of one surface: its equation as constants in forms, and its state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from mpi4py import MPI

import numpy as np
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.measures import SurfaceMeasures, nodal_areas
from castx.domain.mesh import BodyMesh
from castx.forms import clamp
from castx.mechanics.press_direction import mean_normal, press_direction
from castx.tables import Table


@dataclass(frozen=True)
class SurfaceClamp:
    """A machine that presses on a named surface.

    Force and stiffness are those of the full turn when axisymmetric, of one metre of depth in plane
    models, and of the meshed part in space.

    Attributes:
        surface: name of the surface.
        force: at the meshed place of the surface, over time [N].
        stiffness: of the machine behind the surface [N/m].
        axis: number of the coordinate along which it presses; None: against the normal.
        frame: whether it holds in all directions by its stiffness, and presses in none.
    """

    surface: str
    force: Table
    stiffness: float = 0.0
    axis: int | None = None
    frame: bool = False


class Clamp:
    """A clamped surface of one body.

    Args:
        body: mesh of the body.
        model: geometric model.
        description: of the machine.
        measures: of the loaded surfaces of the body.

    Attributes:
        name: the surface as "body/surface".
        stiffness: of the machine [N/m].
        directions: unit vectors along which it acts, shape (1 or dimension, dimension).
        area: of the surface [m²].

    Raises:
        CaseError: the surface has no direction in which a machine could press.
    """

    def __init__(
        self, body: BodyMesh, model: str, description: SurfaceClamp, measures: SurfaceMeasures
    ) -> None:
        self.name = f"{body.name}/{description.surface}"
        self._comm, self._table = body.mesh.comm, description.force
        surface, self.stiffness = description.surface, description.stiffness
        self._frame = description.frame
        self.directions, self.area = clamp_directions(body, model, description)
        owned = body.nodes.dofmap.index_map.size_local
        self._areas = nodal_areas(body, model, surface, 2)[:owned]
        nodes = body.surface_nodes(surface)
        self._nodes = nodes[nodes < owned]
        self._force = 0.0
        # Constants: forms are compiled once for all values.
        self._pressure = fem.Constant(body.mesh, np.float64(0.0))
        self._foundation = fem.Constant(body.mesh, np.float64(self.stiffness / self.area))
        self._towards = fem.Constant(body.mesh, self.directions[0])
        self._ds = measures(surface, 2)

    def set_time(self, time: float) -> None:
        """Set the force to that at a time [s]."""
        self._force = float(self._table(time))
        self._pressure.value = self._force / self.area

    def work(self, eta: Any) -> Any:
        """Return the work of the force on a variation η of the displacement."""
        return clamp.clamp_work(eta, self._pressure, self._towards, self._ds)

    def backing_work(self, eta: Any, u: Any) -> Any:
        """Return the work of a variation η against the springs that a displacement u strains."""
        if self._frame:
            return clamp.frame_work(eta, u, self._foundation, self._ds)
        return clamp.backing_work(eta, u, self._foundation, self._towards, self._ds)

    def strained(self, motion: FloatArray) -> FloatArray:
        """Return the elongation of the springs under a motion, one for each node and direction.

        Args:
            motion: of the owned nodes, shape (owned, dimension).
        """
        return np.asarray((motion[self._nodes] @ self.directions.T).ravel())

    def totals(self, displacement: FloatArray) -> dict[str, float]:
        """Return force [N] and mean displacement against it [m] by their columns; collective.

        Those of a frame are lengths of vectors.

        Args:
            displacement: of the local nodes, shape (nodes, dimension).
        """
        moved = displacement[: len(self._areas)] @ -self.directions.T
        means = self._comm.allreduce(self._areas @ moved, op=MPI.SUM) / self.area
        mean = float(np.linalg.norm(means) if self._frame else means[0])
        force = self._force + self.stiffness * mean
        return {f"{self.name}.clamp_force": force, f"{self.name}.clamp_displacement": mean}


def clamp_directions(
    body: BodyMesh, model: str, description: SurfaceClamp
) -> tuple[FloatArray, float]:
    """Return the unit vectors along which a clamp acts, and the area of its surface [m²].

    Args:
        body: mesh of the body.
        model: geometric model.
        description: of the machine.

    Returns:
        The vectors, shape (1 or dimension, dimension), and the area as of `press_direction`.

    Raises:
        CaseError: the surface has no direction in which a machine could press.
    """
    if description.frame:
        _, area = mean_normal(body, model, description.surface)
        return np.eye(body.mesh.geometry.dim), area
    direction, area = press_direction(body, model, description.surface, description.axis)
    return direction[None], area
