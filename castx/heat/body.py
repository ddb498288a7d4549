"""One body in the heat problem: its fields, nodal volumes and conduction matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem, la

from castx.arrays import FloatArray, IntArray
from castx.domain.measures import cell_measure, nodal_areas, nodal_volumes
from castx.domain.mesh import BodyMesh
from castx.forms.heat import conduction
from castx.heat.latent_heat import LatentHeat
from castx.materials.conduction_potential import conduction_potential
from castx.materials.enthalpy import HeatState
from castx.materials.material import Material
from castx.tables import Table


@dataclass(frozen=True)
class HeatBody:
    """Material, initial temperature and heat source of a body.

    Attributes:
        name: of the body in the mesh.
        material: its material.
        temperature: at the start [°C], one number or one for each owned node, shape (owned,); at a
            melting point the body is liquid.
        heat_source: heat per volume over time [W/m³].
        inside: whether latent heat is stored inside the cells, instead of at the nodes alone.
    """

    name: str
    material: Material
    temperature: float | FloatArray
    heat_source: Table | None = None
    inside: bool = False


class ThermalBody:
    """Temperature fields of one body at the trial state, and the matrix of its conduction.

    Args:
        body: mesh of the body.
        model: geometric model.
        description: material, initial temperature and source.
    """

    def __init__(self, body: BodyMesh, model: str, description: HeatBody) -> None:
        self.name = body.name
        self.mesh = body
        self.description = description
        self.curve = description.material.enthalpy
        self.index_map = body.nodes.dofmap.index_map
        self.owned = self.index_map.size_local
        self._potential_law = conduction_potential(description.material)
        self._model = model
        self._create_fields()
        self._create_conduction()
        self.volumes = nodal_volumes(body, model, degree=None)

    def _create_fields(self) -> None:
        nodes = self.mesh.nodes
        self.enthalpy = fem.Function(nodes, name="enthalpy")
        self.temperature = fem.Function(nodes, name="temperature")
        self.solid_fraction = fem.Function(nodes, name="solid_fraction")
        self._passed = la.vector(self.index_map)
        initial = np.broadcast_to(self.description.temperature, self.owned)
        self.set_enthalpy(self.curve.enthalpy(initial))

    def _create_conduction(self) -> None:
        nodes = self.mesh.nodes
        theta, v = ufl.TrialFunction(nodes), ufl.TestFunction(nodes)
        dx = cell_measure(self.mesh, self._model, None)
        form = fem.form(conduction(theta, v, dx.weight, dx.measure))
        matrix = fem.assemble_matrix(form)
        matrix.scatter_reverse()
        self._inside = self._latent_heat(form)
        self.conduction = matrix.to_scipy()
        self._diagonal = self.conduction.diagonal()
        self.columns = matrix.index_map(1)
        self.column_nodes = self.columns.local_to_global(
            np.arange(self.columns.size_local + self.columns.num_ghosts, dtype=np.int32)
        )
        self._theta = la.vector(self.columns)
        self._theta_slope = la.vector(self.columns)

    def _latent_heat(self, conduction: fem.Form) -> LatentHeat | None:
        """Return the latent heat inside the cells, if it is stored there."""
        if not self.description.inside:
            return None
        material = self.description.material
        latent = material.density * material.latent_heat
        matrix = fem.create_matrix(conduction)
        return LatentHeat(self.mesh, self._model, self.curve, latent, matrix)

    def surface_areas(self, surface: str) -> tuple[IntArray, FloatArray]:
        """Return the owned nodes of a surface and the areas they stand for [m²]."""
        areas = nodal_areas(self.mesh, self._model, surface)
        nodes = self.mesh.surface_nodes(surface)
        nodes = nodes[nodes < self.owned].astype(np.int32)
        return nodes, areas[nodes]

    def set_enthalpy(self, enthalpy: FloatArray) -> None:
        """Set the state of the owned nodes [J/m³], and update the ghosts."""
        H = self.enthalpy.x
        H.array[: self.owned] = enthalpy
        H.scatter_forward()
        state = self.curve.state(H.array)
        self.temperature.x.array[:] = state.temperature
        self.solid_fraction.x.array[:] = state.solid_fraction

    def state(self, enthalpy: FloatArray) -> HeatState:
        """Return temperature and solid fraction of the local nodes, shape (nodes,); collective.

        Args:
            enthalpy: of the owned nodes [J/m³], shape (owned,).
        """
        self._passed.array[: self.owned] = enthalpy
        self._passed.scatter_forward()
        return self.curve.state(self._passed.array)

    @property
    def owned_temperature(self) -> FloatArray:
        """Temperature of the owned nodes [°C]."""
        return np.asarray(self.temperature.x.array[: self.owned])

    def temperature_slope(self) -> FloatArray:
        """Return dT/dH of the owned nodes [K m³/J]."""
        return self.curve.temperature_slope(self.enthalpy.x.array[: self.owned])

    def conducted_heat(self) -> FloatArray:
        """Return the heat that leaves the owned nodes by conduction [W]."""
        theta = self._theta
        theta.array[: self.owned] = self._potential_law(self.owned_temperature)
        theta.scatter_forward()
        return np.asarray(self.conduction @ theta.array)

    def conduction_slope(self, temperature_slope: FloatArray) -> FloatArray:
        """Return the derivatives of `conducted_heat`, entry by entry of `conduction.data`.

        Args:
            temperature_slope: derivative of the temperature of the owned nodes over the unknown.
        """
        conductivity = self._potential_law.derivative(self.owned_temperature)
        slope = self._at_columns(conductivity * temperature_slope)
        return np.asarray(self.conduction.data * slope[self.conduction.indices])

    def _at_columns(self, values: FloatArray) -> FloatArray:
        """Return values of the owned nodes at the columns of `conduction`; collective."""
        vector = self._theta_slope
        vector.array[: self.owned] = values
        vector.scatter_forward()
        return vector.array.copy()

    def latent_heat_inside(self, enthalpy: FloatArray) -> FloatArray:
        """Return the latent heat inside the cells beside V H [J], shape (owned,); collective.

        Args:
            enthalpy: of the owned nodes [J/m³], shape (owned,).
        """
        if self._inside is None:
            return np.zeros(self.owned)
        return self._inside.stored(*self.state(enthalpy))

    def present_latent_heat_inside(self) -> FloatArray:
        """Return the latent heat inside the cells in a trial state just set [J]; collective.

        Owned nodes, shape (owned,).
        """
        if self._inside is None:
            return np.zeros(self.owned)
        return self._inside.found(self.temperature.x.array, self.solid_fraction.x.array)

    def solid_inside(self) -> float:
        """Return the solid inside the cells beside that of the owned nodes [m³]; collective."""
        if self._inside is None:
            return 0.0
        stored = self.latent_heat_inside(self.enthalpy.x.array[: self.owned])
        return float(-stored.sum() / self._inside.latent)

    def latent_heat_slope(self, slope: FloatArray) -> FloatArray | None:
        """Return its derivatives at the trial state, entry by entry of `conduction.data`.

        Args:
            slope: derivative of the enthalpy of the owned nodes over the unknown, shape (owned,).
        """
        if self._inside is None:
            return None
        H = self.enthalpy.x.array[: self.owned]
        rates = self.curve.temperature_slope(H), self.curve.solid_fraction_slope(H)
        found = [self._at_columns(rate * slope) for rate in rates]
        return self._inside.slopes(self.temperature.x.array, *found)

    def rounding(self) -> FloatArray:
        """Return the size of the terms that cancelled in the last `conducted_heat` [W].

        Owned nodes, shape (owned,).
        """
        return np.asarray(2.0 * self._diagonal * np.abs(self._theta.array[: self.owned]))

    def source(self, start: float, end: float) -> float:
        """Return the mean heat source [W/m³] between two times [s]."""
        table = self.description.heat_source
        return 0.0 if table is None else table.mean(start, end)

    def stored_heat(self) -> float:
        """Return the heat of the owned nodes [J], zero for the solid at 0 °C; collective."""
        enthalpy = self.enthalpy.x.array[: self.owned].copy()
        return float(self.volumes @ enthalpy + self.latent_heat_inside(enthalpy).sum())
