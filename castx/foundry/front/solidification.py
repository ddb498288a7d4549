"""Foundry quantities of solidification: local solidification time, gradient, cooling rate, Niyama.

Every node of a body that melts is followed through its enthalpy. The local solidification time is
the time between the passing of the liquidus and that of the solidus; `castx.foundry.front` says
when a level of solid fraction passes a node. In an isothermal change both pass at once.

The cooling rate is -∂T/∂t of a node when its temperature passes the level f_s = 0.9, or another one
that the user takes. It has two measures. One is the time in which the temperature of the node falls
through a window around the level (`castx.foundry.front.cooling`). The other one is that of a node
which the surface f_s = 0.9 passes with the speed v: Ṫ = G v with v = 1/|∇t|, t the time of passing
(W. Kurz and D. J. Fisher, Fundamentals of Solidification, 1998, ch. 1). Where differences of
temperature between nodes are small beside the window the first one counts, exact where the body
cools as a whole; where the front is steep the second one, smooth where the history of a single node
has stairs; between them a mean. There t is when the temperature of the node itself passes, since
the mean passing of a control volume is late at a surface, where the volume lies on one side of its
node. What freezes at one temperature has G v alone, with the passing of the front.

The gradient is that of the same moment, within the step in which that surface passes. The front
speed is v = Ṫ/G, so that the three agree everywhere.

Niyama criterion: E. Niyama, T. Uchida, M. Morikawa and S. Saito, A method of shrinkage prediction
and its application to steel casting practice, AFS Int. Cast Metals J. 7 (1982) 52-63.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.case.output import FrontPlace
from castx.foundry.front.control_volumes import ControlVolumes
from castx.foundry.front.cooling import CoolingWindow, WindowCooling
from castx.foundry.front.excess import PLACES, WEIGHTS, Step
from castx.foundry.front.gradients import Steepness
from castx.foundry.front.lasting import Lasting
from castx.foundry.front.levels import FreezingCurve, Level
from castx.foundry.front.passing import Front
from castx.results.states.snapshot import Snapshot
from castx.stateful import Array, Arrays, Saved, number, part_of, saved_parts

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh, CastingMesh

LEVELS = (0.0, 0.9, 1.0)
"""Solid fractions whose passing is noted by default: liquidus, that of the gradient, solidus."""
LIQUIDUS, FRONT, SOLIDUS = range(3)
USUAL_FRONT = FrontPlace(fraction=LEVELS[FRONT])

MIDDLE = PLACES.index(0.0)
QUANTITIES = ("solidification_time", "gradient", "cooling_rate", "niyama", "front_speed")


@dataclass(frozen=True)
class Followed:
    """Quantities recorded during freezing, beside the times of liquidus and solidus.

    Attributes:
        at: the surface at whose passing gradient, cooling rate and front speed are taken.
        fractions: further solid fractions whose passing is noted.
        lasting: rising solid fractions; it is noted how long it takes from each to the next one.
    """

    at: FrontPlace = USUAL_FRONT
    fractions: tuple[float, ...] = ()
    lasting: tuple[float, ...] = ()

    @property
    def places(self) -> tuple[FrontPlace, ...]:
        """All surfaces: liquidus, that of the gradient, solidus, then the further ones."""
        ends = FrontPlace(fraction=LEVELS[LIQUIDUS]), FrontPlace(fraction=LEVELS[SOLIDUS])
        first = (ends[0], self.at, ends[1])
        further = dict.fromkeys(FrontPlace(fraction=value) for value in self.fractions)
        return (*first, *(place for place in further if place not in first))

    def levels(self, curve: FreezingCurve) -> list[Level]:
        """Return the levels of all surfaces on the curve of a material."""
        return [level_of(curve, place) for place in self.places]


def level_of(curve: FreezingCurve, place: FrontPlace) -> Level:
    """Return the level of a surface on the curve of a material."""
    if place.fraction is not None:
        return Level.of(curve, place.fraction)
    assert place.temperature is not None
    return Level.at(curve, place.temperature)


AS_USUAL = Followed()


class BodySolidification:
    """The solidification of one body, followed step by step.

    Args:
        body: its mesh.
        curve: enthalpy of its material.
        axisymmetric: whether the first coordinate is a radius.
        followed: the surfaces whose passing is noted.
    """

    def __init__(
        self,
        body: BodyMesh,
        curve: FreezingCurve,
        axisymmetric: bool = False,
        followed: Followed = AS_USUAL,
    ) -> None:
        self._places = followed.places
        volumes = ControlVolumes(body, axisymmetric)
        levels = followed.levels(curve)
        self._front = Front(body, curve, levels, volumes)
        window = CoolingWindow.around(curve, levels[FRONT])
        self._cooling = None if window is None else WindowCooling(volumes, curve, window)
        self._lasting = Lasting(volumes, curve, followed.lasting) if followed.lasting else None
        self._steepness = Steepness(body)
        nodes = len(body.parent_vertices)
        self._times: FloatArray = np.full((len(self._places), len(PLACES), nodes), np.nan)
        self._passed: BoolArray = np.zeros(self._times.shape, dtype=bool)
        self._gradient: FloatArray = np.full(nodes, np.nan)
        self._time = self._first_time = np.nan
        self._enthalpy: FloatArray = np.zeros(nodes)
        self._first_enthalpy: FloatArray = np.zeros(nodes)
        self._numbering = body.node_numbering
        self._slow: FloatArray | None = None

    def update(self, snapshot: Snapshot, body: str) -> None:
        """Take over the state after an accepted step; collective."""
        self._slow = None
        time, enthalpy = snapshot.time, snapshot.nodal(body, "enthalpy").copy()
        if body in snapshot.process.renewed:
            self._times[:], self._gradient[:] = np.nan, np.nan
            self._first_time = snapshot.time - snapshot.counters.step
            if self._lasting is not None:
                self._lasting.begin()
            if self._cooling is not None:
                self._cooling.begin()
            self._begin(self._first_time, self._first_enthalpy)
        if np.isnan(self._time):
            self._first_time, self._first_enthalpy = time, enthalpy
            self._begin(time, enthalpy)
        else:
            self._pass(Step(self._enthalpy, enthalpy), self._time, time)
        self._time, self._enthalpy = time, enthalpy

    def _begin(self, time: float, enthalpy: FloatArray) -> None:
        """Note the levels that a body has already passed when it begins; collective."""
        self._passed = self._front.passed(enthalpy)
        self._times[self._passed & ~self._passed[SOLIDUS, MIDDLE]] = time
        self._time, self._enthalpy = time, enthalpy

    def _pass(self, step: Step, start: float, end: float) -> None:
        """Note the levels passed in a step; remelting deletes those it passes; collective."""
        if self._lasting is not None:
            self._lasting.follow(step.start, step.end, end - start)
        if self._cooling is not None:
            self._cooling.follow(step, start, end)
        parts = self._front.parts(step)
        found = self._front.passage(step, parts, self._passed)
        self._times[found.remelted] = np.nan
        self._times[found.frozen] = start + found.share[found.frozen] * (end - start)
        self._passed ^= found.frozen | found.remelted
        frozen, share = found.frozen[FRONT, MIDDLE], found.share[FRONT, MIDDLE]
        gradient = self._front.gradient(step, frozen, share, parts)
        self._gradient[frozen] = gradient[frozen]

    def _passing(self, level: int) -> FloatArray:
        """Return when one of the levels passed the nodes [s].

        Until the front has left the control volume, this is when it came to the node.
        """
        times = self._times[level]
        mean = np.asarray(WEIGHTS) @ times
        return np.where(np.isfinite(mean), mean, times[MIDDLE])

    def _of_front(self, name: str) -> str:
        """Return the name under which something at the surface of the gradient is saved."""
        return f"{name} at {self._places[FRONT].text}"

    def saved(self) -> dict[str, Saved]:
        """Return the times of passing so far, the last state and the first one."""
        found = {"last_enthalpy": self._enthalpy, "first_enthalpy": self._first_enthalpy}
        for index, place in enumerate(self._places):
            found[f"times at {place.text}"] = by_node(self._times[index])
            found[f"passed at {place.text}"] = by_node(self._passed[index])
        found[self._of_front("gradient")] = self._gradient
        if self._lasting is not None:
            found["lasted"] = by_node(self._lasting.durations)
        if self._cooling is not None:
            found[self._of_front("cooling")] = by_node(self._cooling.times)
            found[self._of_front("spread")] = self._cooling.spread
        nodal = {name: Saved(values, self._numbering) for name, values in found.items()}
        return {"time": number(self._time), "first_time": number(self._first_time), **nodal}

    def restore(self, arrays: Arrays) -> None:
        """Restore the times of passing, the last state and the first one; collective.

        A level that was not noted before is noted from now on.
        """
        self._slow = None
        self._time, self._enthalpy = float(arrays["time"]), arrays["last_enthalpy"]
        self._first_time = float(arrays["first_time"])
        self._first_enthalpy = arrays["first_enthalpy"]
        self._passed = self._front.passed(self._enthalpy)
        for index, place in enumerate(self._places):
            if f"times at {place.text}" in arrays:
                self._times[index] = arrays[f"times at {place.text}"].T
                self._passed[index] = arrays[f"passed at {place.text}"].T
        if self._of_front("gradient") in arrays:
            self._gradient = arrays[self._of_front("gradient")]
        if self._cooling is not None and self._of_front("cooling") in arrays:
            self._cooling.times = arrays[self._of_front("cooling")].T.copy()
            self._cooling.spread = arrays[self._of_front("spread")].copy()
        if self._lasting is not None:
            self._lasting.begin_amid(self._enthalpy)
            if "lasted" in arrays:
                self._lasting.durations = arrays["lasted"].T.copy()

    def solidification_time(self) -> FloatArray:
        """Return the time between liquidus and solidus [s]; zero in an isothermal change."""
        return self._passing(SOLIDUS) - self._passing(LIQUIDUS)

    def passing_time(self, fraction: float) -> FloatArray:
        """Return when a solid fraction passed, from when the body was poured [s].

        Args:
            fraction: one of those that are noted.
        """
        level = self._places.index(FrontPlace(fraction=fraction))
        return self._passing(level) - self._first_time

    def lasted(self) -> FloatArray:
        """Return the time spent by control volumes in each range, (ranges, nodes) [s]; collective.

        Not a number until all of a control volume is beyond the last of them.
        """
        assert self._lasting is not None
        return self._lasting.ended(self._enthalpy)

    def gradient(self) -> FloatArray:
        """Return |∇T| at the passage of f_s = 0.9, or of another recorded level [K/m]."""
        return np.where(np.isfinite(self._passing(FRONT)), self._gradient, np.nan)

    def _slowness(self) -> FloatArray:
        """Return |∇t| of the times at which f_s = 0.9 was passed [s/m]; collective.

        Several quantities ask for it after one step; it is found once.
        """
        if self._slow is None:
            times = self._passing(FRONT)
            if self._cooling is not None:
                own = self._cooling.passing
                times = np.where(np.isfinite(own), own, times)
            in_cells = self._steepness.in_cells(times)
            finite = np.isfinite(in_cells).astype(np.float64)
            self._slow = self._steepness.at_nodes(in_cells, finite)
        return self._slow

    def front_speed(self) -> FloatArray:
        """Return v = Ṫ/G of the surface f_s = 0.9 [m/s]; collective."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.cooling_rate() / self.gradient()

    def cooling_rate(self) -> FloatArray:
        """Return Ṫ when f_s = 0.9 was passed, positive on cooling [K/s]; collective."""
        with np.errstate(divide="ignore", invalid="ignore"):
            of_front = self.gradient() / self._slowness()
        if self._cooling is None:
            return of_front
        weight, own = self._cooling.weight(), self._cooling.rate()
        mean = weight * own + (1.0 - weight) * of_front
        return np.select([weight == 0.0, weight == 1.0], [of_front, own], mean)

    def niyama(self) -> FloatArray:
        """Return G/√Ṫ when f_s = 0.9 was passed [K^½ s^½/m]; collective."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.gradient() / np.sqrt(self.cooling_rate()))


def by_node(values: Array) -> Array:
    """Return values (places, nodes) with a row for each node, (nodes, places)."""
    return np.ascontiguousarray(values.T)


class Solidification:
    """The foundry quantities of all bodies that melt.

    Args:
        mesh: the bodies.
        curves: enthalpies of the materials of the bodies that melt, by the name of the body.
        followed: the surfaces whose passing is noted.
    """

    def __init__(
        self,
        mesh: CastingMesh,
        curves: Mapping[str, FreezingCurve],
        followed: Followed = AS_USUAL,
    ) -> None:
        self._mesh = mesh
        axisymmetric = mesh.model == "axisymmetric"
        self._bodies = {
            name: BodySolidification(mesh.bodies[name], curve, axisymmetric, followed)
            for name, curve in curves.items()
        }

    def update(self, snapshot: Snapshot) -> None:
        """Take over the state after an accepted step; collective."""
        for name, body in self._bodies.items():
            if name in snapshot.mesh.bodies:
                body.update(snapshot, name)

    def saved(self) -> dict[str, Saved]:
        """Return the state of all bodies; collective."""
        return saved_parts(self._bodies)

    def restore(self, arrays: Arrays) -> None:
        """Restore the state of each body; one that was not followed begins now."""
        for name, body in self._bodies.items():
            if part := part_of(arrays, name):
                body.restore(part)

    def of(self, body: str) -> BodySolidification | None:
        """Return the solidification of a body, None of one that does not melt."""
        return self._bodies.get(body)

    def nowhere(self, body: str) -> FloatArray:
        """Return not a number at the nodes of a body, ghosts included: (nodes,)."""
        index_map = self._mesh.bodies[body].nodes.dofmap.index_map
        return np.full(index_map.size_local + index_map.num_ghosts, np.nan)

    def nowhere_in_cells(self, body: str) -> FloatArray:
        """Return not a number in the cells of a body, ghosts included: (cells,)."""
        return np.full(len(self._mesh.bodies[body].nodes.dofmap.list), np.nan)

    def nodal(self, body: str, quantity: str) -> FloatArray:
        """Return a quantity of `QUANTITIES` at nodes of a body with ghosts: (nodes,); collective.

        Not a number where it does not exist yet, and everywhere in a body that does not melt.
        """
        if body not in self._bodies:
            return self.nowhere(body)
        values: FloatArray = getattr(self._bodies[body], quantity)()
        return values
