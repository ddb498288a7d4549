"""Walls with so few cells across that they bend too little, or too much."""

from __future__ import annotations

from collections.abc import Iterator

from castx.foundry.bending import ThinWalls
from castx.report.summary.finding import Finding
from castx.results.reading import Results


def thin_walls(run: Results) -> Iterator[Finding]:
    """Yield for each body with thin walls by how much their deflection is off."""
    for body, described in run.record["bodies"].items():
        known = described.get("thin_walls")
        if known is not None:
            walls = ThinWalls(**known)
            yield Finding(
                "Bending of thin walls", body, walls.error, "%",
                f"Estimated error of the deflection: {walls.text}.", factor=100.0, of_mesh=True,
            )  # fmt: skip
