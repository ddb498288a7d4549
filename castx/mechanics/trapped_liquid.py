"""Trapped liquid, not fed by a free surface: its pressure, and the pores that open in it.

A pocket is incompressible, and its pressure follows from its walls; below the cavity pressure pores
open. Its liquid flows freely, so that one pressure acts in all of it, beside the weight of what
stands above (−b·x). With p that pressure (tension positive), φ the void fraction of the pocket and
p_c the depression at which pores open at its highest point (`cavitation`):

    φ ≥ 0,   p ≤ p_c,   φ (p − p_c) = 0,   φ = mean(∇·u) − mean(e),

with e the content of its cells (`castx.mechanics.liquid.content`). At each iterate

    p = min(p_c, p_0 + κ φ),

with p_0 the pressure at which the pocket closed and κ so large that φ is next to nothing in a full
one. That is the gradient of a convex energy, so that Newton's method with a line search finds the
state. A pore that closes has to be filled before the pocket resists.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection

from mpi4py import MPI

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.measures import cell_measure
from castx.domain.mesh import BodyMesh
from castx.forms.momentum import PointState
from castx.input.units import plain_text
from castx.materials.material import Material
from castx.materials.thermal_strain import liquid_shrinkage
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.liquid.content import Content
from castx.mechanics.liquid.feeding_paths import CutOff, FeedingPaths
from castx.mechanics.liquid.pores import SLACK, Pores
from castx.mechanics.liquid.pressures import PocketPressures
from castx.mechanics.liquid.stiffness import (
    PocketStiffness,
    pockets_of_midsides,
    pockets_of_nodes,
)
from castx.mechanics.midsides.midsides import Midsides
from castx.stateful import Arrays, Saved, Stateful, number

logger = logging.getLogger(__name__)

NODAL_SHARE = 1e-6
"""Weight of the equation of the nodal pressure inside trapped liquid, in units of the solid's 1/K:
so little that the pressures of the shell stay their own."""

FULL_SHARE = 1e-3
"""Compressibility 1/κ of full trapped liquid beside the solid's, far below that of any shell: a
mould filled with nothing else has a pressure by it."""

PASSES_TO_FIND = 3
"""Passes of a step that find which liquid is trapped; the later ones keep that. A neck that opens
and closes with a tenth of a kelvin moves all of a pool, so that passes would have no fixed point: a
step of a thin tray in a pressure die then took 23 passes and was cut, and takes 8."""

LARGEST_PRESS = 2e8
"""Pressure of trapped liquid that nothing bears [Pa]: twice that by which die casting machines feed
what shrinks."""


class Pockets:
    """Pressure and pores of the trapped liquid of one body.

    Args:
        body: mesh of the body.
        model: geometric model.
        closed: names of the surfaces through which no liquid can follow.
        potential: x·b of the body force b at the local nodes [Pa], shape (nodes,), or one value;
            a pocket that is closed from the start carries it by a hydrostatic pressure.
        cavitation: p_c, the depression at which pores open [Pa].
        block_size: unknowns of a node.
        midsides: of the body; None: it has none.

    Attributes:
        trapped: one in the pools of trapped liquid in the trial step, else zero.
        pressure: that of the pockets at their nodes [Pa].
        content: what the cells hold, and the balance of feeding.
        stiffness: what full pockets add to the Jacobian.
        mean_pressure: mean of p over the trapped liquid after the last step [Pa], 0: there is none.
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        closed: Collection[str],
        potential: FloatArray | float = 0.0,
        cavitation: float = 0.0,
        block_size: int = 1,
        midsides: Midsides | None = None,
    ) -> None:
        space = fem.functionspace(body.mesh, ("DG", 0))
        self.trapped, self.pressure = fem.Function(space), fem.Function(body.nodes)
        self._body = body
        self._paths = FeedingPaths(body, model, closed)
        self._cell_nodes: IntArray = body.nodes.dofmap.list
        volumes = fem.assemble_vector(
            fem.form(ufl.TestFunction(space) * cell_measure(body, model, 2))
        ).array[: space.dofmap.index_map.size_local]
        self.content = Content(body.mesh.comm, body.cell_numbering, volumes)
        self._block_size, self._midsides = block_size, midsides
        each = block_size if midsides is None else 1
        self.stiffness = PocketStiffness(body.mesh.comm, each)
        self.mean_pressure, self._said = 0.0, False
        self._pressures = PocketPressures(body, potential, cavitation)
        self._pores = Pores(self.content, body.cell_numbering)
        self._stiffness: FloatArray = np.zeros(0)
        self._cut_off = CutOff.throughout(np.zeros(0, dtype=np.int32))
        self._fraction: FloatArray = np.ones(len(body.parent_vertices))
        self._trial_fraction: FloatArray = self._fraction
        self._liquid: BoolArray = np.zeros(0, dtype=bool)
        self._is_trial, self._passes = False, 0
        self._accepted = [f.x.array.copy() for f in self._functions]

    @property
    def _functions(self) -> tuple[fem.Function, ...]:
        return self.trapped, self.pressure

    @property
    def exist(self) -> bool:
        """Whether there is trapped liquid in the trial step, on any rank."""
        return len(self._pores.open) > 0

    @property
    def pores(self) -> FloatArray:
        """Pores of the cells after the last accepted step, as shares of them, shape (cells,)."""
        return self.content.pores

    def state(self, points: PointState) -> PointState:
        """Return the states of the integration points and of trapped liquid."""
        return points._replace(trapped=self.trapped, trapped_pressure=self.pressure)

    def begin(self, material: MaterialPoints, solid_fraction: FloatArray) -> None:
        """Find the pockets of a trial step, their content and their state; collective.

        From the fourth call for a step on they are those of the third.

        Args:
            material: of the body, at the conditions of the step.
            solid_fraction: at the nodes, shape (nodes,).
        """
        metal, content = material.law.material, self.content
        points, before = material.points, material.start_volume
        self._passes += 1
        self._trial_fraction = solid_fraction.copy()
        if self._passes <= PASSES_TO_FIND:
            self._cut_off = self._paths.cut_off(
                self._fraction, solid_fraction, metal.fed_until, content.was_fed
            )
            self._liquid = ~material.coherent
        dilatation = points.volumes_to_cells(before.dilatation)
        c = material.conditions
        born = before.born(c.start_share, c.share, c.solid_compressibility)
        content.begin(
            self._cut_off, self._liquid, self._shrunk(metal, 1.0),
            self._shrunk(metal, self._cut_off.moment[:, np.newaxis]), dilatation,
            points.volumes_to_cells(born),
        )  # fmt: skip
        material.swell(content.swelling)
        self._pressures.begin(content)
        self._pores.begin()
        self._is_trial = True
        trapped = content.pocket >= 0
        solid = points.volumes_to_cells(material.conditions.solid_compressibility)
        self._stiffness = np.zeros(0)
        if self.exist:
            self._stiffness = (1.0 / (FULL_SHARE * content.mean(solid))).astype(np.float64)
        self.trapped.x.array[:] = trapped
        self.pressure.x.array[:] = self._pressures.acting(np.zeros(len(self._stiffness)))
        there = points.cells_to_volumes(trapped)
        least = points.cells_to_volumes(NODAL_SHARE * solid)
        material.compressibility.x.array[there] = least[there]

    def _shrunk(self, metal: Material, moment: FloatArray | float) -> FloatArray:
        """Return s min(f_s, f_c) of the cells after a part of the trial step, shape (cells,)."""
        before, after = self._fraction[self._cell_nodes], self._trial_fraction[self._cell_nodes]
        found = liquid_shrinkage(metal, before + moment * (after - before))
        return np.asarray(found.mean(axis=1))

    def stiffen(self, rows: FloatArray, columns: FloatArray) -> None:
        """Prepare the block of full pockets in the Jacobian; collective.

        Args:
            rows: derivative of the volumes of the pockets, shape (owned unknowns,), of the nodes
                and then of the mid-sides [m²].
            columns: derivative of the residual by their pressures, likewise.
        """
        of_nodes = pockets_of_nodes(self._body, self.content.pocket)
        if self._midsides is None:
            self.stiffness.begin(of_nodes, rows, columns)
            return
        of_midsides = pockets_of_midsides(self._midsides, self.content.pocket)
        sizes = self._block_size, self._midsides.block_size
        both = [np.repeat(p, n) for p, n in zip((of_nodes, of_midsides), sizes, strict=True)]
        self.stiffness.begin(np.concatenate(both), rows, columns)

    def evaluate(self, dilatation: FloatArray) -> None:
        """Find the pressures of the pockets; collective.

        Args:
            dilatation: volumetric strain of the cells, shape (cells,).
        """
        if not self._is_trial or not self.exist:
            return
        void = self.content.void_fraction(dilatation)
        excess = self._pressures.at_closing + self._stiffness * void
        self._pores.open = (excess > 0.0) & (void > SLACK)
        self.pressure.x.array[:] = self._pressures.acting(np.minimum(excess, 0.0))
        volumes = self.content.pockets
        self.stiffness.stiffness = np.where(excess <= 0.0, self._stiffness / volumes, 0.0)

    def cell_pressures(self) -> FloatArray:
        """Return the pressures of the trapped cells [Pa], nan elsewhere, shape (cells,)."""
        trapped = self.trapped.x.array.astype(bool)
        return np.where(trapped, self._pressures.of_cells(self.pressure.x.array), np.nan)

    @property
    def hold_volume(self) -> BoolArray:
        """Whether a pocket has the volume of the cells, and not each of them, shape (cells,)."""
        return np.asarray(self.trapped.x.array > 0)

    def commit(self, pressure: Callable[[], FloatArray], dilatation: FloatArray) -> None:
        """Book an accepted step; collective.

        Args:
            pressure: returns that at the local nodes [Pa], shape (nodes,).
            dilatation: volumetric strain of the cells, shape (cells,).
        """
        volumes = self.content.pockets
        self.mean_pressure = 0.0
        if self.exist:
            for pockets, what in self._pores.news():
                if pockets.any():
                    found = plain_text(1e6 * volumes[pockets].sum(), 3)
                    logger.info("%s: %s cm³ %s", self._body.name, found, what)
            acting = self._pressures.of_cells(self.pressure.x.array)
            self.mean_pressure = float(self.content.mean(acting) @ volumes / volumes.sum())
            self._warn_of_walls()
        self.content.commit(dilatation, self._pores.open)
        self._pressures.commit(pressure())
        self._pores.commit()
        self._passes = 0
        self._fraction = self._trial_fraction
        self._accepted = [f.x.array.copy() for f in self._functions]

    def _warn_of_walls(self) -> None:
        if self.mean_pressure < -LARGEST_PRESS and not self._said:
            self._said = True
            logger.warning(
                "%s: its trapped liquid presses by %.0f MPa, which no mould bears: metal that "
                "swells as it freezes is closed in by walls that do not yield, and what follows "
                'from its stress is false; give the mould a law other than "rigid", or the '
                "casting a free surface (castx new --top open)",
                self._body.name, -1e-6 * self.mean_pressure,
            )  # fmt: skip

    def rewind(self) -> None:
        """Return to the state of the last accepted step."""
        self._is_trial, self._passes = False, 0
        for function, values in zip(self._functions, self._accepted, strict=True):
            function.x.array[:] = values

    def totals(self) -> dict[str, float] | None:
        """Return demand, fed volume, pores [m³] and pressure [Pa] by the name of the column."""
        return {
            "feeding_demand": self.content.demand,
            "fed_volume": self.content.fed,
            "unfed_volume": self.content.void,
            "pocket_pressure": self.mean_pressure,
        }

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return the parts that a checkpoint keeps, by their name there."""
        return {"pockets": self, "content": self.content}

    def saved(self) -> dict[str, Saved]:
        """Return the committed state of the pockets and their pressures."""
        nodes, cells = self._body.node_numbering, self._body.cell_numbering
        trapped, pressure = self._accepted
        return {
            "trapped": Saved(trapped, cells),
            "given_pressure": Saved(pressure, nodes),
            "fraction": Saved(self._fraction, nodes),
            "mean_pressure": number(self.mean_pressure, bodies=(self._body.name,)),
            **self._pressures.saved(),
            **self._pores.saved(),
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore a committed state."""
        self._pores.restore(arrays)
        self._accepted = [arrays[name].astype(np.float64) for name in ("trapped", "given_pressure")]
        self._fraction = arrays["fraction"].copy()
        self._pressures.restore(arrays)
        self.mean_pressure = float(arrays["mean_pressure"])
        self.rewind()


