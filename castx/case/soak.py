"""Depth to which a mould takes up the heat of freezing, and the size of cells that resolves it.

A casting of modulus M = V/A gives up H = M ΔH [J/m²] from its start to the solidus, which takes

    t = H/(h ΔT) + (π/4) (H/(b ΔT))²

with the coefficient h of the touching surfaces, the effusivity b of the mould, and the mean
difference ΔT of both: the second term is Chvorinov's, see `castx.foundry.modulus`. By then the
mould has taken H to the depth d = H/(ρc ΔT). Cells of the size a at the interface take it sooner,
as the whole of a cell warms with its surface, and the second term gets lost. Measured with plates
of GJL-250, M = 4.6 mm, in bonded silica sand (d = 6.7 mm), against cells of 0.5 mm, which freeze
after 130 s: squares of 17, 8 and 4 mm freeze 78 %, 13 % and 0 % too early, tetrahedra of 17, 10,
7 and 4 mm 53 %, 24 %, 5 % and 0 %. `CELL_ERROR` bounds that.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from castx.case.bodies import Body
from castx.case.case import Case
from castx.case.skin import closing, millimetres, percent
from castx.materials.lookup import find_material

CELL_ERROR = 0.15
"""Largest share of the second term that is lost, over (size of the cells/d)²."""
FINE = 0.6
"""Size over d that is proposed: 5 % of the freezing time."""
TOLD = 0.05
"""Error of the freezing time from which it is told."""


@dataclass(frozen=True)
class Soak:
    """Heat that a mould takes up at an interface while the casting freezes.

    Attributes:
        interface: its name.
        mould: the body that takes it.
        casting: the body that freezes.
        depth: d [m].
        share: of the freezing time that the mould makes, the second term over t.
    """

    interface: str
    mould: str
    casting: str
    depth: float
    share: float

    def error(self, size: float) -> float:
        """Return by which share a casting freezes too early, at most, by cells of a size [m]."""
        return self.share * min(CELL_ERROR * (size / self.depth) ** 2, 1.0)

    @property
    def untold(self) -> float:
        """Size of cells of the mould, across the interface, of which nothing is told [m]."""
        return float(self.depth * min(TOLD / (CELL_ERROR * self.share), 1.0) ** 0.5)

    def text(self, size: float) -> str | None:
        """Return the error by cells of the mould at the interface, and a size; None: it is small.

        Args:
            size: of the cells of the mould at the interface, across it [m].
        """
        if self.error(size) < TOLD:
            return None
        proposal = float(f"{FINE * self.depth:.2g}")
        return (
            f"interface {self.interface}: cells of {millimetres(size)} in {self.mould}, which "
            f"takes up the heat of freezing {millimetres(self.depth)} deep: {self.casting} freezes "
            f'up to {percent(self.error(size))} too early (estimate); interface_size = "'
            f'{millimetres(proposal)}" would reduce this to {percent(self.error(proposal))}'
        )


def soaks(case: Case, moduli: Mapping[str, float]) -> Iterator[Soak]:
    """Yield the heat that moulds take up at each interface whose law follows the gap.

    Args:
        case: the case.
        moduli: volume over surface of its bodies [m].
    """
    bodies = {body.name: body for body in case.bodies}
    for interface in case.interfaces:
        for name, other in (interface.bodies, interface.bodies[::-1]):
            casting, mould = bodies[name], bodies[other]
            found = _ends(case, casting, mould)
            if found is None or name not in moduli:
                continue
            heat, middle, cold = found
            around = find_material(mould.material, case.materials)
            conductance, gap = closing(interface, middle, cold)
            conductivity = around.description.conductivity
            if gap is None or conductivity is None or middle <= cold:
                continue
            low, high = around.enthalpy.enthalpy(np.array([cold, middle]))
            capacity = float(high - low) / (middle - cold)
            conducts = float(conductivity.solid(0.5 * (cold + middle)))
            depth = moduli[name] * heat / float(high - low)
            surface = moduli[name] * heat / (conductance * (middle - cold))
            inside = 0.25 * math.pi * depth**2 * capacity / conducts
            yield Soak(interface.name, other, name, depth, inside / (surface + inside))


def _ends(case: Case, casting: Body, mould: Body) -> tuple[float, float, float] | None:
    """Return the heat of freezing [J/m³], and the temperatures at which both meet [°C].

    None: nothing freezes, or no temperature is known.
    """
    metal = find_material(casting.material, case.materials)
    around = find_material(mould.material, case.materials)
    hot, cold = casting.temperature.bounds, mould.temperature.bounds
    if casting.starts_solid(metal.description) or not mould.starts_solid(around.description):
        return None
    if metal.solidus is None or metal.liquidus is None or hot is None or cold is None:
        return None
    before, after = metal.enthalpy.enthalpy(np.array([hot[1], metal.solidus]))
    return float(before - after), 0.5 * (metal.solidus + metal.liquidus), 0.5 * sum(cold)
