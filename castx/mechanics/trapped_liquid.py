"""Trapped liquid, which no free surface feeds: its pressure, and the pores that open in it.

A pocket is incompressible, and its pressure follows from its walls; below the cavity pressure pores
open. With p the mean stress (tension positive), φ the void fraction of the pocket and p_c the
depression at which pores open at its highest point (`cavitation`; −b·x adds the weight of what
stands above):

    φ ≥ 0,   p ≤ p_c,   φ (p − p_c) = 0,   φ = mean(∇·u) − mean(e),

with e the content of its cells (`castx.mechanics.liquid.content`). One state holds for all of a
pocket, since its liquid flows freely; it changes between iterations only, when the pressure of a
full pocket rises above p_c, or the void of a porous one falls below zero. A pore that closes has to
be filled before the pocket resists.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.domain.measures import cell_measure
from castx.domain.mesh import BodyMesh
from castx.forms.momentum import PointState
from castx.materials.thermal_strain import liquid_shrinkage
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.liquid.content import Content
from castx.mechanics.liquid.feeding_paths import FeedingPaths
from castx.mechanics.liquid.pores import Pores
from castx.mechanics.liquid.pressures import PocketPressures
from castx.stateful import Arrays, Saved, Stateful, number

logger = logging.getLogger(__name__)

POROUS_SHARE = 1e-6
"""Weight of the equation p = p_c inside porous liquid, in units of the solid's 1/K."""

FULL_SHARE = 1e-3
"""Compressibility of full trapped liquid beside the solid's, far below that of any shell: a mould
filled with nothing else has a pressure by it."""


