"""Bodies whose melt flows through the mush: their metal for the mechanics."""

from __future__ import annotations

from castx.case.bodies import Body
from castx.case.case import Case
from castx.errors import CaseError
from castx.foundry.alloy import FEEDING, Alloy, missing
from castx.materials.material import Material
from castx.mechanics.mush.metal import MushMetal


def mush_metal(case: Case, body: Body, material: Material, formulation: str) -> MushMetal | None:
    """Return the melt of a body with `feeding = "darcy"`, and its feeders; None: of another one.

    Args:
        case: the case.
        body: one of its bodies.
        material: of the body, as the user gives it.
        formulation: of the body.

    Raises:
        CaseError: the elements of the body have no pressure at the nodes, or the material lacks a
            number.
    """
    if body.feeding != "darcy":
        return None
    if formulation != "mixed":
        raise CaseError(
            f"body {body.name!r} has feeding = 'darcy', which needs formulation 'mixed', a "
            f"pressure at the nodes, and has {formulation!r}; mesh it with triangles or "
            "tetrahedra, or leave feeding out"
        )
    lacking = missing(material.description, FEEDING)
    if lacking or material.liquidus is None:
        raise CaseError(
            f"body {body.name!r} has feeding = 'darcy', and its material {material.name!r} has no "
            f"{', '.join(lacking) or 'liquidus'}; add to [materials.{material.name}] of the case"
        )
    alloy = Alloy(material)
    melt, arms, feeders = alloy.melt(), alloy.spacing, case.foundry.feeders
    if feeders is not None:
        pairs = (on.split("/") for on in feeders)
        feeders = tuple(surface for name, surface in pairs if name == body.name)
    return MushMetal(
        melt.contraction,
        melt.viscosity,
        melt.cavitation,
        1.0 - alloy.cut_off,
        arms.coefficient,
        arms.exponent,
        material.liquidus,
        feeders,
    )
