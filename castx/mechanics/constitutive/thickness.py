"""The strain ε_zz out of the plane of a body, in which a melt takes no part.

A plane does not show the end faces of the mould, which hold the melt: its weight would drive it out
of the plane. So metal keeps its thickness while it is not coherent, and the solid counts from
there. With χ = 1 in cells with solid and χ = 0 in the melt, and e the strain of the whole body in
generalised plane strain,

    ε_zz = ε_zz,n + χ (e − e_n),   ∫ χ σ_zz = 0,

n being the start of the step. Where nothing is solid e is held at e_n. In plane stress each point
of the solid has a strain ε_zz of its own, by σ_zz = 0; points of the melt keep theirs in a cell
with solid, too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mpi4py import MPI

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Law
from castx.mechanics.constitutive.plane_stress import normal_strain, with_normal
from castx.mechanics.constitutive.response import Response
from castx.stateful import Arrays, Saved, number

Respond = Callable[[FloatArray], Response]
MeanStress = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


class Thickness:
    """Strain out of the plane of a body that follows from its unknowns everywhere.

    Attributes:
        follows: χ of the cells, in plane stress of the points.
        kept: ε_zz of the cells beside χ e.
        normal: ε_zz of plane stress at the integration points; None: other models.
        hold: stiffness that holds e [Pa], zero where the solid does; None: it always does.
        start: e_n.
    """

    follows: Any = 1.0
    kept: Any = 0.0
    normal: fem.Function | None = None
    hold: fem.Constant | None = None
    start: fem.Constant | None = None

    def begin(self, solid: BoolArray) -> None:
        """Begin a trial step in which these points are solid, shape (points,); collective."""

    def complete(self, strain: FloatArray, respond: Respond, mean_stress: MeanStress) -> FloatArray:
        """Return strains with ε_zz, shape (points, components).

        Args:
            strain: of the forms, shape (points, components).
            respond: the law, a function of the deviatoric strain.
            mean_stress: p and dp/dε_zz as a function of ε_zz.

        Raises:
            ConvergenceError: ε_zz of a point was not found; on its own rank alone.
        """
        return strain

    def commit(self, strain: FloatArray) -> None:
        """Accept the trial step with these strains at its end, of `complete`; collective."""

    def rewind(self) -> None:
        """Return to the end of the last accepted step."""

    def saved(self) -> dict[str, Saved]:
        """Return the state at the end of the last accepted step."""
        return {}

    def restore(self, arrays: Arrays, coherent: BoolArray) -> None:
        """Take back this state, and which cells were solid in it, shape (cells,)."""


class CommonThickness(Thickness):
    """Generalised plane strain of a body that is liquid at times.

    Args:
        points: integration points of the body.
        cells: functions constant in each cell.
        modulus: stiffness that holds e where nothing is solid [Pa].
        starts_liquid: whether nothing is solid at the start.
    """

    hold: fem.Constant
    start: fem.Constant

    def __init__(
        self,
        points: IntegrationPoints,
        cells: fem.FunctionSpace,
        modulus: float,
        starts_liquid: bool,
    ) -> None:
        self._points, self._modulus = points, modulus
        self._comm, self._owned = cells.mesh.comm, cells.dofmap.index_map.size_local
        self.follows, self.kept = fem.Function(cells), fem.Function(cells)
        self.hold = fem.Constant(cells.mesh, np.float64(0.0))
        self.start = fem.Constant(cells.mesh, np.float64(0.0))
        self._last_kept: FloatArray = np.zeros(points.cells)
        self._last_solid: BoolArray = np.full(points.cells, not starts_liquid)
        self._use(self._last_solid, self._last_kept)

    def _use(self, solid: BoolArray, kept: FloatArray) -> None:
        self.follows.x.array[:], self.kept.x.array[:] = solid, kept
        anywhere = self._comm.allreduce(bool(solid[: self._owned].any()), op=MPI.LOR)
        self.hold.value = 0.0 if anywhere else self._modulus

    def begin(self, solid: BoolArray) -> None:
        """Begin a trial step in which these points are solid, shape (points,); collective."""
        coherent = np.asarray(self._points.by_cell(solid).any(axis=1))
        change = self._last_solid.astype(np.float64) - coherent
        self._use(coherent, self._last_kept + change * float(self.start.value))

    def commit(self, strain: FloatArray) -> None:
        """Accept the trial step with these strains at its end, of `complete`; collective."""
        solid = self.follows.x.array > 0
        common = (strain[:, 2] - self._points.from_cells(self.kept.x.array))[
            self._points.from_cells(solid)
        ]
        largest = self._comm.allreduce(float(common.max(initial=-np.inf)), op=MPI.MAX)
        if largest > -np.inf:
            self.start.value = largest
        self._last_solid, self._last_kept = solid, self.kept.x.array.copy()

    def rewind(self) -> None:
        """Return to the end of the last accepted step; collective."""
        self._use(self._last_solid, self._last_kept)

    def saved(self) -> dict[str, Saved]:
        """Return the thickness strains of the melt and of the body."""
        numbering = self._points.numbering
        return {
            "kept_thickness": Saved(self._last_kept, numbering),
            "thickness": number(float(self.start.value), bodies=numbering.bodies),
        }

    def restore(self, arrays: Arrays, coherent: BoolArray) -> None:
        """Take back this state, and which cells were solid in it, shape (cells,); collective."""
        self._last_kept, self._last_solid = arrays["kept_thickness"].copy(), coherent
        self.start.value = float(arrays["thickness"])
        self.rewind()


class FreeThickness(Thickness):
    """Plane stress: σ_zz = 0 at each point that is solid.

    Args:
        points: integration points of the body.
        melts: whether the body may be a liquid.
    """

    normal: fem.Function

    def __init__(self, points: IntegrationPoints, melts: bool) -> None:
        self._points, self.normal = points, points.scalar()
        self._last: FloatArray = np.zeros(points.count)
        if melts:
            self.follows = points.scalar()

    def begin(self, solid: BoolArray) -> None:
        """Begin a trial step in which these points are solid, shape (points,)."""
        if isinstance(self.follows, fem.Function):
            self.follows.x.array[:] = solid

    def complete(self, strain: FloatArray, respond: Respond, mean_stress: MeanStress) -> FloatArray:
        """Return strains with ε_zz, shape (points, components); see `Thickness.complete`."""
        held = None
        if isinstance(self.follows, fem.Function):
            held = self.follows.x.array == 0
            self.normal.x.array[held] = self._last[held]
        normal = normal_strain(strain, self.normal.x.array, respond, mean_stress, held)
        self.normal.x.array[:] = normal
        return with_normal(strain, normal)

    def commit(self, strain: FloatArray) -> None:
        """Accept the trial step with these strains at its end, of `complete`."""
        self._last = strain[:, 2].copy()

    def saved(self) -> dict[str, Saved]:
        """Return ε_zz by cell."""
        normal = self._points.by_cell(self._last.copy())
        return {"out_of_plane": Saved(normal, self._points.numbering)}

    def restore(self, arrays: Arrays, coherent: BoolArray) -> None:
        """Take back this state, and which cells were solid in it, shape (cells,)."""
        self._last = arrays["out_of_plane"].ravel().copy()
        self.normal.x.array[:] = self._last
        self.begin(self._points.from_cells(coherent))


def thickness(
    points: IntegrationPoints, law: Law, cells: fem.FunctionSpace, starts_liquid: bool
) -> Thickness:
    """Return the strain out of the plane of a body.

    Args:
        points: integration points of the body.
        law: law of the body.
        cells: functions constant in each cell.
        starts_liquid: whether nothing is solid at the start.
    """
    melts = law.material.liquid is not None
    if points.model == "plane-stress":
        return FreeThickness(points, melts)
    if points.model == "generalised-plane-strain" and melts:
        return CommonThickness(points, cells, law.largest_shear_modulus(), starts_liquid)
    return Thickness()
