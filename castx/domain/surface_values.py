"""Pressures and tractions of a surface as coefficients of a form, even or varying in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mpi4py import MPI

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.mesh import BodyMesh
from castx.errors import CaseError
from castx.input.placed import Placed
from castx.tables import Table


class EvenValue:
    """A number or vector over time that is the same on the whole surface.

    Args:
        body: mesh of the body.
        components: over time.
        scalar: whether it is a number.

    Attributes:
        coefficient: for forms.
    """

    def __init__(self, body: BodyMesh, components: Sequence[Table], scalar: bool) -> None:
        self._components = components
        none = np.float64(0.0) if scalar else np.zeros(len(components))
        self.coefficient = fem.Constant(body.mesh, none)

    def set_time(self, time: float) -> None:
        """Set the value of a time [s]."""
        values = np.array([float(table(time)) for table in self._components])
        self.coefficient.value = values if self.coefficient.value.ndim else values[0]

    @property
    def pressures(self) -> float:
        """The number [Pa]."""
        return float(self.coefficient.value)


class UnevenValue:
    """A number or vector over time that is linear between the nodes, with exact values at them.

    Args:
        body: mesh of the body.
        surface: name of the surface.
        components: over time, or place and time.
        scalar: whether it is a number.

    Attributes:
        coefficient: for forms.
    """

    def __init__(
        self, body: BodyMesh, surface: str, components: Sequence[Table | Placed], scalar: bool
    ) -> None:
        self._components, self._surface, self._comm = components, surface, body.mesh.comm
        self._nodes = body.surface_nodes(surface)
        self._points = body.points[self._nodes, : body.mesh.geometry.dim]
        self._functions = [fem.Function(body.nodes) for _ in components]
        self.coefficient: Any = self._functions[0] if scalar else ufl.as_vector(self._functions)

    def set_time(self, time: float) -> None:
        """Set the value at the nodes of the surface at a time [s]; collective.

        Raises:
            CaseError: a value is not finite; on all ranks.
        """
        finite = True
        for function, component in zip(self._functions, self._components, strict=True):
            values: FloatArray = (
                np.full(len(self._nodes), float(component(time)))
                if isinstance(component, Table)
                else component(self._points, time)
            )
            function.x.array[self._nodes] = values
            finite &= bool(np.isfinite(values).all())
        if not self._comm.allreduce(finite, op=MPI.LAND):
            said = "; ".join(c.text for c in self._components if not isinstance(c, Table))
            raise CaseError(f"the load on {self._surface} is not finite at {time:g} s: {said}")

    @property
    def pressures(self) -> FloatArray:
        """The first component at the nodes of the surface [Pa], shape (nodes,)."""
        return np.asarray(self._functions[0].x.array[self._nodes])
