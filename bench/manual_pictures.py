"""The pictures of the manual that show runs, drawn anew, and the findings that stand beside them.

    bin/with-fenicsx python3 bench/manual_pictures.py DIR [--only report]

Runs demos/cylinder.toml, also with a gap that lets all heat through, demos/feeder.toml and
demos/parts/lug.toml in folders below DIR, unless they are there, and writes demos/pictures. Needs
chromium-headless-shell, which shows the reports. Pictures of mush_flow and pipe are not among them.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from mpi4py import MPI

from castx.case.reading.read import load_case
from castx.command.run import RunSettings, run_case
from castx.report.display import display
from castx.report.page.report import write_report
from castx.report.page.shots import Shot, scales_of, shot, topic_of
from castx.report.reported import ReportedRun
from castx.report.summary.finding import Shown
from castx.report.summary.registry import findings
from castx.results.reading import Results
from tests.castx.app.browser import Browser, found_browser

DEMOS = Path(__file__).parents[1] / "demos"
PICTURES = DEMOS / "pictures"
CASES: Mapping[str, tuple[str, Sequence[str]]] = {
    "cylinder": ("cylinder.toml", ()),
    "closed": ("cylinder.toml", ('interfaces.0.heat={law="constant",closed=2300.0}',)),
    "feeder": ("feeder.toml", ()),
    "lug": ("parts/lug.toml", ()),
}
"""Case files below demos, and what is changed in them, by the name of the run."""
CURVES = "[data-curves='Cooling curves']"
Draw = Callable[[Browser, Path, Path], None]
HEAD = (
    "<meta charset='utf-8'><body style='font: 11px sans-serif; margin: 0'>"
    "<div id='row' style='display: flex; gap: 12px; width: 1180px; padding: 8px'>"
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what is not there, draw the pictures, and print the findings."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("output", type=Path, help="folder of the runs")
    parser.add_argument("--only", choices=tuple(DRAWN), help="one picture alone")
    asked = parser.parse_args(arguments)
    program = found_browser()
    if program is None:
        parser.error("needs chromium-headless-shell on this machine")
    folder = asked.output.resolve()
    drawn = {name: how for name, how in DRAWN.items() if asked.only in (None, name)}
    cases = {*(case for case, _ in drawn.values()), *(() if asked.only else ("closed",))}
    for name in sorted(cases):
        run(folder, name)
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile,
        Browser(program, Path(profile)) as browser,
    ):
        for name, (_, draw) in drawn.items():
            draw(browser, folder, PICTURES / f"{name}.png")
    for name in sorted(cases):
        for found in findings(Results(folder / name)):
            print(f"{name}: {found.name}: {found.number}; {found.sentence}")


def run(folder: Path, name: str) -> None:
    """Run a case in a folder below another one, unless it is there."""
    if (folder / name).is_dir():
        return
    folder.mkdir(parents=True, exist_ok=True)
    file, changes = CASES[name]
    if name == "feeder":
        made("demos/feeder_mesh.py", folder / "feeder.msh")
        changes = (*changes, f"geometry.file={folder / 'feeder.msh'}")
    if name == "lug":
        made("demos/parts/lug.py", folder / "lug.step")
        changes = (*changes, f"geometry.file={folder / 'lug.step'}")
    case = load_case(
        Path(os.path.relpath(DEMOS / file)), [*changes, f"output.folder={folder / name}"]
    )
    run_case(case, RunSettings(MPI.COMM_SELF))


def made(script: str, file: Path) -> None:
    """Let a script of the demos write a file."""
    module = script.removesuffix(".py").replace("/", ".")
    subprocess.run([sys.executable, "-m", module, str(file)], cwd=DEMOS.parent, check=True)


def opened(browser: Browser, folder: Path, name: str) -> None:
    """Show the report of a run, with paths as they are in the repository."""
    browser.resize(1200, 900)
    page, shown = write_report(folder / name), folder / "shown.html"
    shown.write_text(page.read_text("utf-8").replace(f"{DEMOS.parent}/", ""), "utf-8")
    browser.open(shown.as_uri())
    browser.wait_for("document.getElementById('view')?.dataset.ready === 'yes'")


def moments(name: str, field: str, body: str, times: Sequence[float], alike: bool = True) -> Draw:
    """Return how to draw a field of a run in some moments, in the colours of all or of each."""

    def draw(browser: Browser, folder: Path, picture: Path) -> None:
        found, topic = ReportedRun(folder / name), topic_of(field)
        written = [found.nearest(time, body) for time in times]
        limits: dict[str, tuple[float, float]] = {}
        for time in written:
            for scale in scales_of(found.grids(time), topic, [body]):
                key, own = f"{field} {scale.colours}", scale.limits
                low, high = limits.get(key, own)
                limits[key] = min(low, own[0]), max(high, own[1])
        with display():
            how, colours = Shown(field, (body,)), limits if alike else {}
            shots = [shot(found, topic, time, how, None, colours) for time in written]
        page = folder / "moments.html"
        page.write_text(HEAD + "".join(_figure(each) for each in shots if each) + "</div>")
        browser.resize(1200, 600)
        browser.open(page.as_uri())
        browser.wait_for("document.readyState === 'complete'")
        browser.picture_of(picture, "#row")

    return draw


def _figure(drawn: Shot) -> str:
    bars = "".join(
        f"<div style='height: 8px; background: linear-gradient(to right, {bar.colours})'></div>"
        f"<div style='display: flex; justify-content: space-between'><span>{bar.low}</span>"
        f"<span>{bar.label}</span><span>{bar.high}</span></div>"
        for bar in drawn.bars
    )
    return (
        f"<div style='flex: 1'><img style='width: 100%' src='{drawn.source}'>"
        f"<div style='font-size: 14px'>{drawn.time:.4g} s</div>{bars}</div>"
    )


def summary(name: str, height: int) -> Draw:
    """Return how to draw the upper part of a report."""

    def draw(browser: Browser, folder: Path, picture: Path) -> None:
        opened(browser, folder, name)
        browser.picture_of(picture, "body", height)

    return draw


def curves(browser: Browser, folder: Path, picture: Path) -> None:
    """Draw the temperatures at the probes of the lug."""
    opened(browser, folder, "lug")
    browser.value(f"document.querySelector({json.dumps(CURVES)}).scrollIntoView()")
    browser.wait_for(f"document.querySelector({json.dumps(CURVES + ' canvas')})?.width > 0")
    browser.value("window.scrollTo(0, 0)")
    browser.picture_of(picture, CURVES)


DRAWN: Mapping[str, tuple[str, Draw]] = {
    "cylinder_temperature": (
        "cylinder", moments("cylinder", "temperature", "casting", (10.0, 20.0, 35.0, 65.0, 90.0))
    ),
    "report": ("cylinder", summary("cylinder", 1040)),
    "feeder_solidification": (
        "feeder", moments("feeder", "solid_fraction", "casting", (10.0, 30.0, 60.0, 120.0))
    ),
    "lug_report": ("lug", summary("lug", 900)),
    "lug_temperature": (
        "lug", moments("lug", "temperature", "lug", (5.0, 10.0, 15.0, 60.0), alike=False)
    ),
    "lug_curves": ("lug", curves),
}  # fmt: skip
"""The run that each picture shows, and how to draw it."""


if __name__ == "__main__":
    main()
