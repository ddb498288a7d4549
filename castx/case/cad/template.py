"""A first case file for a CAD part, with its choices left to the reader."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from castx.case.cad.holds import frame_text, held_bodies
from castx.input.units import plain_text
from castx.materials.granular import GRANULAR

Box = tuple[Sequence[float], Sequence[float]]
CASTING, CHILL, MOULD, SAND = range(4)
PLUG = "mould-plug"
"""Name of what hangs at no outer part of a mould that is made."""
MADE = ("mould", "mould-low", "mould-high", PLUG)
"""Names of a mould that is made, or of its halves and its plug."""
_TOLD = {CASTING: "cast", CHILL: "a chill", MOULD: "of the mould", SAND: "a core"}
SHORTEST, LONGEST = 2e-3, 20.0
"""Extents of castings [m]; what is beyond may be in another unit than its file says."""
BARE = 0.5
"""Share of the surface of a casting beyond which nothing seems to surround it."""
_WORDS = {
    CHILL: ("chill", "cooler"),
    SAND: ("core", "sand"),
    MOULD: ("mould", "mold", "die", "cope", "drag", "half", "upper", "lower", "ring", "plate"),
}
_MATERIAL = {
    CASTING: ("AlSi7Mg", 700, "thermo-elasto-viscoplastic"),
    CHILL: ("Cu-pure", 20, "thermo-elastic"),
    MOULD: ("steel-H13", 200, "thermo-elastic"),
    SAND: ("sand-silica", 20, GRANULAR),
}


@dataclass(frozen=True)
class NewCase:
    """Properties of a CAD part, known before the user makes any choice.

    Args:
        file: of the part, as the case file names it.
        size: of the cells [m].
        margin: of a mould that is to be made round it [m]; None: there is one.
        mould: text of such a mould instead, as a case file has it; None: a block by the margin.
        bodies: names and volumes [m³].
        interfaces: pairs of bodies with areas [m²].
        surfaces: free ones as "body/surface", with areas [m²].
        across: cells across walls with which it could be meshed.
        interface_size: of the cells on faces that bodies share [m]; None: as elsewhere.
        tolerance: up to which faces are removed and gaps closed [m]; None: as usual.
        narrowest: width of the narrowest faces that are left in [m]; None: all are.
        growth: of the sizes of cells over a distance; None: as usual.
        boxes: lowest and highest corner of each solid [m].
    """

    file: str
    size: float
    margin: float | None
    bodies: tuple[tuple[str, float], ...]
    interfaces: tuple[tuple[str, str, float], ...]
    surfaces: tuple[tuple[str, float], ...]
    across: int = 1
    interface_size: float | None = None
    mould: str | None = None
    tolerance: float | None = None
    narrowest: float | None = None
    growth: float | None = None
    boxes: Mapping[str, Box] = field(default_factory=dict)

    @property
    def drawn(self) -> tuple[str, ...]:
        """Names of the solids of the file: the bodies without the halves of a mould made here."""
        made = () if self.margin is None else MADE
        return tuple(name for name, _ in self.bodies if name not in made)

    @property
    def roles(self) -> dict[str, int]:
        """Role of each body by its name; in a mould that is made, what is not cast is a core."""
        rest = MOULD if self.margin is None else SAND
        return roles([name for name, _ in self.bodies], rest)

    @property
    def castings(self) -> tuple[str, ...]:
        """Names of the bodies that are cast."""
        role = self.roles
        return tuple(name for name, _ in self.bodies if role[name] == CASTING)

    @property
    def held(self) -> tuple[str, ...]:
        """Bodies that need a frame, see `castx.case.cad.holds`."""
        role = self.roles
        return held_bodies(
            {name: volume for name, volume in self.bodies if role[name] != CASTING},
            [(first, second) for first, second, _ in self.interfaces],
            {on.partition("/")[0] for on, _ in self.surfaces},
        )

    def taken_for(self) -> Iterator[str]:
        """Yield the role of each solid of an assembly in words, and castings that lie bare."""
        if len(self.drawn) == 1 and self.margin is not None:
            return
        role = self.roles
        told = (f"{name}: {_TOLD[role[name]]}" for name in self.drawn)
        yield (
            f"by their names and their order, {', '.join(told)}; name them in CAD (core, chill, "
            "mould), or change [[bodies]] and [[interfaces]], if that is wrong"
        )
        for name in self.bare() if self.margin is None else ():
            yield (
                f"{100.0 * self._bare(name):.0f} % of the surface of {name} is bare: the mould of "
                "the file is not round it; give castx new the casting without it, which gets a "
                "block, or draw the mould whole"
            )

    def bare(self) -> tuple[str, ...]:
        """Return the castings that nothing surrounds."""
        return tuple(name for name in self.castings if self._bare(name) > BARE)

    def _bare(self, name: str) -> float:
        """Return the share of the surface of a body that is free."""
        free = sum(area for on, area in self.surfaces if on.partition("/")[0] == name)
        return free * self.modulus(name) / dict(self.bodies)[name]

    @property
    def has_mould(self) -> bool:
        """Whether a label says that a solid is part of a mould."""
        return any(w in name.lower() for name, _ in self.bodies for w in _WORDS[MOULD])

    def dimensions(self, density: float) -> Iterator[str]:
        """Yield extents, volume, mass, modulus and mean wall of each casting in words.

        One that is larger or smaller than any is doubted.

        Args:
            density: of the alloy [kg/m³].
        """
        for name in self.castings:
            yield f"{name}: {', '.join(self._sizes(name, dict(self.bodies)[name], density))}"
            low, high = self.boxes.get(name, ((), ()))
            longest = max((b - a for a, b in zip(low, high, strict=True)), default=SHORTEST)
            if not SHORTEST <= longest <= LONGEST:
                yield (
                    f"{name} is {longest:.2g} m long, as no casting is: does {self.file} say the "
                    "unit in which it was drawn? If not, export it again"
                )

    def _sizes(self, name: str, volume: float, density: float) -> Iterator[str]:
        if name in self.boxes:
            low, high = self.boxes[name]
            extents = (f"{round(1e3 * (b - a), 1):g}" for a, b in zip(low, high, strict=True))
            yield " × ".join(extents) + " mm"
        modulus = self.modulus(name)
        mass = density * volume
        yield f"{plain_text(1e6 * volume)} cm³"
        yield f"{plain_text(mass, 3)} kg" if mass >= 1.0 else f"{1e3 * mass:.3g} g"
        thick = plain_text(2e3 * modulus, 2)
        yield f"modulus {plain_text(1e3 * modulus, 2)} mm, walls of {thick} mm in the mean"

    def modulus(self, body: str) -> float:
        """Return volume over surface of a body [m]."""
        touching = sum(area for a, b, area in self.interfaces if body in (a, b))
        free = sum(area for on, area in self.surfaces if on.partition("/")[0] == body)
        return dict(self.bodies)[body] / (touching + free)


def roles(names: Sequence[str], rest: int = MOULD) -> dict[str, int]:
    """Return the role of each body guessed from its name: casting, chill, mould or sand.

    The first body without a telling name is the casting, unless the name of one says that it is a
    casting or part of one.

    Args:
        names: of the bodies.
        rest: role of others without a telling name.
    """
    found = {}
    for name in names:
        known = [role for role, words in _WORDS.items() if any(w in name.lower() for w in words)]
        if known:
            found[name] = known[0]
    castings = [n for n in names if any(w in n.lower() for w in ("cast", "feeder", "gat", "part"))]
    castings = [n for n in castings if n not in found]
    others = [name for name in names if name not in found]
    castings = castings or others[:1] or [names[0]]
    return {n: CASTING if n in castings else found.get(n, rest) for n in names}


def case_text(case: NewCase) -> str:
    """Return the case file."""
    role = case.roles
    parts = [HEAD + geometry_text(case), *(_body(name, v, role[name]) for name, v in case.bodies)]
    parts += [_interface(a, b, area, role) for a, b, area in case.interfaces]
    parts += [_boundary(on, area) + _frame(case, on) for on, area in case.surfaces]
    parts.append('[time]\nend = "60 s"\n')
    return "\n".join(parts)


HEAD = (
    "# Lengths are in metres, temperatures in °C, or carry a unit. Choose what is marked with\n"
    "# CHOOSE, then: castx check, castx run, castx report.\n\n"
)


def geometry_text(case: NewCase) -> str:
    """Return the geometry of a case file."""
    text = (
        f'[geometry]\nmodel = "3d"\nfile = {json.dumps(case.file, ensure_ascii=False)}\n'
        f'size = "{1e3 * case.size:.3g} mm"                 # CHOOSE: largest cells\n'
        f"across = {case.across}                      # CHOOSE: cells across walls; 2 and more for "
        "results\n"
        "curvature = 8                   # CHOOSE: cells round a full circle\n"
        '# surfaces = { top = { normal = "+z" } }          # free faces by words; others: outside\n'
    )
    if case.interface_size is not None:
        text += (
            f'interface_size = "{1e3 * case.interface_size:.3g} mm"       # CHOOSE: cells in the '
            "skin that carries a gap; castx check says what they change\n"
        )
    if case.growth is not None:
        text += (
            f"growth = {case.growth:g}                      # CHOOSE: of cells away from walls and "
            "faces; 0.4 has finer ones in the mould\n"
        )
    if case.tolerance is not None:
        text += (
            f'tolerance = "{1e3 * case.tolerance:g} mm"           # CHOOSE: narrower faces are '
            "removed, gaps between solids closed\n"
        )
    if case.narrowest is not None:
        text += (
            f'narrowest = "{1e3 * case.narrowest:g} mm"             # CHOOSE: grooves, threads and '
            "roundings of narrower faces are left out\n"
        )
    if case.mould is not None:
        text += case.mould
    elif case.margin is not None:
        text += f'mould = {{ box = "{1e3 * case.margin:.3g} mm" }}      # a block round the part\n'
    return text


def _body(name: str, volume: float, role: int) -> str:
    material, temperature, law = _MATERIAL[role]
    return (
        f'[[bodies]]                      # {plain_text(1e6 * volume)} cm³\nname = "{name}"\n'
        f'material = "{material}"          # CHOOSE: castx materials\n'
        f"temperature = {temperature}               # CHOOSE: at the start\n"
        f'law = "{law}"\n'
    )


def _interface(first: str, second: str, area: float, role: dict[str, int]) -> str:
    first, second = sorted((first, second), key=lambda name: role[name])
    contact = ""
    if CASTING not in (role[first], role[second]):
        # Where parts of a tool slide freely on each other, nothing holds some of them.
        contact = 'contact = { method = "tied" }      # CHOOSE: parts of one clamped tool\n'
    return (
        f"[[interfaces]]                  # {plain_text(1e4 * area)} cm²\n"
        f'bodies = ["{first}", "{second}"]\n{contact}'
        'heat = { law = "limited", closed = 2000, gas_conductivity = 0.05 }     # CHOOSE\n'
    )


def _frame(case: NewCase, on: str) -> str:
    """Return the condition that holds the body of a surface, if it needs one."""
    name = on.partition("/")[0]
    if name not in case.held:
        return ""
    material, temperature, _ = _MATERIAL[case.roles[name]]
    return frame_text(material, temperature, dict(case.bodies)[name])


def _boundary(on: str, area: float) -> str:
    return (
        f'[[boundaries]]                  # {plain_text(1e4 * area)} cm²\non = "{on}"\n'
        'heat = { type = "convection", coefficient = 10, ambient = 20 }         # CHOOSE\n'
    )