class Pockets:
    """Pressure and pores of the trapped liquid of one body.

    Args:
        body: mesh of the body.
        model: geometric model.
        closed: names of the surfaces through which no liquid can follow.
        potential: x·b of the body force b at the local nodes [Pa], shape (nodes,), or one value;
            a pocket that is closed from the start carries it by a hydrostatic pressure.
        cavitation: p_c, the depression at which pores open [Pa].

    Attributes:
        trapped: one in the trapped cells of the trial step, else zero.
        porous: one in those of porous pockets, else zero.
        pressure: given pressure of porous liquid, reference of that of full one, at the nodes [Pa].
        content: what the cells hold, and the balance of feeding.
        mean_pressure: mean of p over the trapped liquid after the last step [Pa], 0: there is none.
    """

    def __init__(
        self,
        body: BodyMesh,
        model: str,
        closed: Collection[str],
        potential: FloatArray | float = 0.0,
        cavitation: float = 0.0,
    ) -> None:
        space = fem.functionspace(body.mesh, ("DG", 0))
        self.trapped, self.porous = fem.Function(space), fem.Function(space)
        self.pressure = fem.Function(body.nodes)
        self._body = body
        self._paths = FeedingPaths(body, model, closed)
        self._cell_nodes: IntArray = body.nodes.dofmap.list
        volumes = fem.assemble_vector(
            fem.form(ufl.TestFunction(space) * cell_measure(body, model, 2))
        ).array[: space.dofmap.index_map.size_local]
        self.content = Content(body.mesh.comm, body.cell_numbering, volumes)
        self.mean_pressure = 0.0
        self._pressures = PocketPressures(body, potential, cavitation)
        self._pores = Pores(self.content, body.cell_numbering)
        self._scale: FloatArray = np.zeros(0)
        self._accepted = [f.x.array.copy() for f in self._functions]

    @property
    def _functions(self) -> tuple[fem.Function, ...]:
        return self.trapped, self.porous, self.pressure

    @property
    def exist(self) -> bool:
        """Whether there is trapped liquid in the trial step, on any rank."""
        return len(self._pores.open) > 0

    def state(self, points: PointState) -> PointState:
        """Return the state of the integration points, with that of trapped liquid."""
        return points._replace(
            trapped=self.trapped, porous=self.porous, trapped_pressure=self.pressure
        )

    def begin(self, material: MaterialPoints, solid_fraction: FloatArray) -> None:
        """Find the pockets of a trial step, their content and their state; collective.

        Args:
            material: of the body, at the conditions of the step.
            solid_fraction: at the nodes, shape (nodes,).
        """
        law, liquid = material.law, ~material.conditions.coherent
        fraction = solid_fraction[self._cell_nodes].mean(axis=1)
        # What was solid when it was free of strain has not shrunk since.
        skeleton = law.stress_free_state.shrinkage(law.material, fraction, self._cell_nodes)
        self.update(liquid, liquid_shrinkage(law.material, fraction), skeleton)
        self._scale = np.zeros(0)
        if self.exist:
            self._scale = self.content.mean(material.conditions.solid_compressibility)
        self.apply(material)

    def update(self, liquid: BoolArray, shrunk: FloatArray, skeleton: FloatArray) -> None:
        """Find the pockets of a trial step, their pressures and a first guess of their state.

        Args:
            liquid: whether a cell is a liquid, shape (cells,).
            shrunk: s min(f_s, f_c) of the cells, shape (cells,).
            skeleton: strain by −s (f_s − f_c) beyond coherency since the body was free of strain,
                shape (cells,); collective.
        """
        self.content.begin(self._paths.pockets(liquid), liquid, shrunk, skeleton)
        self._pressures.begin(self.content)
        self._pores.begin()

    def apply(self, material: MaterialPoints) -> None:
        """Give the state of the pockets to the material and to the forms."""
        trapped, porous = self.content.pocket >= 0, self._pores.cells
        self.trapped.x.array[:], self.porous.x.array[:] = trapped, porous
        self.pressure.x.array[:] = self._pressures.acting(porous)
        solid = material.conditions.solid_compressibility
        # So little that the pressures of the shell stay their own.
        share = np.where(porous, POROUS_SHARE, FULL_SHARE)
        material.compressibility.x.array[trapped] = (share * solid)[trapped]
        material.set_free_volume(np.where(porous, 0.0, self.content.free_volume))

    def full_cells(self) -> BoolArray:
        """Return whether the cells are full trapped liquid, shape (cells,)."""
        return (self.content.pocket >= 0) & ~self._pores.cells

    def cell_pressures(self) -> FloatArray:
        """Return the given pressures of the porous cells [Pa], nan elsewhere, shape (cells,)."""
        porous = self.porous.x.array.astype(bool)
        return np.where(porous, self._pressures.of_cells(self.pressure.x.array), np.nan)

    def reference_pressures(self) -> FloatArray:
        """Return p at which a full trapped cell has its volume, zero elsewhere [Pa], (cells,)."""
        pressures = self._pressures
        return np.where(self.content.pocket >= 0, pressures.of_cells(pressures.reference), 0.0)

    def _limits(self) -> FloatArray:
        return self._pressures.of_cells(self._pressures.limit)

    def turn(self, material: MaterialPoints, pressure: FloatArray) -> bool:
        """Open and close pores at an iterate; return whether any pocket has changed; collective.

        Args:
            material: of the body, with the volumetric strains there.
            pressure: mean stress of the cells there [Pa], shape (cells,).
        """
        if not self.exist:
            return False
        content = self.content
        excess = self._scale * content.mean(pressure - self._limits())
        void = content.void_fraction(material.dilatation)
        turned = self._pores.turn(excess, void)
        if turned:
            self.apply(material)
        return turned

    def commit(
        self, pressure: Callable[[], FloatArray], cells: FloatArray, dilatation: FloatArray
    ) -> None:
        """Book an accepted step; collective.

        Args:
            pressure: returns that at the local nodes [Pa], shape (nodes,).
            cells: pressures of the cells [Pa], shape (cells,).
            dilatation: volumetric strain of the cells, shape (cells,).
        """
        volumes = self.content.pockets
        self.mean_pressure = 0.0
        if self.exist:
            for pockets, what in self._pores.news():
                if pockets.any():
                    logger.info("%s: %.3g m³ %s", self._body.name, volumes[pockets].sum(), what)
            porous = self.porous.x.array.astype(bool)
            means = self.content.mean(np.where(porous, self._limits(), cells))
            self.mean_pressure = float(means @ volumes / volumes.sum())
        self.content.commit(dilatation, self._pores.open)
        self._pressures.commit(pressure())
        self._pores.commit()
        self._accepted = [f.x.array.copy() for f in self._functions]

    def rewind(self) -> None:
        """Return to the state of the last accepted step."""
        self._pores.rewind()
        for function, values in zip(self._functions, self._accepted, strict=True):
            function.x.array[:] = values

    def totals(self) -> dict[str, float] | None:
        """Return demand, what is fed, pores [m³] and pressure [Pa] by the name of the column."""
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
        trapped, porous, pressure = self._accepted
        return {
            "trapped": Saved(trapped, cells),
            "porous": Saved(porous, cells),
            "given_pressure": Saved(pressure, nodes),
            "mean_pressure": number(self.mean_pressure, bodies=(self._body.name,)),
            **self._pressures.saved(),
            **self._pores.saved(),
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore a committed state."""
        self._pores.restore(arrays)
        self._accepted = [
            arrays[name].astype(np.float64) for name in ("trapped", "porous", "given_pressure")
        ]
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

    def state(self, points: PointState) -> PointState:
        """Return the state of the integration points as it is."""
        return points

    def begin(self, material: MaterialPoints, solid_fraction: FloatArray) -> None:
        """Leave the material of a trial step as it is."""

    def full_cells(self) -> BoolArray:
        """Return False, shape (cells,)."""
        return np.zeros(self._cells, dtype=bool)

    def cell_pressures(self) -> FloatArray:
        """Return nan, shape (cells,)."""
        return np.full(self._cells, np.nan)

    def reference_pressures(self) -> FloatArray:
        """Return zero, shape (cells,)."""
        return np.zeros(self._cells)

    def turn(self, material: MaterialPoints, pressure: FloatArray) -> bool:
        """Return that nothing has changed."""
        return False

    def commit(
        self, pressure: Callable[[], FloatArray], cells: FloatArray, dilatation: FloatArray
    ) -> None:
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
