"""Stress, tangent and history of the integration points of a body, as functions for the forms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.forms.momentum import PointState
from castx.materials.enthalpy import HeatState
from castx.mechanics.constitutive.growth import CellVolume, MetalNodes
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Conditions, Law
from castx.mechanics.constitutive.liquid_volume import forgotten
from castx.mechanics.constitutive.plane_stress import deviatoric
from castx.mechanics.constitutive.point_functions import PointFunctions
from castx.mechanics.constitutive.response import Response, foreseen, respond, secant_softening
from castx.mechanics.constitutive.secant_modulus import SecantModulus
from castx.mechanics.constitutive.thickness import thickness
from castx.stateful import Arrays, Saved


class MaterialPoints:
    """Stress, tangent and history of all integration points of a body.

    Args:
        points: the integration points.
        law: law of the body.
        cells: functions constant in each cell.
        starts_liquid: whether nothing is solid at the start.
    """

    def __init__(
        self,
        points: IntegrationPoints,
        law: Law,
        cells: fem.FunctionSpace,
        starts_liquid: bool,
    ) -> None:
        self.points, self.law = points, law
        self.functions = PointFunctions(points, law)
        self.compressibility = points.volume_function(cells)
        self.thermal_strain = points.volume_function(cells)
        self._secant = SecantModulus(points, cells)
        self.secant_modulus, self.bearing = self._secant.function, self._secant.bearing
        self.thickness = thickness(points, law, cells, starts_liquid)
        self.history = self._start = PointHistory.initial(points, mush=law.has_layers)
        nodes = len(points.node_numbering.numbers)
        self._nodes = law.initial_nodes(nodes, liquid=starts_liquid)
        self._volume = CellVolume(*np.zeros((4, points.volumes)))
        self._contracted, self._shape = self._volume.contracted, self.history.shape
        self._conditions: Conditions | None = None
        self._response: Response | None = None
        self._strain: FloatArray = np.zeros((points.count, points.components))
        self._step, self._begins = 1.0, False
        self._gained: FloatArray = np.zeros(points.count)
        self._committed: tuple[PointHistory, Conditions, float, FloatArray, FloatArray] | None
        self._committed = None

    @property
    def conditions(self) -> Conditions:
        """Coefficients of the law in the present trial step."""
        assert self._conditions is not None
        return self._conditions

    @property
    def response(self) -> Response:
        """Stress and tangent for the last strain."""
        assert self._response is not None
        return self._response

    def state(self) -> PointState:
        """Return the functions for the forms."""
        return PointState(
            **self.functions.tensors(),
            compressibility=self.compressibility,
            thermal_strain=self.thermal_strain,
            out_of_plane=self.thickness.normal,
            follows=self.thickness.follows,
        )

    def begin(
        self,
        temperature: FloatArray,
        solid_fraction: FloatArray,
        step: float,
        between: Sequence[HeatState] = (),
    ) -> Conditions:
        """Evaluate the law for a trial step.

        Args:
            temperature: at the nodes at the end of the step [°C], shape (nodes,).
            solid_fraction: likewise.
            step: Δt [s].
            between: states of the nodes that the step has passed, if they are known.
        """
        c = self.law.conditions(
            self.points, temperature, solid_fraction, step, self._nodes, between
        )
        self._start, self._conditions, self._step, self._begins = self.history, c, step, True
        self.thickness.begin(c.shares.end > 0)
        self._secant.use(c, self.history.softening)
        self._contracted = self._volume.contracted + c.contraction
        self._shape = self.history.shape + c.shape
        self.compressibility.x.array[:] = c.compressibility
        self.thermal_strain.x.array[:] = self._volume.grown(
            c.start_share, c.share, c.strained_share, c.solid_compressibility, c.contraction
        )
        return c

    def swell(self, strain: FloatArray) -> None:
        """Let the cells swell in the trial step by volumetric strains, shape (cells,)."""
        self.thermal_strain.x.array[:] += self.points.cells_to_volumes(strain)

    @property
    def coherent(self) -> BoolArray:
        """Whether the cells hold any solid in the trial step, shape (cells,)."""
        return np.asarray(self.points.volumes_to_cells(self.conditions.share) > 0)

    @property
    def start_nodes(self) -> MetalNodes:
        """Metal of the nodes at the start of the step."""
        return self._nodes

    @property
    def start_volume(self) -> CellVolume:
        """Volume of the cells, or of the points, at the start of the step."""
        return self._volume

    def update(self, strain: FloatArray, pressure: FloatArray | None = None) -> None:
        """Update stress and tangent for a total strain at the end of the step.

        Args:
            strain: shape (points, components); in plane stress ε_zz is found here.
            pressure: mean stress at the points [Pa], where it is an unknown.

        Raises:
            ConvergenceError: the law cannot be solved at some point.
        """
        law = partial(respond, self.conditions, self._start)
        mean_stress = partial(self._mean_stress, strain, pressure)
        self._strain = self.thickness.complete(strain, law, mean_stress)
        evaluated = foreseen if self._begins else respond
        self._response = evaluated(self.conditions, self._start, deviatoric(self._strain))
        self._begins = False
        self.functions.take(self.response)

    def _mean_stress(
        self, strain: FloatArray, pressure: FloatArray | None, normal: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        if pressure is not None:
            return pressure, np.zeros_like(pressure)
        stiffness = 1 / self.points.from_volumes(self.conditions.compressibility)
        free = self.points.from_volumes(self.thermal_strain.x.array)
        return stiffness * (strain[:, 0] + strain[:, 1] + normal - free), stiffness

    @property
    def dilatation(self) -> FloatArray:
        """Volumetric strain of the cells, shape (cells,)."""
        return self.points.cell_means(self._strain[:, :3].sum(axis=1))

    @property
    def contracted(self) -> FloatArray:
        """Volumetric strain by which the solid of the cells has contracted, shape (cells,)."""
        return self.points.volumes_to_cells(self._contracted)

    def mean_stress(self) -> FloatArray:
        """Return K (∇·u - e^θ) of the volumes of a body that never melts [Pa], (volumes,)."""
        change = self.points.to_volumes(self._strain[:, :3].sum(axis=1))
        return np.asarray((change - self.thermal_strain.x.array) / self.conditions.compressibility)

    def mechanical_strain(self) -> FloatArray:
        """Return ε - e^θ/3 1 - e^c of the cells with all of their contraction, (cells, 6)."""
        strain = self.points.cell_tensors(self._strain - self._shape)
        strain[:, :3] -= self.contracted[:, None] / 3.0
        return strain

    def viscoplastic_strain(self) -> FloatArray:
        """Return the viscoplastic strain of the solid of the cells, shape (cells, 6)."""
        return self.points.cell_tensors(self.response.plastic)

    def plastic_power(self) -> FloatArray:
        """Return s:ε̇_vp [W/m³], shape (points,)."""
        return np.asarray(self.response.work / self._step)

    @property
    def step_size(self) -> float:
        """Size of the step of the present state [s]."""
        return self._step

    def plastic_increment(self) -> FloatArray:
        """Return the equivalent plastic strain of the last step since `restore`, (points,)."""
        return self._gained

    def saved(self) -> dict[str, Saved]:
        """Return the history, the volume, the strain out of the plane, and a field of T_sf.

        A field of stress-free temperatures is kept, since the file that it came from may be gone.
        """
        found = self.history.saved(self.points) | self.thickness.saved()
        volume, points = self._volume.mapped(self.points.volumes_by_cell), self.points
        for values, numbering in (self._nodes, points.node_numbering), (volume, points.numbering):
            found |= {name: Saved(v, numbering) for name, v in values._asdict().items()}
        unstressed = self.law.stress_free_state.temperature
        if np.ndim(unstressed):
            found["stress_free"] = Saved(np.asarray(unstressed), self.points.node_numbering)
        return found

    def restore(self, arrays: Arrays) -> None:
        """Restore the history with which the next step starts."""
        self.history, self._committed = self.history.restored(arrays), None
        self._gained = np.zeros(self.points.count)
        self._nodes = MetalNodes(*(arrays[name].copy() for name in MetalNodes._fields))
        self._volume = CellVolume(*(arrays[name].flatten() for name in CellVolume._fields))
        solid = np.asarray(self._nodes.share[self.points.cell_nodes].any(axis=1))
        self.thickness.restore(arrays, solid)
        if "stress_free" in arrays:
            unstressed = replace(self.law.stress_free_state, temperature=arrays["stress_free"])
            self.law = replace(self.law, stress_free=unstressed)

    def commit(self, mean_stress: FloatArray, pooled: BoolArray | None = None) -> None:
        """Accept the trial state as the start of the next step; collective.

        Args:
            mean_stress: of the volumes [Pa], shape (volumes,).
            pooled: cells of which a pool holds the volume of all together, shape (cells,); None:
                there are none.
        """
        strain, response = deviatoric(self._strain), self.response
        self.thickness.commit(self._strain)
        self._gained = np.asarray(response.equivalent - self._start.equivalent)
        softening = secant_softening(response, self.conditions, self._start, strain)
        past = response.elastic, response.plastic, response.equivalent, strain, softening
        self.history = PointHistory(*past, self._shape, response.mush)
        free = self.thermal_strain.x.array.copy()
        dilatation = self.points.to_volumes(self._strain[:, :3].sum(axis=1)).copy()
        kept = free + self.conditions.born_later(mean_stress)
        if self.law.freezes:
            part = forgotten(self.points, self._nodes, self.conditions, pooled)
            kept += part * (dilatation - kept)
        self._nodes = self.conditions.nodes
        self._volume = CellVolume(kept, dilatation, mean_stress.copy(), self._contracted)
        compressibility = self.compressibility.x.array.copy()
        self._committed = self._start, self.conditions, self._step, compressibility, free
        self._secant.commit()

    def rewind(self) -> None:
        """Return to the end of the last accepted step.

        It is evaluated from its own start: from its end, a viscous material would flow on.
        """
        self.thickness.rewind()
        self._secant.forget()
        self._begins = False
        if self._committed is not None:
            self._start, self._conditions, self._step, compressibility, free = self._committed
            self._secant.rewind(self._conditions, self._start.softening)
            self._contracted, self._shape = self._volume.contracted, self.history.shape
            self.compressibility.x.array[:] = compressibility
            self.thermal_strain.x.array[:] = free
