"""Thermo-elastic law of a body that may start as a liquid, evaluated cell by cell.

A cell whose mean solid fraction has not reached coherency is an incompressible viscous liquid,
s = 2 η ė, which over one step is s = 2 (η/Δt) (e - e_n). It is born as a solid without stress from
before the step in which it freezes: s = 2 G (e - e_n) with e_n its deviatoric strain at the start
of that step. A material without `liquid` keeps s = 2 G e at every temperature.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from castx.errors import CaseError
from castx.materials import Material
from castx.tables import Table

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class CellState:
    """Elastic state of cells for one step.

    Attributes:
        shear_modulus: secant shear modulus [Pa], shape (cells,).
        compressibility: 1/K [1/Pa], shape (cells,).
        thermal_strain: volumetric thermal strain, shape (cells,).
        coherent: whether the cell is a solid, shape (cells,).
        solid_compressibility: 1/K that the cell has as a solid [1/Pa], shape (cells,).
    """

    shear_modulus: FloatArray
    compressibility: FloatArray
    thermal_strain: FloatArray
    coherent: BoolArray
    solid_compressibility: FloatArray


@dataclass(frozen=True)
class ThermoElasticLaw:
    """Thermo-elasticity with temperature-dependent constants (Chiumenti, 2.2).

    Attributes:
        material: the material of the body.
        stress_free: temperature without thermal strain [°C].
    """

    material: Material
    stress_free: float

    def largest_shear_modulus(self) -> float:
        """Return the largest shear modulus of the material [Pa], the scale of its pressures."""
        young, poisson = self._elastic_tables()
        temperatures = np.union1d(young.arguments, poisson.arguments)
        return float(np.max(young(temperatures) / (2 * (1 + poisson(temperatures)))))

    def evaluate(
        self, temperature: FloatArray, solid_fraction: FloatArray, step: float
    ) -> CellState:
        """Return the state of cells as the means of their nodes.

        Args:
            temperature: at the nodes of each cell [°C], shape (cells, nodes).
            solid_fraction: likewise.
            step: time step [s], which makes a modulus of the liquid's viscosity.
        """
        young, poisson = self._elastic_tables()
        E, nu = young(temperature), poisson(temperature)
        shear_modulus = np.mean(E / (2 * (1 + nu)), axis=1)
        compressibility = np.mean(3 * (1 - 2 * nu) / E, axis=1)
        strain = self.material.volumetric_thermal_strain(temperature, self.stress_free)
        thermal_strain = np.mean(strain, axis=1)
        solid_compressibility = compressibility
        coherent = np.ones(len(shear_modulus), dtype=bool)
        liquid = self.material.liquid
        if liquid is not None:
            coherent = np.mean(solid_fraction, axis=1) >= liquid.coherency
            viscosity = np.mean(liquid.viscosity(temperature), axis=1)
            shear_modulus = np.where(coherent, shear_modulus, viscosity / step)
            compressibility = np.where(coherent, compressibility, 0.0)
            thermal_strain = np.where(coherent, thermal_strain, 0.0)
        return CellState(
            shear_modulus, compressibility, thermal_strain, coherent, solid_compressibility
        )

    def _elastic_tables(self) -> tuple[Table, Table]:
        young, poisson = self.material.young_modulus, self.material.poisson_ratio
        if young is None or poisson is None:
            raise CaseError(
                f"material {self.material.name!r} needs young_modulus and poisson_ratio"
            )
        return young, poisson


class BirthHistory:
    """Deviatoric strains without stress: kept by solids, renewed at every step by liquids.

    Args:
        cells: number of cells.
        components: number of components of a strain.
    """

    def __init__(self, cells: int, components: int) -> None:
        self._coherent: BoolArray = np.ones(cells, dtype=bool)
        self._reference: FloatArray = np.zeros((cells, components))
        self._strain: FloatArray = np.zeros((cells, components))

    def begin_liquid(self) -> None:
        """State that nothing has been born yet."""
        self._coherent[:] = False

    def reference(self, coherent: BoolArray) -> FloatArray:
        """Return e0 of the step for the cells that are coherent at its end."""
        keeps = (coherent & self._coherent)[:, None]
        return np.where(keeps, self._reference, self._strain)

    def commit(self, coherent: BoolArray, strain: FloatArray) -> None:
        """Accept a step with the deviatoric strain at its end."""
        self._reference = self.reference(coherent)
        self._strain = strain.copy()
        self._coherent = coherent.copy()
