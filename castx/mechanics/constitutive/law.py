"""Constitutive law of a body at its integration points, from liquid to solid.

A cell whose mean solid fraction has not reached coherency is an incompressible liquid: over one
step s = 2 (η/Δt) (e - e_n), or what Norton's law makes of that change of strain. It is born as a
solid without stress from before the step in which it freezes: s = 2 G (e - e_birth - e_vp) with
e_birth its deviatoric strain at the start of that step. In between, from coherency to full
solidity, a cell is a mixture that bears the share w of the solid's stress and 1 - w of the
liquid's. Melting wipes the history. A material without `liquid` is a solid at every temperature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.errors import CaseError
from castx.materials.flow import FlowProperties, liquid_flow, solid_flow
from castx.materials.material import Material
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.return_mapping import (
    plastic_work,
    return_mapping,
    tensor_norm,
    viscoplastic_strain,
)
from castx.stateful import Arrays, Saved
from castx.tables import Table

ELASTIC = "thermo-elastic"
SMALLEST_SECANT = 1e-3
"""Least part of G to which plastic flow takes the secant modulus of the stabilisation."""


class Conditions(NamedTuple):
    """What temperature and solid fraction make of the law for one step.

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
    """A law of the case format with the material it acts in (Chiumenti, 2.2).

    Attributes:
        material: the material of the body.
        stress_free: temperature without thermal strain [°C].
        name: "thermo-elastic", "thermo-elasto-plastic" or "thermo-elasto-viscoplastic".
    """

    material: Material
    stress_free: float
    name: str = ELASTIC

    @property
    def is_linear(self) -> bool:
        """Whether the stress of a step is linear in its strain."""
        liquid = self.material.liquid
        return self.name == ELASTIC and (liquid is None or liquid.is_newtonian)

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
    ) -> Conditions:
        """Return what the law is at nodal temperatures [°C] and solid fractions in a step [s]."""
        young, poisson = self._elastic_tables()
        E, nu = young(temperature), poisson(temperature)
        shear_modulus = points.from_nodes(E / (2 * (1 + nu)))
        corners = points.cell_nodes
        compressibility = np.mean((3 * (1 - 2 * nu) / E)[corners], axis=1)
        strain = self.material.volumetric_thermal_strain(temperature, self.stress_free)
        strain = strain + self.material.shrinkage_strain(solid_fraction)
        thermal_strain = np.mean(strain[corners], axis=1)
        share: FloatArray = np.ones(points.cells)
        coherent: BoolArray = np.ones(points.cells, dtype=bool)
        liquid = self.material.liquid
        if liquid is not None:
            fraction = np.mean(solid_fraction[corners], axis=1)
            coherent = fraction >= liquid.coherency
            share = _solid_share(fraction, liquid.coherency)
            thermal_strain = np.where(coherent, thermal_strain, 0.0)
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


class History(NamedTuple):
    """What the points remember of the steps before.

    Attributes:
        birth: deviatoric strain at which the solid was born, shape (points, components).
        plastic: viscoplastic strain since then, shape (points, components).
        equivalent: its equivalent ξ, the integral of its rate, shape (points,).
        strain: deviatoric strain at the end of the last step, shape (points, components).
        softening: secant shear modulus over the elastic one, shape (points,).
        coherent: whether the cell was a solid, shape (cells,).
    """

    birth: FloatArray
    plastic: FloatArray
    equivalent: FloatArray
    strain: FloatArray
    softening: FloatArray
    coherent: BoolArray

    def saved(self, points: IntegrationPoints) -> dict[str, Saved]:
        """Return the arrays by cell."""
        return {
            name: Saved(points.by_cell(values), points.numbering)
            for name, values in self._asdict().items()
        }

    def restored(self, arrays: Arrays) -> History:
        """Return the history of saved arrays; self has their shapes."""
        return History(
            *(arrays[name].reshape(own.shape) for name, own in self._asdict().items())
        )

    @classmethod
    def initial(cls, points: IntegrationPoints, liquid: bool) -> History:
        """Return that of a body that nothing has happened to."""
        none = np.zeros((points.count, points.components))
        return cls(
            none, none, np.zeros(points.count), none, np.ones(points.count),
            np.full(points.cells, not liquid),
        )  # fmt: skip

    def start(self, coherent: BoolArray, points: IntegrationPoints) -> History:
        """Return that with which a step starts whose end has these coherent cells.

        What is liquid at the start or at the end of the step has no past but its shape.
        """
        new = points.from_cells(~(coherent & self.coherent))
        if not new.any():
            return self
        born = points.from_cells(coherent & ~self.coherent)
        return self._replace(
            birth=np.where(new[:, None], self.strain, self.birth),
            plastic=np.where(new[:, None], 0.0, self.plastic),
            equivalent=np.where(new, 0.0, self.equivalent),
            softening=np.where(born, 1.0, self.softening),
        )


