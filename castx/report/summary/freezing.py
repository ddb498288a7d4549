"""The last place to freeze, and its time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from castx.arrays import FloatArray
from castx.input.units import plain_text, seconds_text
from castx.report.summary.finding import Finding, Shown
from castx.results.reading import Results
from castx.results.states.snapshot import FULLY_SOLID

LAST_LIQUID = "Freezes last"
STILL_LIQUID = "Still liquid"


def freezing(run: Results) -> Iterator[Finding]:
    """Yield when the last liquid of each casting has frozen, or how much is left at the end.

    A casting that melts again freezes when it does so last. Of one that is poured again the first
    pouring that froze counts.
    """
    for body in run.freezing:
        time, fraction = first_frozen(run, body)
        known = np.flatnonzero(np.isfinite(fraction))
        frozen = np.flatnonzero(fraction >= FULLY_SOLID)
        liquid = np.flatnonzero(fraction < FULLY_SOLID).max(initial=-1)
        for_good = frozen[frozen > liquid]
        if for_good.size:
            last = int(for_good[0])
            again = float(time[frozen[0]]) if last != frozen[0] else None
            yield last_liquid(run, body, float(time[max(last - 1, 0)]), float(time[last]), again)
            continue
        end, out = int(known[-1]), taken_out(run, body)
        yield still_liquid(
            run, body, float(time[end]) if out is None else out, 1.0 - float(fraction[end]),
            is_out=out is not None, solid_at=float(time[frozen[0]]) if frozen.size else None,
        )  # fmt: skip


def first_frozen(run: Results, body: str) -> tuple[FloatArray, FloatArray]:
    """Return times [s] and solid fractions of the first pouring that froze, or of the last one."""
    time, fraction = run.history["time"], run.history[f"{body}.solid_fraction"]
    poured = [
        float(event["time"]) for event in run.record.get("process", [])
        if body in event.get("renewed", []) and event["time"] > 0.0
    ]  # fmt: skip
    begin = -np.inf
    for end in [*poured, np.inf]:
        there = (time > begin) & (time <= end)
        if end == np.inf or (fraction[there] >= FULLY_SOLID).any():
            break
        begin = end
    return time[there], fraction[there]


def taken_out(run: Results, body: str) -> float | None:
    """Return when a body was removed for good [s]; None: it is there at the end."""
    out: float | None = None
    for event in run.record.get("process", []):
        if body in event.get("removed", {}):
            out = float(event["time"])
        elif body in event["bodies"]:
            out = None
    return out


def still_liquid(
    run: Results, body: str, time: float, liquid: float, *,
    is_out: bool = False, solid_at: float | None = None,
) -> Finding:  # fmt: skip
    """Return the finding of a casting that is not all solid at the end.

    Args:
        run: the results.
        body: the casting.
        time: of its last state [s].
        liquid: its share of liquid then.
        is_out: whether it was removed then.
        solid_at: when it was all solid before it melted again [s]; None: it never was.
    """
    told = f"{body} has not frozen when the run ends: a longer one tells what freezes last."
    followed = None
    if solid_at is not None:
        told = f"{body} was all solid at {seconds_text(solid_at)}, and has melted again."
    elif is_out:
        told = f"{body} was removed at {seconds_text(time)}, before it had frozen."
        # Of later cycles there are no fields of the casting.
        followed = run.record.get("last_liquid", {}).get(body)
    place = last_place(run, body, time) if followed is None else followed["place"]
    return Finding(
        STILL_LIQUID, body, liquid, "%", told,
        factor=100.0, place=place, time=time, shown=Shown("solid_fraction", (body,), time),
    )  # fmt: skip


def last_liquid(
    run: Results, body: str, before: float, after: float, solid_at: float | None = None
) -> Finding:
    """Return when and where the last liquid of a casting has frozen.

    The last liquid is followed in every step. A pool that ends in the last of them says that
    nothing can feed what it shrinks by; it ends as it bears, and its last liquid freezes later.

    Args:
        run: the results.
        body: the casting.
        before: start of the step in which it became all solid [s].
        after: end of this step [s].
        solid_at: when it was all solid before it melted again [s]; None: it did not.
    """
    pools = [
        spot for spot in run.record.get("hot_spots", [])
        if spot["body"] == body and spot["ended"] is not None and before < spot["ended"] <= after
    ]  # fmt: skip
    place: Sequence[float] | None
    followed = run.record.get("last_liquid", {}).get(body)
    if pools:
        latest = max(pools, key=lambda spot: float(spot["ended"]))
        place = latest["place"]
        told = "the last liquid freezes there."
        if latest["deficit"] is None or latest["deficit"] > 0.0:
            told = "the last liquid freezes there; what it shrinks by then nothing can feed."
    else:
        place = last_place(run, body, after) if followed is None else followed["place"]
        told = "the last liquid was at this place."
    if solid_at is not None:
        told += f" It was all solid at {seconds_text(solid_at)} already, and melted again."
    return Finding(
        LAST_LIQUID, body, after, "s",
        f"All solid in the step from {plain_text(before)} to {seconds_text(after)}; {told}",
        place=place, time=after, shown=Shown("temperature", (body,), earlier(run.times, after)),
    )  # fmt: skip


def earlier(times: Sequence[float], time: float) -> float:
    """Return the last time of fields before a time, the first one if there is none."""
    return max((written for written in times if written < time), default=times[0])


def last_place(run: Results, body: str, time: float) -> Sequence[float] | None:
    """Return where a casting was least solid, and hottest of these places, in its last fields.

    Args:
        run: the results.
        body: the casting.
        time: up to which fields count [s].
    """
    for written in reversed([found for found in run.times if found <= time]):
        grid = run.grids(written).get(body)
        if grid is None or not {"solid_fraction", "temperature"} <= set(grid.point_data):
            continue
        solid = np.asarray(grid.point_data["solid_fraction"])
        if solid.min() < FULLY_SOLID:
            least = np.flatnonzero(solid <= solid.min() + 1e-9)
            hottest = least[np.argmax(np.asarray(grid.point_data["temperature"])[least])]
            point = np.asarray(grid.points[hottest], dtype=np.float64)
            return list(point if run.model == "3d" else point[:2])
    return None
