"""Stages and cycles in words, for `castx check` and for the report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.table import Table

from castx.case.boundaries import FREE_CLAMP, LOADS
from castx.case.case import Case
from castx.case.stages import Schedule, Stage
from castx.input.units import plain_text, seconds_text


def stage_table(case: Case, stages: Sequence[Case]) -> Table:
    """Return a table of the stages: their beginning, their bodies and their changes.

    Args:
        case: the case.
        stages: what it asks for during each stage, the start first.
    """
    table = Table("stage", "from", "bodies", "what changes", box=SIMPLE_HEAD)
    for number, found in enumerate(stages):
        stage = case.stages[number - 1] if number else None
        table.add_row(
            str(number),
            f"{stage.at if stage else 0.0:g} s",
            ", ".join(body.name for body in found.bodies),
            "\n".join(_changes(stage)) if stage else "",
        )
    return table


def _changes(stage: Stage) -> Iterator[str]:
    if stage.remove:
        yield f"without {', '.join(stage.remove)}"
    for boundary in stage.boundaries:
        kinds = [condition.type for condition in boundary.heat]
        kinds += [f"displacement {condition.direction}" for condition in boundary.displacement]
        loads = (key for key in LOADS if getattr(boundary, key) is not None)
        kinds += [f"{key} free" if getattr(boundary, key) is FREE_CLAMP else key for key in loads]
        yield f"{boundary.on}: {', '.join(kinds)}"
    if stage.spray is not None:
        yield f"spray on {', '.join(stage.spray.on) or 'what removed bodies leave bare'}"
    for body, friction in stage.friction.items():
        yield f"force to draw {body}, friction {friction:g}"


def cycle_text(case: Case) -> str:
    """Return a text on the number and duration of the cycles of a case."""
    schedule, last = Schedule(case.stages, case.time.end), case.stages[-1]
    renewed = f"{', '.join(last.renew)} new in each" if last.renew else "all bodies go on"
    return (
        f"{schedule.cycles} cycles of {schedule.cycle_length:g} s, {renewed}: the run ends at "
        f"{schedule.end:g} s"
    )


def process_rows(events: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, str]]:
    """Yield the stages, ejections and cycles of a run, as pairs of name and text.

    Args:
        events: those of run.json.
    """
    for event in events:
        if "stage" in event and event["cycle"] == 1:
            there = ", ".join(event["bodies"])
            yield f"stage {event['stage']}", f"from {seconds_text(event['time'])}: {there}"
    drawn = {body: event for event in events for body in event.get("ejection", {})}
    for body, event in drawn.items():
        found = event["ejection"][body]
        force, normal = (plain_text(found[kind], 3) for kind in ("force", "normal"))
        yield (
            f"force to draw {body}",
            f"about {force} N at {seconds_text(event['time'])}: friction {found['friction']:g} "
            f"times normal forces of {normal} N, without draught and adhesion",
        )
    ends = [event for event in events if event.get("change") is not None]
    if ends:
        last, periodic = ends[-1], [event["cycle"] for event in ends if event["periodic"]]
        since = f"periodic since cycle {periodic[0]}" if last["periodic"] else "not periodic yet"
        text = f"cycle {last['cycle']} ended within {last['change']:.3g} K of the one before"
        if last["distance"] is not None:
            text += f", about {last['distance']:.3g} K from the periodic state"
        yield "cycles", f"{since}; {text}"
