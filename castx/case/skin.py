"""Thickness of the frozen skin that carries a gap, and the size of cells that resolves it.

A gap counts as soon as it takes half of the heat flow, at a width g_c that follows from the law of
the interface. A casting of modulus M = V/A, radius R = 2M, opens that far when its surface has
cooled by g_c/(α R) below the solidus, of an alloy by what lies between coherency and solidus
besides. While that happens the flow is about q = h (T_solidus − T_mould), so that the cold skin is

    δ = k (g_c/(α R) + T_coherent − T_solidus)/q, at most M,

thick. Cells of the size a at the interface err about in proportion to a/δ. Measured in two
dimensions with equal steps, against cells of 0.3 to 0.6 mm:

- a cylinder R30 of AlSi7Mg, h = 2300 W/m²/K, in steel (δ = 12 mm) has a gap at 30 s that is 10, 5
  and 2 % narrower with cells of 5, 2.5 and 1.25 mm, and a freezing time 3, 1 and 3 % off; with
  steps up to 2 s cells of 2.5 and 1.2 mm have a gap 11 and 3 % narrower, and freeze 1 and 0 %
  earlier;
- the same of pure aluminium (δ = 12 mm) has a gap 4 and 1 % off with cells of 5 and 2.5 mm, 3 % at
  10 s, and a freezing time 1 % off;
- the same of G20Mn5, h = 1000 W/m²/K, in copper (δ = 6.5 mm) has a gap 9 and 2 % narrower, 5 % off
  at 10 s with 2.5 mm;
- a plate of 20 × 60 mm of pure aluminium, h = 4000 W/m²/K, in steel (δ = 6.5 mm) has a gap at 10 s
  that is 14, 6 and 2 % narrower with cells of 5, 2.5 and 1.25 mm;
- a cylinder R18 × 30 mm of ZnAl4Cu1, h = 4000 W/m²/K, in a steel cup (δ = 2.3 mm), in default
  steps, freezes 33 and 17 % too early with cells of 3 and 1.5 mm, and its gap at 30 s is 28 %
  narrower with 3 mm.

`GAP_ERROR` and `TIME_ERROR` bound these numbers; in the moment in which a gap opens errors are
larger.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, floor, log, log10

import numpy as np

from castx.arrays import FloatArray
from castx.case.bodies import Body
from castx.case.case import Case
from castx.case.geometry import AUTO
from castx.case.interfaces import Interface
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.transfer.conductance import Faces
from castx.transfer.pair_state import PairState

GAP_ERROR = 0.25
"""Largest error of an early gap once it is wide, over size of the cells/δ."""
TIME_ERROR = 0.3
"""Largest error of the freezing time, over size of the cells/δ."""
CELLS = 10.0
"""Cells of the proposed size across δ: 2.5 % of the gap, 3 % of the freezing time."""
MOST_GROWTH = {2: 6.0, 3: 2.0}
"""Bound of the growth of the number of cells by a size that castx chooses, by dimension."""
_GAPS = np.geomspace(1e-7, 1e-2, 501)


@dataclass(frozen=True)
class Skin:
    """The skin of a casting that carries the gap of an interface.

    Attributes:
        interface: its name.
        casting: the body that freezes there.
        thickness: δ [m].
    """

    interface: str
    casting: str
    thickness: float

    @property
    def proposal(self) -> float:
        """Size of cells at the interface that resolves the skin, with two digits [m]."""
        return float(f"{self.thickness / CELLS:.2g}")

    def error(self, size: float) -> float:
        """Return the share by which the freezing time may be off by cells of a size [m]."""
        return TIME_ERROR * size / self.thickness

    def text(self, size: float) -> str:
        """Return the error by cells of a size at the interface, and the size proposed.

        Args:
            size: of the cells of the casting at the interface, across it [m].
        """
        skin = (
            f"interface {self.interface}: cells of {millimetres(size)} in the skin of "
            f"{self.casting}, {millimetres(self.thickness)} thick, that would carry a gap"
        )
        if size <= 1.1 * self.proposal:
            return f"{skin}: fine enough, early gaps within {percent(self._gap_error(size))}"
        return (
            f"{skin}: early gaps up to {percent(self._gap_error(size))} off, freezing time up to "
            f"{percent(self.error(size))} (estimates); interface_size = "
            f'"{millimetres(self.proposal)}" would reduce this to '
            f"{percent(self._gap_error(self.proposal))} and "
            f"{percent(self.error(self.proposal))}"
        )

    def _gap_error(self, size: float) -> float:
        return GAP_ERROR * size / self.thickness


def skins(case: Case, moduli: Mapping[str, float]) -> list[Skin]:
    """Return the skins at the interfaces whose gap matters and can be foreseen.

    Args:
        case: the case.
        moduli: volume over surface of its bodies [m].
    """
    if case.coupling.scheme == "thermal":
        return []
    bodies = {body.name: body for body in case.bodies}
    found = []
    for interface in case.interfaces:
        for casting, mould in (interface.bodies, interface.bodies[::-1]):
            thickness = _thickness(
                case, interface, bodies[casting], bodies[mould], moduli.get(casting)
            )
            if thickness is not None:
                found.append(Skin(interface.name, casting, thickness))
    return found


def millimetres(length: float) -> str:
    """Return a length [m] in words."""
    return f"{1e3 * length:.2g} mm"


def percent(share: float) -> str:
    """Return a share of one at most in words."""
    return f"{100.0 * min(share, 1.0):.0f} %"


def _thickness(
    case: Case, interface: Interface, casting: Body, mould: Body, modulus: float | None
) -> float | None:
    """Return δ of a casting in a mould [m]; None where there is none or data are missing."""
    material = find_material(casting.material, case.materials)
    solidus, bounds = material.solidus, mould.temperature.bounds
    data = material.description
    if modulus is None or solidus is None or bounds is None or not casting.is_poured(material):
        return None
    if casting.law == "rigid" or data.expansion is None or data.conductivity is None:
        return None
    cold = 0.5 * sum(bounds)
    conductance, gap = closing(interface, solidus, cold)
    contraction = float(data.expansion(solidus)) * 2.0 * modulus
    if gap is None or contraction <= 0.0 or cold >= solidus:
        return None
    cooling = gap / contraction + _coherent(material) - solidus
    flow = conductance * (solidus - cold)
    return min(modulus, float(data.conductivity.solid(solidus)) * cooling / flow)


def closing(interface: Interface, hot: float, cold: float) -> tuple[float, float | None]:
    """Return the coefficient of touching surfaces [W/m²/K] and the gap that halves it [m].

    The gap is None where the law knows none, or no coefficient.
    """
    heat = interface.heat
    if heat is None or not heat.declared.follows_gap:
        return 0.0, None
    gaps = np.concatenate([[0.0], _GAPS])
    faces = Faces.at_temperatures(np.full(len(gaps), hot), np.full(len(gaps), cold), 0.0, 0.0)
    found = heat.conduction_law()(PairState.of(gaps, np.zeros(len(gaps))), faces)
    values = np.asarray(found.coefficient.value)
    half = np.flatnonzero(values <= 0.5 * values[0])
    return float(values[0]), float(gaps[half[0]]) if half.size and values[0] > 0.0 else None


def _coherent(material: Material) -> float:
    """Return the temperature at which a freezing metal begins to bear [°C]."""
    solidus, liquidus, liquid = material.solidus, material.liquidus, material.liquid
    assert solidus is not None and liquidus is not None and liquid is not None
    if material.is_isothermal:
        return solidus
    temperatures: FloatArray = np.linspace(solidus, liquidus, 1001, dtype=np.float64)
    bears = material.solid_fraction_at(temperatures) >= liquid.coherency
    return float(temperatures[bears].max(initial=solidus))


def interface_size(case: Case) -> float | None:
    """Return the size of the cells at the interface that castx chooses for a generated mesh [m].

    It is the finest proposal, but no finer than `MOST_GROWTH` allows and no coarser than the other
    cells; None: these will do, or nothing is known of the skin.
    """
    size = float(case.geometry.arguments["size"])
    proposals = [skin.proposal for skin in skins(case, case.geometry.moduli)]
    wanted = max(min(proposals, default=size), finest(size, case.geometry.gdim))
    return wanted if wanted < size else None


def chosen_text(case: Case) -> str | None:
    """Return the size that castx has found for the cells at interfaces; None: it was not asked."""
    geometry = case.content.get("geometry", {})
    if geometry.get("interface_size") != AUTO:
        return None
    size = case.geometry.arguments.get("interface_size")
    if size is None:
        return 'interface_size = "auto": no finer cells at the interfaces'
    return f'interface_size = "auto": cells of {millimetres(size)} at the interfaces'


def finest(size: float, dimension: int) -> float:
    """Return the size at an interface with which the cells become about as many as is allowed [m].

    Sizes that grow evenly from a to b make ln(b/a)/(1 − a/b) times as many cells in each direction
    in which they do; here in all of them.

    Args:
        size: of the other cells [m].
        dimension: of the mesh.
    """
    allowed = MOST_GROWTH[dimension] ** (1.0 / dimension)

    from scipy.optimize import brentq  # few cases need it, and it takes long to import

    def excess(ratio: float) -> float:
        return float(-log(ratio) / (1.0 - ratio) - allowed)

    ratio = float(brentq(excess, 1e-3, 1.0 - 1e-9))
    digit = 10.0 ** (floor(log10(size * ratio)) - 1)
    return float(f"{digit * ceil(size * ratio / digit):.2g}")
