"""State of one body and of one interface, from which output fields are read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.coupling.step import CoupledProblem
from castx.discretisation.cell_errors import CellErrors
from castx.errors import CaseError
from castx.mechanics.body import BodyMechanics, point_stress


@dataclass(frozen=True)
class NoState:
    """The part of `StateView` that a body or an interface does not have."""

    problem: CoupledProblem

    def _refuse(self) -> FloatArray:
        raise CaseError("this field reads what its place does not have; declare another place")


@dataclass(frozen=True)
class FieldState(NoState):
    """Heat and mechanics of one body.

    Args:
        problem: of all bodies.
        body: its name.
        field: the name of the field, for errors.
    """

    body: str
    field: str

    @property
    def mechanics(self) -> BodyMechanics:
        """The mechanics of the body.

        Raises:
            CaseError: the run has none.
        """
        if self.problem.mechanics is None:
            text = "this run has no mechanics (coupling.scheme)"
            raise CaseError(f"{self.field} of {self.body!r}: {text}")
        return self.problem.mechanics.bodies[self.body]

    @property
    def step_size(self) -> float:
        """Size of the last accepted step [s]."""
        return self.mechanics.material.step_size

    def heat(self, name: str) -> FloatArray:
        """Return temperature [°C], enthalpy [J/m³] or solid_fraction, shape (nodes,)."""
        heat = self.problem.heat
        fields = {
            "temperature": heat.temperature,
            "enthalpy": heat.enthalpy,
            "solid_fraction": heat.solid_fraction,
        }
        if self.body not in fields[name]:
            raise CaseError(f"no {name} in a run without the heat equation (coupling.scheme)")
        return np.asarray(fields[name][self.body].x.array)

    def displacement(self) -> FloatArray:
        """Return the displacement [m], shape (nodes, gdim)."""
        mechanics = self.mechanics
        values = mechanics.solution.x.array.reshape(-1, mechanics.block_size)
        return np.asarray(values[:, : mechanics.dimension])

    def pressure(self) -> FloatArray:
        """Return the mean stress [Pa], shape (nodes,); collective."""
        return self.mechanics.nodal_pressure()

    def stress(self) -> FloatArray:
        """Return the stress [Pa], shape (cells, 6)."""
        return self.mechanics.stress()

    def point_stress(self) -> FloatArray:
        """Return the stress at the integration points [Pa], shape (cells, 6 points)."""
        return point_stress(self.mechanics)

    def stress_error(self) -> FloatArray:
        """Return the error of the stress by a recovered one [Pa], shape (cells,); collective."""
        part = self.mechanics
        return CellErrors(part.mesh, part.model, part.coherent).of(part.stress())

    def plastic_strain(self) -> FloatArray:
        """Return the equivalent plastic strain, shape (cells,)."""
        return self.mechanics.plastic_strain()

    def plastic_strain_increment(self) -> FloatArray:
        """Return the plastic strain gained in the last accepted step, shape (cells,)."""
        mechanics = self.mechanics
        return mechanics.points.cell_means(mechanics.material.plastic_increment())

    def pores(self) -> FloatArray:
        """Return the share of the cells that is void, shape (cells,)."""
        return self.mechanics.pores()

    def gap(self) -> FloatArray:
        """Refuse: a body has none."""
        return self._refuse()

    contact_pressure = wall_suction = resistance = gap


@dataclass(frozen=True)
class PairsState(NoState):
    """Gaps, pressures and resistances of the pairs of one interface.

    Args:
        problem: of all bodies.
        interface: its name.
    """

    interface: str

    @property
    def step_size(self) -> float:
        """Refuse: fields of pairs do not ask for the step."""
        raise CaseError("fields of pairs have no step size; declare a field of cells")

    def gap(self) -> FloatArray:
        """Return the gaps [m], shape (pairs,)."""
        interfaces = self.problem.interfaces
        return interfaces.states[interfaces.number(self.interface)].gap

    def contact_pressure(self) -> FloatArray:
        """Return the contact pressures [Pa], shape (pairs,)."""
        interfaces = self.problem.interfaces
        return interfaces.states[interfaces.number(self.interface)].pressure

    def wall_suction(self) -> FloatArray:
        """Return by how much closed pairs are pulled, friction left out [Pa], shape (pairs,)."""
        interfaces = self.problem.interfaces
        return interfaces.states[interfaces.number(self.interface)].suction

    def resistance(self) -> FloatArray:
        """Return the thermal resistances [m²K/W], shape (pairs,)."""
        interfaces = self.problem.interfaces
        return interfaces.resistances[interfaces.number(self.interface)]

    def heat(self, name: str) -> FloatArray:
        """Refuse: an interface has none."""
        return self._refuse()

    def stress(self) -> FloatArray:
        """Refuse: an interface has none."""
        return self._refuse()

    displacement = pressure = point_stress = stress_error = stress
    plastic_strain = plastic_strain_increment = pores = stress