class Response(NamedTuple):
    """Deviatoric stress and tangent at the points: ds/de = isotropic I + radial n ⊗ n.

    Attributes:
        stress: s [Pa], shape (points, components).
        isotropic: [Pa], shape (points,).
        radial: [Pa], shape (points,).
        direction: n, shape (points, components).
        plastic: viscoplastic strain of the solid at the end of the step.
        equivalent: its equivalent.
        work: plastic work per volume in the step [J/m³], shape (points,).
    """

    stress: FloatArray
    isotropic: FloatArray
    radial: FloatArray
    direction: FloatArray
    plastic: FloatArray
    equivalent: FloatArray
    work: FloatArray


def respond(conditions: Conditions, start: History, strain: FloatArray) -> Response:
    """Return the response to deviatoric strains at the end of the step, shape (points, components).

    Liquid: s = 2 (η/Δt) (e - e_n). Solid: s = 2 G (e - e_birth - e_vp), by `return_mapping` if it
    flows. Between coherency and full solidity s = w s_solid + (1 - w) s_liquid.

    Raises:
        ConvergenceError: the flow rule of a point cannot be solved.
    """
    response = _solid_response(conditions, start, strain)
    share = conditions.solid_share
    if conditions.liquid_modulus is None and conditions.liquid_flow is None:
        return response
    if (share == 1.0).all():
        return response
    return _mixture(response, share, *_liquid_response(conditions, start, strain))


def _solid_response(conditions: Conditions, start: History, strain: FloatArray) -> Response:
    G, flow = conditions.shear_modulus, conditions.flow
    trial = (2 * G)[:, None] * (strain - start.birth - start.plastic)
    none = np.zeros(len(G))
    if flow is None:
        return Response(
            trial, 2 * G, none, np.zeros_like(trial), start.plastic, start.equivalent, none
        )
    back = (2 / 3 * flow.kinematic_modulus)[:, None] * start.plastic
    found = return_mapping(trial, back, start.equivalent, flow)
    return Response(
        found.stress, found.isotropic, found.radial, found.direction,
        start.plastic + viscoplastic_strain(found), start.equivalent + found.increment,
        plastic_work(found),
    )  # fmt: skip


def _liquid_response(
    conditions: Conditions, start: History, strain: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    change = strain - start.strain
    modulus, flow = conditions.liquid_modulus, conditions.liquid_flow
    if flow is None:
        assert modulus is not None
        none = np.zeros(len(modulus))
        return (2 * modulus)[:, None] * change, 2 * modulus, none, np.zeros_like(change)
    trial = (2 * conditions.shear_modulus)[:, None] * change
    found = return_mapping(trial, np.zeros_like(trial), np.zeros(len(trial)), flow)
    return found.stress, found.isotropic, found.radial, found.direction


def _mixture(
    solid: Response,
    share: FloatArray,
    stress: FloatArray,
    isotropic: FloatArray,
    radial: FloatArray,
    direction: FloatArray,
) -> Response:
    w, rest = share[:, None], (1 - share)[:, None]
    # Trial stresses of both phases differ where the solid has a past. The tangent of a mixture
    # keeps the direction of the phase that bears more of the radial part.
    use_solid = share * np.abs(solid.radial) >= (1 - share) * np.abs(radial)
    return solid._replace(
        stress=w * solid.stress + rest * stress,
        isotropic=share * solid.isotropic + (1 - share) * isotropic,
        radial=np.where(use_solid, share * solid.radial, (1 - share) * radial),
        direction=np.where(use_solid[:, None], solid.direction, direction),
        plastic=np.where(w > 0, solid.plastic, 0.0),
        equivalent=np.where(share > 0, solid.equivalent, 0.0),
        work=share * solid.work,
    )


def secant_softening(
    response: Response, conditions: Conditions, start: History, strain: FloatArray
) -> FloatArray:
    """Return ‖s‖/(2 G ‖e - e_birth‖), the secant modulus over the elastic one, shape (points,)."""
    stretch = strain - start.birth
    share = np.where(conditions.solid_share > 0, conditions.solid_share, 1.0)
    elastic = 2 * share * conditions.shear_modulus * tensor_norm(stretch)
    stress = tensor_norm(response.stress)
    found = np.divide(stress, elastic, out=np.ones_like(elastic), where=elastic > 0)
    return np.clip(found, SMALLEST_SECANT, 1.0)
