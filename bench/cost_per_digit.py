"""What does a digit cost with each element? Errors of a casting over CPU seconds, in one plot.

    bin/with-fenicsx python3 bench/cost_per_digit.py DIR cylinder lug [--picture FILE]

Runs demos/cylinder.toml with AlSi7Mg, or demos/parts/lug.toml, with each formulation of the casting
in finer and finer meshes, all in the same equal steps, and compares four numbers with the mean of
those of the finest meshes: freezing time, and mean gap, mean von Mises stress and allowance of the
casting at the end. Runs that are there are not run again. Prints a line for each run, whose digits
are −log10 of the mean of the four relative errors; a short run before compiles the forms.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from mpi4py import MPI

import numpy as np

from castx.case.case import Case
from castx.case.reading.read import load_case
from castx.command.run import RunSettings, run_case
from castx.report.style import DOTS_PER_INCH, figure
from castx.results.files.run_json import number_of_cells
from castx.results.reading import Results

DEMOS = Path(__file__).parent.parent / "demos"
ALLOY = ("bodies.0.material=AlSi7Mg", "bodies.0.temperature=650", "time.end=120")
STEPS = ("time.fixed_step=1", "time.heat_substeps=4")
COMPARED = ("freezing", "gap", "stress", "allowance")
SOLID = 0.999
"""Share of solid at which a casting counts as frozen."""


class Part(NamedTuple):
    """A casting whose answers are compared.

    Attributes:
        case: its file.
        changes: of the case.
        size: key of the sizes of its cells.
        elements: changes of the case for each element, and the sizes of its meshes.
        reference: elements and sizes of the finest meshes, whose mean counts.
        step: name of its module in demos/parts; empty: its mesh is generated.
    """

    case: Path
    changes: tuple[str, ...]
    size: str
    elements: Mapping[str, tuple[tuple[str, ...], tuple[float, ...]]]
    reference: Sequence[tuple[str, float]]
    step: str = ""


class Line(NamedTuple):
    """What a run has cost, and how far it is off.

    Attributes:
        element: name of the element.
        size: of its cells.
        cells: of all bodies.
        cpu: CPU time [s].
        errors: of the four numbers, relative.
    """

    element: str
    size: float
    cells: float
    cpu: float
    errors: Sequence[float]


QUADRATIC = "bodies.0.formulation=taylor-hood"
SQUARE = "geometry.cells=quadrilaterals"
SMALL, SMALLEST = (f"geometry.interface_size={size}" for size in ("auto", "0.3 mm"))
PARTS = {
    "cylinder": Part(
        DEMOS / "cylinder.toml", (*ALLOY, *STEPS), "geometry.size",
        {
            "triangles, mixed": ((), (7.5e-3, 5e-3, 2.5e-3, 1.25e-3)),
            "triangles, taylor-hood": ((QUADRATIC,), (7.5e-3, 5e-3, 2.5e-3, 1.25e-3)),
            "quadrilaterals, q1p0": ((SQUARE,), (7.5e-3, 5e-3, 2.5e-3, 1.25e-3)),
            "triangles, mixed, small at the wall": ((SMALL,), (7.5e-3, 5e-3, 2.5e-3)),
            "quadrilaterals, q1p0, small at the wall": ((SQUARE, SMALL), (7.5e-3, 5e-3, 2.5e-3)),
            "triangles, mixed, smallest at the wall": ((SMALLEST,), (1.25e-3,)),
        },
        (
            ("triangles, mixed, smallest at the wall", 1.25e-3),
            ("triangles, taylor-hood", 1.25e-3), ("quadrilaterals, q1p0", 1.25e-3),
        ),
    ),
    "lug": Part(
        DEMOS / "parts" / "lug.toml", STEPS,
        "geometry.refinement",
        {
            "tetrahedra, mixed": ((), (0.8, 1.0, 1.4, 2.0)),
            "tetrahedra, taylor-hood": ((QUADRATIC,), (0.8,)),
        },
        (("tetrahedra, mixed", 2.0),),
        "lug",
    ),
}  # fmt: skip


def main(arguments: Sequence[str] | None = None) -> None:
    """Run what is not there, print the lines and draw them."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("output", type=Path, help="folder of the runs")
    parser.add_argument("parts", choices=list(PARTS), nargs="+")
    parser.add_argument("--picture", type=Path, help="file of the plot")
    asked = parser.parse_args(arguments)
    asked.output.mkdir(parents=True, exist_ok=True)
    found = {name: lines_of(name, asked.output) for name in asked.parts}
    if asked.picture:
        draw(found, asked.picture)


