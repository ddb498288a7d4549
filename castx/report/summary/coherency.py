"""What hangs on coherency: the number that was used, and what others have given."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from castx.case.coherency import sensitivity_command
from castx.report.summary.finding import Finding
from castx.results.files.sensitivity import Sensitivity, read_sensitivity
from castx.results.reading import Results


def coherency(run: Results) -> Iterator[Finding]:
    """Yield the coherency of each alloy, and how much freezing time and gaps hang on it."""
    found = _of_this_run(run)
    for body, described in run.record["bodies"].items():
        known = described.get("coherency")
        if known is not None:
            told = f"Solid fraction from which its mush bears; {known['source']}. "
            told += _advice(run) if found is None else "How much hangs on it stands beside."
            yield Finding("Coherency", body, float(known["value"]), "", told)
    if found is not None:
        yield from _freezing_times(found)
        yield from _gaps(found)


def _of_this_run(run: Results) -> Sensitivity | None:
    """Return the results of runs beside a run; None where it has gone on without them."""
    found = read_sensitivity(run.folder)
    own = [] if found is None else [known.reached for known in found.runs if known.folder == "."]
    return found if run.record.get("time_reached") in own else None


def _advice(run: Results) -> str:
    command = sensitivity_command(run.record["case"]["file"])
    return f"Freezing time and gaps hang on it; how much, says {command}"


def _freezing_times(found: Sensitivity) -> Iterator[Finding]:
    """Yield freezing times of a casting, and their difference between coherencies."""
    for body in found.castings:
        times = [run.frozen.get(body) for run in found.runs]
        if all(time is None for time in times):
            continue
        ends = [run.reached if time is None else time
                for run, time in zip(found.runs, times, strict=True)]  # fmt: skip
        least = "At least: " if None in times else ""
        told = [f"{run.number(body)}: {run.freezing_text(body)}" for run in found.runs]
        yield Finding(
            "Freezing time by coherency", body, max(ends) - min(ends), "s",
            f"{least}between the earliest and the latest. {_list(told)}.",
        )  # fmt: skip


def _gaps(found: Sensitivity) -> Iterator[Finding]:
    """Yield largest gaps of an interface, and their difference between coherencies."""
    for name in found.interfaces:
        widths = [run.gaps[name] for run in found.runs if name in run.gaps]
        told = [f"{run.number()}: {run.gap_text(name)}" for run in found.runs]
        yield Finding(
            "Largest gap by coherency", name, max(widths) - min(widths), "µm",
            f"Between the narrowest and the widest. {_list(told)}.", factor=1e6,
        )  # fmt: skip


def _list(texts: Sequence[str]) -> str:
    return "With a coherency of " + "; of ".join(texts)
