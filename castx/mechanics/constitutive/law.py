"""Constitutive law of a body: its coefficients in a step, from temperature and solid fraction.

Deviatoric stress over one step Δt, with e the deviatoric strain (Chiumenti, section 2.2):

    liquid     s = 2 (η/Δt) (e − e_n), or by a flow rule
    solid      s = 2 G E,   dE = de − de^c − de_vp
    mixture    s = w s_solid + (1 − w) s_liquid

e_n is the strain at the start of the step, E the elastic strain of the solid, which grows
(`growth`), and e_vp its viscoplastic strain (`history`); `return_mapping` finds e_vp, `response`
the stress. The share w of the solid rises from 0 where metal begins to bear to 1. The pressure
follows from the volume, of which K of the solid carries the share that is solid,

    dθ = w dp/K + de^θ,

with de^θ and de^c volume and shape of what the solid contracts (`eigenstrain`,
`castx.materials.thermal_strain`); a liquid is incompressible. A material without `liquid` is a
solid at every temperature.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.errors import CaseError
from castx.materials.enthalpy import HeatState
from castx.materials.flow import VISCOPLASTIC, FlowProperties, liquid_flow, solid_flow
from castx.materials.granular import GRANULAR
from castx.materials.material import Material
from castx.materials.thermal_strain import StressFreeState, shrinkage_strain
from castx.mechanics.constitutive.eigenstrain import Eigenstrain, eigenstrain
from castx.mechanics.constitutive.growth import (
    Freezing,
    Growth,
    MetalNodes,
    PlateauFront,
    Shares,
    growth,
    in_the_solid,
)
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.mush import Layers, Mush, across_one_layer, layers_of
from castx.mechanics.constitutive.places import MetalPlaces
from castx.tables import Table

ELASTIC = "thermo-elastic"
ROUNDED = 12
"""Decimals to which shares of samples are kept, so that liquid has none and solid is whole."""


class Conditions(NamedTuple):
    """Coefficients of the law in one step, from temperature and solid fraction.

    Attributes:
        shear_modulus: of the solid at the points [Pa], shape (points,).
        flow: of the solid at the points; None: elastic, or grains (`granular_points`).
        shares: solid at the points.
        liquid_modulus: η/Δt at the points [Pa], of a Newtonian liquid.
        liquid_flow: of another liquid at the points.
        start_share: w_0 in the cells, shape (cells,).
        share: w in the cells, shape (cells,).
        strained_share: w_m in the cells, which the strain of the step meets, shape (cells,).
        solid_compressibility: 1/K of the solid in the cells [1/Pa], shape (cells,).
        contraction: de^θ over the step, shape (cells,).
        shape: de^c over the step, shape (points, components), see `eigenstrain`.
        nodes: metal of the nodes at the end of the step.
        mush: beside solid in the same points; None: it has no past of its own.
    """

    shear_modulus: FloatArray
    flow: FlowProperties | None
    shares: Shares
    liquid_modulus: FloatArray | None
    liquid_flow: FlowProperties | None
    start_share: FloatArray
    share: FloatArray
    strained_share: FloatArray
    solid_compressibility: FloatArray
    contraction: FloatArray
    shape: FloatArray
    nodes: MetalNodes
    mush: Mush | None = None

    @property
    def compressibility(self) -> FloatArray:
        """w_m/K of the cells [1/Pa], shape (cells,)."""
        return np.asarray(self.strained_share * self.solid_compressibility)

    def born_later(self, mean_stress: FloatArray) -> FloatArray:
        """Return -(w - w_m) p/K, with which θ = w p/K + E is that of the step, shape (cells,).

        Args:
            mean_stress: p at the end of the step [Pa], shape (cells,).
        """
        later = self.share - self.strained_share
        return np.asarray(-later * self.solid_compressibility * mean_stress)

    @property
    def coherent(self) -> BoolArray:
        """Whether the cells hold any solid, shape (cells,)."""
        return np.asarray(self.share > 0)


@dataclass(frozen=True)
class Law:
    """A law of the case format with the material of the body (Chiumenti, section 2.2).

    Attributes:
        material: the material of the body.
        stress_free: state without thermal strain; a number: a temperature of the solid [°C].
        name: "thermo-elastic", "thermo-elasto-plastic", "thermo-elasto-viscoplastic" or
            "drucker-prager", of grains.
        inside: whether the share of solid is found inside the cells, instead of at the nodes alone.
    """

    material: Material
    stress_free: float | StressFreeState
    name: str = ELASTIC
    inside: bool = False

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
    def is_granular(self) -> bool:
        """Whether the body is made of grains, which yield by their mean stress too."""
        return self.name == GRANULAR

    @property
    def flows_by_rate(self) -> bool:
        """Whether all that flows does so by a rate, so that its stress has no kink as it yields."""
        return self.name == VISCOPLASTIC

    @property
    def freezes(self) -> bool:
        """Whether solid grows out of a liquid that has a law of its own."""
        return self.material.melts and self.material.liquid is not None

    @property
    def has_layers(self) -> bool:
        """Whether mush and the solid beside it flow each for itself."""
        bears = self.freezes and not self.material.is_isothermal
        return bears and self.name not in (ELASTIC, GRANULAR)

    def largest_shear_modulus(self) -> float:
        """Return the largest shear modulus of the material [Pa], the scale of its pressures."""
        young, poisson = self._elastic_tables()
        temperatures = np.union1d(young.arguments, poisson.arguments)
        return float(np.max(young(temperatures) / (2 * (1 + poisson(temperatures)))))

    def initial_nodes(self, count: int, *, liquid: bool) -> MetalNodes:
        """Return the metal of the nodes in the state without strain, shape (count,).

        Args:
            count: number of local nodes.
            liquid: whether the solid of that state is all there is, instead of all metal.
        """
        unstressed, none = self.stress_free_state, np.zeros(count)
        fraction = np.asarray(unstressed.solid_fraction if liquid else 1.0) + none
        share = self.material.bearing_share(fraction)
        return MetalNodes(share, none, unstressed.temperature + none)

    def nodes(self, temperature: FloatArray, solid_fraction: FloatArray) -> MetalNodes:
        """Return the metal of nodes at temperatures [°C] and solid fractions, shape (nodes,)."""
        return self._metal(self.stress_free_state, temperature.copy(), solid_fraction)

    def _metal(
        self, unstressed: StressFreeState, temperature: FloatArray, solid_fraction: FloatArray
    ) -> MetalNodes:
        """Return the metal of places with their state without strain, shape (places,)."""
        strain = unstressed.strain(self.material, temperature, solid_fraction)
        share = self.material.bearing_share(solid_fraction)
        return MetalNodes(share, strain, temperature)

    def conditions(
        self,
        points: IntegrationPoints,
        temperature: FloatArray,
        solid_fraction: FloatArray,
        step: float,
        start: MetalNodes | None = None,
        between: Sequence[HeatState] = (),
    ) -> Conditions:
        """Return the coefficients of the law in a step.

        Args:
            points: integration points of the body.
            temperature: at the nodes at the end of the step [°C], shape (nodes,).
            solid_fraction: at the nodes at the end of the step, shape (nodes,).
            step: Δt [s].
            start: metal of the nodes at the start of the step; None: as at its end.
            between: states of the nodes that the step has passed, if they are known.

        Raises:
            CaseError: the material lacks a property that the law needs.
        """
        end = self.nodes(temperature, solid_fraction)
        start = end if start is None else start
        young, poisson = self._elastic_tables()
        E, nu = young(temperature), poisson(temperature)
        shear_modulus = in_the_solid(points, E / (2 * (1 + nu)), end.share)
        inside = between if self.freezes else ()
        passed = [start, *(self.nodes(*state) for state in inside), end]
        places = self._places(points, passed)
        first, *_, last = at_places = [self._at(places, metal) for metal in passed]
        places.follow_fronts([first.share, last.share])
        share = places.volume_means(last.share)
        nodal = 3 * (1 - 2 * nu) / E
        compressibility = np.where(
            share > 0, points.volume_means(nodal, end.share), points.volume_means(nodal)
        )
        grown = self._growth(places, at_places)
        shares = Shares.between(
            *(places.at_points(w) for w in (first.share, last.share, grown.strained))
        )
        warmth = in_the_solid(points, temperature, end.share)
        layers = layers_of(places, first, last, grown, shares) if self.has_layers else None
        if layers is not None:
            warmth[layers.points] = layers.solid_temperature
        viscous, flowing = self._liquid(shear_modulus, points.from_nodes(temperature), step)
        flow = None
        if self.name not in (ELASTIC, GRANULAR):
            flow = solid_flow(self.material, self.name, shear_modulus, warmth, step)
        free = eigenstrain(points, places, grown, temperature)
        mush = None
        if layers is not None:
            poisson_ratio = in_the_solid(points, nu, end.share)
            mush = self._mush(layers, free, shear_modulus, poisson_ratio, step)
        return Conditions(
            shear_modulus, flow, shares, viscous, flowing,
            places.volume_means(first.share), share,
            np.minimum(places.volume_means(grown.strained), share), compressibility,
            free.volume, free.shape, end, mush,
        )  # fmt: skip

    def _mush(
        self,
        layers: Layers,
        free: Eigenstrain,
        shear_modulus: FloatArray,
        poisson: FloatArray,
        step: float,
    ) -> Mush:
        """Return mush beside solid with the coefficients of its law; all arrays at the points."""
        at = layers.points
        flow = solid_flow(
            self.material, self.name, shear_modulus[at], layers.mush_temperature, step
        )
        own = (across_one_layer(poisson[at]) / 3)[:, None] * free.front[at]
        excess = layers.solid_excess, layers.mush_excess
        solid, mush = (free.shape[at] + each[:, None] * own for each in excess)
        return Mush(layers, flow, solid, mush)

    def _places(self, points: IntegrationPoints, passed: Sequence[MetalNodes]) -> MetalPlaces:
        """Return the nodes, with samples in cells where mush ends while metal passes its states."""
        cells: IntArray = np.empty(0, dtype=np.int32)
        if self.inside:
            shares = np.stack([metal.share for metal in passed])
            least, most = shares.min(axis=0), shares.max(axis=0)
            corners = points.cell_nodes
            mixed = most[corners].any(axis=1) & (least[corners] < 1.0).any(axis=1)
            cells = np.flatnonzero(mixed).astype(np.int32)
        return MetalPlaces(points, cells)

    def _at(self, places: MetalPlaces, metal: MetalNodes) -> MetalNodes:
        """Return metal of the nodes at all places, that of samples by their temperature.

        What nodes have beside the equilibrium at their temperature is linear in the cells, such as
        a state without strain that is liquid from the start.
        """
        if not places.sampled:
            return metal
        inside, temperature = places.samples_from_nodes, metal.temperature
        settled = self.nodes(temperature, self.material.solid_fraction_at(temperature))
        share, strain = (
            inside(own - equilibrium)
            for own, equilibrium in zip(metal[:2], settled[:2], strict=True)
        )
        temperature = inside(temperature)
        fraction = self.material.solid_fraction_at(temperature)
        found = self._metal(self.stress_free_state.at(inside), temperature, fraction)
        share = np.clip(np.round(found.share + share, ROUNDED), 0.0, 1.0)
        samples = MetalNodes(share, found.contraction + strain, temperature)
        return MetalNodes(*(places.joined(*values) for values in zip(metal, samples, strict=True)))

    def _growth(self, places: MetalPlaces, passed: Sequence[MetalNodes]) -> Growth:
        metal, unstressed = self.material, self.stress_free_state.at(places.from_nodes)
        if not self.freezes:
            last = passed[-1].contraction
            return growth(places, passed, Freezing(last, last))
        freezing = Freezing(
            *(unstressed.strain_at(metal, fraction) for fraction in (metal.fed_until, 1.0))
        )
        return growth(
            places, passed, freezing, isothermal=metal.is_isothermal, fronts=self.fronts()
        )

    def fronts(self) -> list[PlateauFront]:
        """Return the plateaus of the alloy on which the skeleton bears and shrinks."""
        metal, found = self.material, []
        for plateau in metal.plateaus:
            ends = np.array([plateau.begin, plateau.end])
            ahead, behind = metal.bearing_share(ends)
            contracted = float(np.diff(shrinkage_strain(metal, ends))[0])
            if contracted:
                found.append(
                    PlateauFront(float(ahead), float(behind), contracted / (behind - ahead))
                )
        return found

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
