"""Constitutive law of a body: its coefficients in a step, from temperature and solid fraction.

Deviatoric stress over one step Δt, with e the deviatoric strain (Chiumenti, section 2.2):

    liquid (solid fraction below coherency)    s = 2 (η/Δt) (e − e_n), or by a flow rule
    solid                                      s = 2 G (e − e_birth − e_vp)
    mixture (coherency to full solidity)       s = w s_solid + (1 − w) s_liquid

e_n is the strain at the start of the step, e_birth the one at which the cell froze and e_vp the
viscoplastic strain since then (`history`); `return_mapping` finds e_vp, `response` the stress. The
share w of the solid rises from 0 at coherency to 1. The pressure follows from the volume,

    p = K (∇·u − e^θ),

with e^θ the volumetric thermal strain (`castx.materials.thermal_strain`); a liquid is
incompressible. A material without `liquid` is a solid at every temperature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.errors import CaseError
from castx.materials.flow import VISCOPLASTIC, FlowProperties, liquid_flow, solid_flow
from castx.materials.material import Material
from castx.materials.thermal_strain import StressFreeState
from castx.mechanics.constitutive.coherency import Coherency
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.tables import Table

ELASTIC = "thermo-elastic"


class Conditions(NamedTuple):
    """Coefficients of the law in one step, from temperature and solid fraction.

    Attributes:
        shear_modulus: of the solid at the points [Pa], shape (points,).
        flow: of the solid at the points; None: elastic.
        solid_share: w at the points, shape (points,).
        liquid_modulus: η/Δt at the points [Pa], of a Newtonian liquid.
        liquid_flow: of another liquid at the points.
        compressibility: 1/K in the cells [1/Pa], shape (cells,).
        solid_compressibility: the same of the solid alone.
        thermal_strain: volumetric, shape (cells,).
        coherent: whether a cell is a solid, shape (cells,).
    """

    shear_modulus: FloatArray
    flow: FlowProperties | None
    solid_share: FloatArray
    liquid_modulus: FloatArray | None
    liquid_flow: FlowProperties | None
    compressibility: FloatArray
    solid_compressibility: FloatArray
    thermal_strain: FloatArray
    coherent: BoolArray


@dataclass(frozen=True)
class Law:
    """A law of the case format with the material of the body (Chiumenti, section 2.2).

    Attributes:
        material: the material of the body.
        stress_free: state without thermal strain; a number: a temperature of the solid [°C].
        name: "thermo-elastic", "thermo-elasto-plastic" or "thermo-elasto-viscoplastic".
    """

    material: Material
    stress_free: float | StressFreeState
    name: str = ELASTIC

    @property
    def stress_free_state(self) -> StressFreeState:
        """State without thermal strain."""
        given = self.stress_free
        return given if isinstance(given, StressFreeState) else StressFreeState(given)

    @property
    def is_linear(self) -> bool:
        """Whether the stress of a step is linear in its strain."""
        liquid = self.material.liquid
        return self.name == ELASTIC and (liquid is None or liquid.is_newtonian)

    @property
    def flows_by_rate(self) -> bool:
        """Whether all that flows does so by a rate, so that its stress has no kink as it yields."""
        return self.name == VISCOPLASTIC

    def largest_shear_modulus(self) -> float:
        """Return the largest shear modulus of the material [Pa], the scale of its pressures."""
        young, poisson = self._elastic_tables()
        temperatures = np.union1d(young.arguments, poisson.arguments)
        return float(np.max(young(temperatures) / (2 * (1 + poisson(temperatures)))))

    def conditions(
        self,
        points: IntegrationPoints,
        temperature: FloatArray,
        solid_fraction: FloatArray,
        step: float,
        coherency: Coherency | None = None,
    ) -> Conditions:
        """Return the coefficients of the law in a step.

        Args:
            points: integration points of the body.
            temperature: at the nodes at the end of the step [°C], shape (nodes,).
            solid_fraction: at the nodes at the end of the step, shape (nodes,).
            step: Δt [s].
            coherency: what the passes of the step have found so far; takes note of this one.

        Raises:
            CaseError: the material lacks a property that the law needs.
        """
        young, poisson = self._elastic_tables()
        E, nu = young(temperature), poisson(temperature)
        shear_modulus = points.from_nodes(E / (2 * (1 + nu)))
        corners = points.cell_nodes
        compressibility = np.mean((3 * (1 - 2 * nu) / E)[corners], axis=1)
        fraction = np.mean(solid_fraction[corners], axis=1)
        liquid = self.material.liquid
        if coherency is not None and liquid is not None:
            coherency.note(fraction, liquid.coherency)
            fraction = np.maximum(fraction, coherency.least)
        unstressed = self.stress_free_state
        nodal = unstressed.thermal_strain(self.material, temperature)
        shrinkage = unstressed.shrinkage(self.material, fraction, corners)
        thermal_strain = np.mean(nodal[corners], axis=1) + shrinkage
        share: FloatArray = np.ones(points.cells)
        coherent: BoolArray = np.ones(points.cells, dtype=bool)
        if liquid is not None:
            coherent = fraction >= liquid.coherency
            share = _solid_share(fraction, liquid.coherency)
            nodal = unstressed.thermal_strain(self.material, np.full(len(temperature), np.inf))
            molten = np.mean(nodal[corners], axis=1)
            molten = molten + unstressed.shrinkage(self.material, np.zeros(points.cells), corners)
            thermal_strain = np.where(coherent, thermal_strain, molten)
        at_points = points.from_nodes(temperature)
        viscous, flowing = self._liquid(shear_modulus, at_points, step)
        flow = None
        if self.name != ELASTIC:
            flow = solid_flow(self.material, self.name, shear_modulus, at_points, step)
        return Conditions(
            shear_modulus, flow, points.from_cells(share), viscous, flowing,
            share * compressibility, compressibility, thermal_strain, coherent,
        )  # fmt: skip

    def _liquid(
        self, shear_modulus: FloatArray, temperature: FloatArray, step: float
    ) -> tuple[FloatArray | None, FlowProperties | None]:
        liquid = self.material.liquid
        if liquid is None:
            return None, None
        if not liquid.is_newtonian:
            return None, liquid_flow(self.material, shear_modulus, temperature, step)
        return np.asarray(liquid.viscosity(temperature) / step, dtype=np.float64), None

    def _elastic_tables(self) -> tuple[Table, Table]:
        young, poisson = self.material.young_modulus, self.material.poisson_ratio
        if young is None or poisson is None:
            raise CaseError(
                f"material {self.material.name!r} needs young_modulus and poisson_ratio"
            )
        return young, poisson


def _solid_share(fraction: FloatArray, coherency: float) -> FloatArray:
    """Return w: from 0 at coherency to 1 in the solid; a step where they are the same."""
    if coherency >= 1.0:
        return (fraction >= 1.0).astype(np.float64)
    return np.clip((fraction - coherency) / (1.0 - coherency), 0.0, 1.0)