class NoPockets:
    """Stands for the pockets of a body that never is a liquid.

    Args:
        cells: number of cells of this rank.
    """

    exist = False

    def __init__(self, cells: int) -> None:
        self._cells = cells
        self.stiffness = PocketStiffness(MPI.COMM_SELF, 1)

    @property
    def pores(self) -> FloatArray:
        """None in any cell, shape (cells,)."""
        return np.zeros(self._cells)

    def state(self, points: PointState) -> PointState:
        """Return the state of the integration points as it is."""
        return points

    def begin(self, material: MaterialPoints, solid_fraction: FloatArray) -> None:
        """Leave the material of a trial step as it is."""

    def stiffen(self, rows: FloatArray, columns: FloatArray) -> None:
        """Prepare nothing."""

    def evaluate(self, dilatation: FloatArray) -> None:
        """Find nothing."""

    def cell_pressures(self) -> FloatArray:
        """Return nan, shape (cells,)."""
        return np.full(self._cells, np.nan)

    @property
    def hold_volume(self) -> BoolArray:
        """Return no cell, shape (cells,)."""
        return np.zeros(self._cells, dtype=bool)

    def commit(self, pressure: Callable[[], FloatArray], dilatation: FloatArray) -> None:
        """Book nothing."""

    def rewind(self) -> None:
        """Return to nothing."""

    def totals(self) -> dict[str, float] | None:
        """Return None: nothing is booked."""
        return None

    def stateful_parts(self) -> dict[str, Stateful]:
        """Return nothing."""
        return {}


TrappedLiquid = Pockets | NoPockets