def lines_of(name: str, folder: Path) -> list[Line]:
    """Run a part in all its meshes, print its lines; return all but that of the finest mesh."""
    part = PARTS[name]
    found = {
        (element, size): measured(case, folder / f"{name} {element} {size:g}")
        for element, size, case in cases(part, folder)
    }
    fine = [found[mesh] for mesh in part.reference]
    exact = {key: float(np.mean([numbers[key] for numbers in fine])) for key in COMPARED}
    for key, value in exact.items():
        apart = max(abs(numbers[key] / value - 1.0) for numbers in fine)
        print(f"{name}, {key}: {value:.4g} ± {100 * apart:.1f} % by the finest meshes")
    lines = [
        Line(element, size, numbers["cells"], numbers["cpu"], errors(numbers, exact))
        for (element, size), numbers in found.items()
    ]
    print("element, size | cells | CPU s | freezing time, gap, stress, allowance [%] | digits")
    for line in lines:
        shown = ", ".join(f"{100 * error:+.1f}" for error in line.errors)
        print(
            f"{line.element}, {line.size:g} | {line.cells:.0f} | {line.cpu:.0f} | {shown} | "
            f"{digits(line.errors):.1f}"
        )
    return [line for line in lines if (line.element, line.size) != part.reference[0]]


def cases(part: Part, folder: Path) -> Iterator[tuple[str, float, Case]]:
    """Yield element, size and case of each run; a part from CAD is drawn into a folder first."""
    drawn = []
    if part.step:
        step = (folder / f"{part.step}.step").resolve()
        if not step.is_file():
            module = f"demos.parts.{part.step}"
            subprocess.run([sys.executable, "-m", module, str(step)], cwd=DEMOS.parent, check=True)
        drawn = [f"geometry.file={step}"]
    for element, (changes, sizes) in part.elements.items():
        for size in sizes:
            given = (*part.changes, *drawn, *changes, f"{part.size}={size:g}")
            yield element, size, load_case(part.case, list(given))


def measured(case: Case, folder: Path) -> dict[str, float]:
    """Return the answers of a case, its cells and CPU seconds, kept in its folder."""
    kept = folder / "answers.json"
    if not kept.is_file():
        short = case.time.model_copy(update={"end": 2.0 * (case.time.fixed_step or 1.0)})
        run_to(case.model_copy(update={"time": short}), folder / "short")
        begin = time.process_time()
        run_to(case, folder / "run")
        cpu = time.process_time() - begin
        kept.write_text(json.dumps({**answers(Results(folder / "run")), "cpu": cpu}))
    loaded: dict[str, float] = json.loads(kept.read_text())
    return loaded


def run_to(case: Case, folder: Path) -> None:
    """Run a case into a folder."""
    output = case.output.model_copy(update={"folder": folder})
    run_case(case.model_copy(update={"output": output}), RunSettings(MPI.COMM_SELF))


def answers(run: Results) -> dict[str, float]:
    """Return the four numbers of a casting, and the cells of all bodies."""
    (casting,) = run.freezing
    history, (interface,) = run.history, run.interfaces
    solid = history[f"{casting}.solid_fraction"]
    last = int(np.flatnonzero(solid >= SOLID)[0])
    frozen = np.interp(SOLID, solid[last - 1 : last + 1], history["time"][last - 1 : last + 1])
    end = run.stage_ends[-1]["bodies"][casting]
    shape = end["distortion"]
    return {
        "freezing": float(frozen),
        "gap": float(history[f"{interface}.mean_gap"][-1]),
        "stress": end["stress"]["mean_von_mises"],
        "allowance": shape["allowance"][0],
        "cells": number_of_cells(run.record),
    }


def errors(numbers: Mapping[str, float], exact: Mapping[str, float]) -> list[float]:
    """Return the relative errors of the four numbers."""
    return [numbers[key] / exact[key] - 1.0 for key in COMPARED]


def digits(errors: Sequence[float]) -> float:
    """Return the digits that hold: −log10 of the mean error."""
    return float(-np.log10(np.mean(np.abs(errors))))


def draw(parts: Mapping[str, Sequence[Line]], picture: Path) -> None:
    """Draw the digits of each element over CPU seconds, part beside part."""
    with figure(5.6 * len(parts), 4.2) as (drawn, _):
        for axes, (name, lines) in zip(
            drawn.subplots(1, len(parts), squeeze=False)[0], parts.items(), strict=True
        ):
            for element in dict.fromkeys(line.element for line in lines):
                own = [line for line in lines if line.element == element]
                found = sorted((line.cpu, digits(line.errors)) for line in own)
                axes.plot(*zip(*found, strict=True), marker="o", label=element)
            axes.set(xscale="log", xlabel="CPU time [s]", ylabel="digits", title=name)
            axes.xaxis.set_major_formatter("{x:g}")
            axes.xaxis.set_minor_formatter("{x:g}")
            axes.legend()
        drawn.savefig(picture, dpi=DOTS_PER_INCH)


if __name__ == "__main__":
    main()
