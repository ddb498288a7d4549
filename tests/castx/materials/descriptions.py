"""Materials written as in a case file, for the tests beside."""

from __future__ import annotations

from typing import Any

from castx.input.entries import Description
from castx.materials.description import MaterialDescription
from castx.materials.material import Material
from castx.tables import Table

ALLOY: dict[str, Any] = {
    "density": 2500.0,
    "heat_capacity": {"solid": 1000.0, "liquid": 1200.0},
    "conductivity": {"solid": [[20, 200.0], [500, 160.0]], "liquid": 80.0},
    "latent_heat": 4e5,
    "solidus": 550.0,
    "liquidus": 610.0,
    "young_modulus": [[20, 70e9], [550, 10e9]],
    "poisson_ratio": 0.33,
    "expansion": [[100, 22e-6], [500, 26e-6]],
}


def described(**changes: Any) -> MaterialDescription:
    """Return the alloy with changed properties; None leaves one out."""
    keys = ALLOY | changes
    return MaterialDescription.read({key: keys[key] for key in keys if keys[key] is not None})


def alloy(**changes: Any) -> Material:
    """Return the alloy as a material."""
    return Material("alloy", described(**changes))


def table(description: Description, key: str) -> Table:
    """Return a key of a rule that a description gives."""
    found = getattr(description, key)
    assert isinstance(found, Table)
    return found
