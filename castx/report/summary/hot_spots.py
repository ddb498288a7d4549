"""The table of hot spots in the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from castx.input.units import seconds_text
from castx.meshes.generators.declaration import PLANE_MODELS
from castx.report.summary.finding import millimetres_text
from castx.results.states.quantities import parts

MOST_ROWS = 10
"""Hot spots that the report shows; hot_spots.csv has all."""


@dataclass(frozen=True)
class HotSpotTable:
    """A table of texts with its caption."""

    caption: str
    heading: tuple[str, ...]
    rows: list[tuple[str, ...]]


def hot_spot_table(spots: Sequence[Mapping[str, Any]], model: str) -> HotSpotTable:
    """Return the first hot spots of run.json as texts, in the order of their ranks.

    Args:
        spots: the worst first.
        model: geometric model; in the plane volumes are per metre of depth.
    """
    factor, unit = (1e4, "cm² of the section") if model in PLANE_MODELS else (1e6, "cm³")
    axes = ", ".join(parts("displacement", model))
    caption = (
        "Pools of liquid that nothing feeds any more, the largest shrinkage first. A pool that "
        "splits later counts with its parts, which are listed too. It bears when its last node has "
        "the solid fraction `foundry.pool_limit`, by default the coherency; the liquid that is "
        "left between its grains freezes later. What a pool lacks is the volume "
        "of its cavity if nothing follows from outside; with mechanics `unfed_volume` of "
        "history.csv is what the shell has left of it, and the number to take. With flow through "
        "the mush that counts pores too that suction opens in melt which is still connected."
    )
    if len(spots) > MOST_ROWS:
        caption += f" The first {MOST_ROWS} of {len(spots)}; all are in hot_spots.csv."
    heading = (
        "rank", "body", "pool", "cut off", "bears", f"at last there: {axes} [mm]",
        f"liquid when cut off [{unit}]", f"what its freezing lacks [{unit}]",
    )  # fmt: skip
    rows: list[tuple[str, ...]] = [
        (
            str(rank),
            str(spot["body"]),
            str(spot["pool"]) + ("" if spot["parent"] is None else f", part of {spot['parent']}"),
            seconds_text(spot["isolated"]),
            "not yet" if spot["ended"] is None else seconds_text(spot["ended"]),
            ", ".join(millimetres_text(x) for x in spot["place"]),
            f"{factor * spot['volume']:.3g}",
            "unknown" if spot["deficit"] is None else f"{factor * spot['deficit']:.3g}",
        )
        for rank, spot in enumerate(spots[:MOST_ROWS], 1)
    ]
    return HotSpotTable(caption, heading, rows)
