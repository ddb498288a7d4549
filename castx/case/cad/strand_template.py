"""A first case file for a strand that is cast continuously: a slice that travels with it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from castx.case.cad.mould import AXES
from castx.case.cad.process_template import bare_metal, listed, outside_heat, process_head
from castx.case.cad.template import Box, NewCase
from castx.case.processes.strand import SPRAYED, StrandPlan, StrandSection, Zone

CUT = "cut"
"""Name of the face at which a slice is cut out of its strand."""

FIELDS = (
    "temperature", "solid_fraction", "displacement", "von_mises", "gap", "solidification_time",
    "passing_times",
)  # fmt: skip
"""That are written: the usual ones, and when solid fractions pass."""
PASSING = (0.7, 1.0)
"""Solid fractions whose passing is written: the usual end of the shell, and the end of the pool."""


@dataclass(frozen=True)
class Slice:
    """A slice of a strand in its mould, as it is meshed.

    Attributes:
        case: bodies, interfaces and surfaces.
        section: of the whole strand.
        block: lowest and highest corner of the mould [m].
        planes: axis and place of planes of symmetry [m], and whether what is above stays; the first
            one is that of the slice.
        quarter: whether the others are the middle planes of the section.
        places: of probes: "core", "edge", and the walls "face-x", ... [m].
    """

    case: NewCase
    section: StrandSection
    block: Box
    planes: tuple[tuple[int, float, bool], ...]
    quarter: bool
    places: Mapping[str, Sequence[float]]

    @property
    def thickness(self) -> float:
        """Of the slice, from its lower end at that of the mould [m]."""
        axis, place, _ = self.planes[0]
        return place - self.block[0][axis]

    @property
    def strand(self) -> str:
        """Name of the strand."""
        return self.case.castings[0]

    @property
    def mould(self) -> str:
        """Name of the mould."""
        return next(name for name, _ in self.case.bodies if name != self.strand)

    @property
    def wide_face(self) -> tuple[int, float, bool]:
        """Axis and place of the wide face of a quarter [m], and whether the quarter is below it."""
        axis = self.section.across[int(np.argmin(self.section.extents))]
        middle, above = next((at, above) for number, at, above in self.planes if number == axis)
        half = 0.5 * self.section.thickness
        return axis, middle + half if above else middle - half, above

    def dimensions(self, plan: StrandPlan, density: float) -> Iterator[str]:
        """Yield the strand, its speed and its times in words.

        Args:
            plan: of the strand.
            density: of the alloy [kg/m³].
        """
        section, speed = self.section, plan.speed
        extents = " × ".join(f"{1e3 * extent:.4g}" for extent in section.extents)
        yield (
            f"{self.strand}: a strand of {extents} mm along {AXES[section.axis]}, "
            f"{1e4 * section.area:.4g} cm², {density * section.area:.3g} kg/m"
        )
        yield (
            f"{60.0 * speed:.2g} m/min: {plan.plan.release:g} s in the mould, sprays to "
            f"{plan.air:g} s and {plan.air * speed:.2g} m, solid after some "
            f"{plan.plan.freezing:g} s and {plan.plan.freezing * speed:.2g} m"
        )
        if not self.quarter:
            yield "its quarters are not alike, so that all of the section is meshed"


@dataclass(frozen=True)
class MouldWalls:
    """The bodies of a mould: one, or those of narrow and wide face, of which rolls hold the latter.

    Attributes:
        names: of the bodies.
        held: name of that at the wide face; None: no rolls hold a face.
        face: name of the probe at the wide face.
        split: key of the mould that divides it.
    """

    names: tuple[str, ...]
    held: str | None = None
    face: str = ""
    split: str = ""

    @classmethod
    def of(cls, cut: Slice, strand: StrandPlan) -> MouldWalls:
        """Return the walls that a slice needs: rolls hold a face of a quarter, which has one."""
        if strand.rolls_end is None or not cut.quarter:
            return cls((cut.mould,))
        axis, place, below = cut.wide_face
        names = f"{cut.mould}-low", f"{cut.mould}-high"
        split = f', split = "{AXES[axis]} = {1e3 * place:.6g} mm"'
        return cls(names, names[int(below)], f"face-{AXES[axis]}", split)

    def at(self, probe: str) -> str:
        """Return the body at a probe, named as in `Slice.places`."""
        return next(name for name in self.names if (name == self.held) == (probe == self.face))


def strand_text(cut: Slice, strand: StrandPlan) -> str:
    """Return the case file of a slice of a strand.

    Args:
        cut: the slice.
        strand: numbers of the process.
    """
    walls = MouldWalls.of(cut, strand)
    parts = [
        _head(strand), _geometry(cut, walls), *_bodies(cut, strand, walls),
        *_interfaces(cut, strand, walls), *_boundaries(cut, strand, walls),
        *_stages(cut, strand, walls), *_probes(cut, walls), _end(strand),
    ]  # fmt: skip
    return "\n".join(parts)


def _head(strand: StrandPlan) -> str:
    speed = strand.speed
    return process_head(
        strand.plan.process,
        f"# Distances along the strand are {60.0 * speed:.3g} m/min times the time, from the "
        f"meniscus: {speed:.4g} m/s. No",
        "# heat flows along it, flat cuts stay flat, and the melt has the pressure of the pool.",
        "# Shell, pool and gaps along the strand: docs/manual/continuous.md.",
    )


def _geometry(cut: Slice, walls: MouldWalls) -> str:
    case, axis = cut.case, cut.section.axis
    corners = ", ".join(f"[{', '.join(f'{x:.7g}' for x in corner)}]" for corner in cut.block)
    planes = ", ".join(
        f'"{AXES[number]} {">" if above else "<"} {1e3 * place:.6g} mm"'
        for number, place, above in cut.planes
    )
    said = "the slice, one cell thick"
    said += ", and a quarter of it" if cut.quarter else "; a symmetric one takes more planes"
    return (
        f'[geometry]\nmodel = "3d"\nfile = {json.dumps(case.file, ensure_ascii=False)}\n'
        f'size = "{1e3 * case.size:.3g} mm"                 # CHOOSE: largest cells, in the core\n'
        f'interface_size = "{1e3 * cut.thickness:.3g} mm"       # CHOOSE: cells of the shell\n'
        "across = 0                      # one cell along the strand\n"
        "curvature = 8                   # CHOOSE: cells round a full circle\n"
        f"growth = {case.growth or 0.4:g}                    # CHOOSE: of cells towards the core\n"
        f"mould = {{ box = [{corners}]{walls.split} }}      # a tube round the strand\n"
        f"symmetry = [{planes}]      # {said}\n"
        f'surfaces = {{ {CUT} = {{ normal = "-{AXES[axis]}" }} }}\n'
    )


def _bodies(cut: Slice, strand: StrandPlan, walls: MouldWalls) -> Iterator[str]:
    plan = strand.plan
    yield (
        f'[[bodies]]\nname = "{cut.strand}"\nmaterial = "{plan.alloy}"\n'
        f'temperature = {plan.pouring:g}\nlaw = "thermo-elasto-viscoplastic"\n'
        'feeding = "darcy"               # melt comes along the strand, and has the pressure of '
        "its pool\n"
    )
    for wall in walls.names:
        yield (
            f'[[bodies]]\nname = "{wall}"\nmaterial = "{plan.mould}"\n'
            f"temperature = {plan.process.numbers['mould_temperature']:g}\n"
            f'law = "{plan.mould_law}"                   # its walls move by the taper alone\n'
        )


def _interfaces(cut: Slice, strand: StrandPlan, walls: MouldWalls) -> Iterator[str]:
    entry = strand.plan.interface
    for wall in walls.names:
        yield (
            f'[[interfaces]]\nbodies = ["{cut.strand}", "{wall}"]\n'
            f'heat = {{ from = "{entry}" }}     # castx interfaces {entry}\n'
        )


def _boundaries(cut: Slice, strand: StrandPlan, walls: MouldWalls) -> Iterator[str]:
    pressure = ", ".join(f"[{time:g}, {value:g}]" for time, value in strand.pressure)
    borne = "; rolls bear it below the mould" if strand.rolls_end else ""
    yield (
        f'[[boundaries]]\non = "{cut.strand}/{CUT}"\n'
        'displacement = { normal = "uniform" }     # the strand is free to shorten\n'
        f"pressure = [{pressure}]     # of the pool, by its height{borne}\n"
    )
    yield (
        f'[foundry]\nfeeders = ["{cut.strand}/{CUT}"]\n'
        f"passing_times = {json.dumps(PASSING)}         # of solid, as far from the meniscus as "
        "the strand then is\n"
    )
    for wall in walls.names:
        yield (
            f'[[boundaries]]\non = "{wall}/outside"\n'
            f"heat = {outside_heat(strand.plan.process.numbers)}\n{_taper(cut, strand)}"
        )


def _taper(cut: Slice, strand: StrandPlan) -> str:
    """Return the motion of the walls in a quarter, in which a rigid one can make it."""
    if not cut.quarter:
        return "# No taper: walls on all sides cannot move inwards as one rigid body.\n"
    rows = [
        f"{AXES[axis]} = [[0, 0], [{strand.plan.release:g}, {-strand.taper * extent:.3g}]]"
        for axis, extent in zip(cut.section.across, cut.section.extents, strict=True)
    ]
    return (
        f"displacement = {{ {', '.join(rows)} }}     # taper of each wall, in metres over the "
        "time in the mould\n"
    )


def _stages(cut: Slice, strand: StrandPlan, walls: MouldWalls) -> Iterator[str]:
    numbers, interface = strand.plan.process.numbers, strand.plan.interface
    for zone in strand.zones:
        table = ", ".join(
            f"[{at:g}, {h:g}]" for at, h in zip(SPRAYED, zone.coefficients, strict=True)
        )
        heat = (
            '{ type = "convection", coefficient = { over = "temperature", of = "surface", '
            f"table = [{table}] }}, ambient = {numbers['ambient']:g} }}"
        )
        begins = _began(zone.start, strand.speed, _water(zone))
        if zone is strand.zones[0]:
            begins += f"remove = {json.dumps(walls.names)}\n{_rolls_begin(cut, strand, walls)}"
        yield begins + _cooled(cut, walls, [heat])
    in_air = _cooled(cut, walls, bare_metal(interface, numbers["air_coefficient"]))
    yield _began(strand.air, strand.speed, "air") + in_air
    if strand.rolls_end is not None and walls.held is not None:
        ends = _began(strand.rolls_end, strand.speed, "no more rolls, by estimate behind the pool")
        yield ends + _held(cut, walls, '"free"')


def _rolls_begin(cut: Slice, strand: StrandPlan, walls: MouldWalls) -> str:
    """Return the boundaries by which rolls bear the pressure of the pool and hold a face."""
    if strand.rolls_end is None:
        return ""
    borne = f'[[stages.boundaries]]\non = "{cut.strand}/{CUT}"\npressure = 0\n'
    if walls.held is None:
        return f"# No rolls hold a face: this section has no quarter with one.\n{borne}"
    return borne + _held(cut, walls, '{ normal = "uniform" }     # rolls keep the wide face flat')


def _held(cut: Slice, walls: MouldWalls, how: str) -> str:
    return f'[[stages.boundaries]]\non = "{cut.strand}/{walls.held}"\ndisplacement = {how}\n'


def _cooled(cut: Slice, walls: MouldWalls, heat: Sequence[str]) -> str:
    """Return heat conditions of all that the mould has left bare."""
    return "".join(
        f'[[stages.boundaries]]\non = "{cut.strand}/{wall}"\nheat = [\n{listed(heat)}]\n'
        for wall in walls.names
    )


def _water(zone: Zone) -> str:
    return (
        f"{zone.name} zone, {zone.water:g} L/m²/s: Sasaki and others, Tetsu-to-Hagané 65 (1979) "
        "90, radiation included"
    )


def _began(at: float, speed: float, what: str) -> str:
    return (
        f'[[stages]]                      # from {at * speed:.3g} m on: {what}\nat = "{at:g} s"\n'
    )


def _probes(cut: Slice, walls: MouldWalls) -> Iterator[str]:
    """Yield probes of the core, and of surface and gap at walls and at an edge."""
    for name, place in cut.places.items():
        if name == "core":
            inside = ["temperature", "solid_fraction"]
            yield _probe(name, f'body = "{cut.strand}"', place, inside)
            continue
        interface = f"{cut.strand}/{walls.at(name)}"
        surface = f'body = "{cut.strand}"\nbelow = "{interface}"'
        yield _probe(name, surface, place, ["temperature"])
        across = ["gap", "heat_transfer_coefficient"]
        yield _probe(f"gap-{name}", f'interface = "{interface}"', place, across)


def _probe(name: str, of: str, place: Sequence[float], quantities: Sequence[str]) -> str:
    at = ", ".join(f"{x:.6g}" for x in place)
    return (
        f'[[probes]]\nname = "{name}"\n{of}\nat = [{at}]\nquantities = {json.dumps(quantities)}\n'
    )


def _end(strand: StrandPlan) -> str:
    end = strand.plan.end
    return (
        f"[output]\nfields = {json.dumps(FIELDS)}\n\n"
        f'[time]\nend = "{end:g} s"                   # {end * strand.speed:.3g} m: until it is '
        "solid, by estimate; later until it is cold\n"
    )
