"""Walls with so few cells across that they bend too little or too much, or froze inexactly."""

from __future__ import annotations

from collections.abc import Iterator

from castx.foundry.bending import ThinWalls
from castx.report.summary.finding import Finding
from castx.results.reading import Results


def thin_walls(run: Results) -> Iterator[Finding]:
    """Yield for each body with thin walls by how much deflection and residual stress are off."""
    for body, described in run.record["bodies"].items():
        known = described.get("thin_walls")
        if known is None:
            continue
        walls = ThinWalls(**known)
        if walls.error is not None:
            yield Finding(
                "Bending of thin walls", body, walls.error, "%",
                f"Estimated error of the deflection: {walls.bending_text}.", factor=100.0,
                of_mesh=True,
            )  # fmt: skip
        if walls.freezing_error is not None:
            yield Finding(
                "Residual stress of thin walls", body, walls.freezing_error[0], "%",
                f"Estimated error from place to place: {walls.freezing_text}.", factor=100.0,
                of_mesh=True,
            )  # fmt: skip
