"""Bodies whose melt flows through the mush: their metal for the mechanics."""

from __future__ import annotations

from castx.case.bodies import DARCY, Body
from castx.case.case import Case
from castx.equilibrium.problem import MechanicalProblem
from castx.errors import CaseError
from castx.foundry.alloy import Alloy
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
        CaseError: the elements of the body have no pressure at the nodes, the material lacks a
            number, or it freezes at one temperature and has no mush.
    """
    if body.feeding != DARCY:
        return None
    if formulation != "mixed":
        raise CaseError(
            f"body {body.name!r} has feeding = 'darcy', which needs formulation 'mixed', a "
            f"pressure at the nodes, and has {formulation!r}; mesh it with triangles or "
            "tetrahedra, or leave feeding out"
        )
    alloy = Alloy(material)
    melt, arms, feeders = alloy.melt(), alloy.spacing, case.foundry.feeders
    if feeders is not None:
        pairs = (on.split("/") for on in feeders)
        feeders = tuple(surface for name, surface in pairs if name == body.name)
    liquidus, capacity = alloy.path.liquidus, material.description.heat_capacity
    latent = 0.0 if capacity is None else material.latent_heat / float(capacity(liquidus, 0.0))
    return MushMetal(
        melt.contraction,
        melt.viscosity,
        melt.cavitation,
        1.0 - alloy.cut_off,
        arms.coefficient,
        arms.exponent,
        liquidus,
        feeders,
        latent,
    )


def flowing(mechanics: MechanicalProblem | None) -> frozenset[str]:
    """Return the names of the bodies whose melt flows, none without mechanics."""
    bodies = {} if mechanics is None else mechanics.bodies
    return frozenset(n for n, body in bodies.items() if body.formulation.wall_melt is not None)


def words_of(body: str, metal: MushMetal) -> str:
    """Describe in words how the melt of a body flows, and what its pores ask of the steps."""
    arms = f"{1e6 * metal.spacing:.3g} µm"
    if metal.exponent > 0.0:
        arms += " at 1 K/s"
    return (
        f"{body}: its melt flows through the mush between arms of {arms}, and pores open at a "
        f"suction of {metal.cavitation:.3g} Pa; a front that passes more than one element in a "
        "step smears them"
    )
