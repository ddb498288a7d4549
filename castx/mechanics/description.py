"""Description of a body for the mechanics: law, formulation and loads."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

from castx.errors import CaseError
from castx.input.placed import Placed
from castx.mechanics.clamp import SurfaceClamp
from castx.mechanics.constitutive.law import Law
from castx.mechanics.mush.metal import MushMetal
from castx.tables import Table


@dataclass(frozen=True)
class SurfaceLoad:
    """A load on a named surface: a pressure that pushes on it, or a traction.

    Attributes:
        surface: name of the surface.
        pressure: over time, or place and time [Pa], positive against the outward normal.
        traction: components likewise [Pa].
    """

    surface: str
    pressure: Table | Placed | None = None
    traction: tuple[Table | Placed, ...] | None = None


@dataclass(frozen=True)
class MechanicalBody:
    """Law, formulation and loads of a body.

    Attributes:
        law: constitutive law with its material.
        formulation: "mixed", "displacement", "q1p0" or "taylor-hood".
        stabilisation: "osgs" or "gls"; acts in the mixed formulation.
        body_force: force per volume [N/m³], one number for each direction, or a UFL vector as a
            function of the position.
        loads: loads on surfaces.
        starts_liquid: whether the body has no solid at the start.
        closed: names of the surfaces through which no liquid can follow.
        clamps: machines that press on surfaces.
        mush: its melt, which flows through its mush; None: trapped liquid is found by pockets.
    """

    law: Law
    formulation: str = "mixed"
    stabilisation: str = "osgs"
    body_force: Sequence[float] | Callable[[Any], Any] = ()
    loads: Sequence[SurfaceLoad] = field(default_factory=tuple)
    starts_liquid: bool = False
    closed: Collection[str] = ()
    clamps: Sequence[SurfaceClamp] = ()
    mush: MushMetal | None = None

    def __post_init__(self) -> None:
        if self.law.is_granular and self.formulation != "displacement":
            raise CaseError(
                f"the law {self.law.name!r} has no formulation {self.formulation!r}: grains yield "
                'by the mean stress of their strain; use "displacement"'
            )
