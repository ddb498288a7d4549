"""Error of the heat flux in the cells of all bodies, from the start of a run on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.case.fields.heat import FLUX_ERROR
from castx.discretisation.cell_errors import CellErrors, described_error, squared
from castx.discretisation.cell_flux import CellHeatFlux, potentials_of
from castx.materials.conduction_potential import ConductionPotential
from castx.stateful import Arrays, Saved, part_of, saved_parts

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh, CastingMesh


class TemperatureState(Protocol):
    """The part of a state after an accepted step that is needed here."""

    @property
    def time(self) -> float:
        """End of the step [s]."""

    @property
    def mesh(self) -> CastingMesh:
        """The bodies that are there."""

    def nodal(self, body: str, name: str, /) -> FloatArray:
        """Return a nodal field with ghosts."""


class BodyFluxErrors:
    """Squares of error and heat flux in the cells of one body, summed over time.

    Args:
        body: its mesh.
        model: geometric model.
        potential: θ = ∫ k dT of its material.
    """

    def __init__(self, body: BodyMesh, model: str, potential: ConductionPotential) -> None:
        self._errors, self._flux = CellErrors(body, model), CellHeatFlux(body, potential)
        self._comm, self._numbering = body.mesh.comm, body.cell_numbering
        self._sums: FloatArray = np.zeros((len(self._numbering.numbers), 2))
        self._duration = 0.0

    def add(self, temperature: FloatArray, step: float) -> None:
        """Add the error at the end of a step; collective.

        Args:
            temperature: at the local nodes, (nodes,) [°C].
            step: size of the step [s].
        """
        flux = self._flux(temperature)
        squares = np.column_stack([self._errors.of(flux) ** 2, squared(flux)])
        self._sums += step * squares
        self._duration += step

    def in_cells(self) -> FloatArray:
        """Return the root mean square of the error over time, (cells,) [W/m²]."""
        return np.asarray(np.sqrt(self._sums[:, 0] / max(self._duration, 1e-300)))

    def described(self) -> dict[str, float] | None:
        """Return the error over body and time for run.json; None before any step; collective."""
        volumes = self._errors.volumes
        sums = volumes @ self._sums[: len(volumes)]
        local = np.array([*sums, self._duration * volumes.sum()])
        return described_error(self._comm.allreduce(local, op=MPI.SUM))

    def saved(self) -> dict[str, Saved]:
        """Return the sums over time."""
        duration = Saved(np.array([self._duration]))
        return {"sums": Saved(self._sums, self._numbering), "duration": duration}

    def restore(self, arrays: Arrays) -> None:
        """Go on with the sums of an earlier part of the run."""
        self._sums, self._duration = arrays["sums"].copy(), float(arrays["duration"][0])


class FluxErrors:
    """Errors of the heat flux of all bodies.

    Args:
        mesh: of all bodies.
        potentials: of the bodies by name; none: the run knows no temperatures.
    """

    def __init__(self, mesh: CastingMesh, potentials: Mapping[str, ConductionPotential]) -> None:
        self._bodies = {
            name: BodyFluxErrors(mesh.bodies[name], mesh.model, potential)
            for name, potential in potentials.items()
        }
        self._time: float | None = None

    def update(self, state: TemperatureState) -> None:
        """Take over the state after an accepted step; collective."""
        step = 0.0 if self._time is None else state.time - self._time
        self._time = state.time
        for name, found in self._bodies.items():
            if step > 0.0 and name in state.mesh.bodies:
                found.add(state.nodal(name, "temperature"), step)

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return the error in the local cells, (cells,) [W/m²]; None: unknown."""
        if name != FLUX_ERROR or body not in self._bodies:
            return None
        return self._bodies[body].in_cells()

    def totals(self) -> dict[str, float]:
        """Return nothing: run.json has the errors."""
        return {}

    def described(self) -> dict[str, Any]:
        """Return the errors of the bodies for run.json; collective."""
        found = {name: body.described() for name, body in self._bodies.items()}
        return {name: error for name, error in found.items() if error is not None}

    def saved(self) -> dict[str, Saved]:
        """Return the sums of all bodies."""
        time = np.nan if self._time is None else self._time
        return saved_parts(self._bodies) | {"time": Saved(np.array([time]))}

    def restore(self, arrays: Arrays) -> None:
        """Go on with the sums of an earlier part of the run."""
        time = float(arrays["time"][0])
        self._time = time if np.isfinite(time) else None
        for name, body in self._bodies.items():
            if part := part_of(arrays, name):
                body.restore(part)


def flux_errors_of(case: Case, mesh: CastingMesh) -> FluxErrors:
    """Return the errors of the heat flux of a case, of no body without the heat equation."""
    if case.coupling.scheme == "mechanical":
        return FluxErrors(mesh, {})
    return FluxErrors(mesh, potentials_of(case))
