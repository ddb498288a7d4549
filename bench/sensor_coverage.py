"""Do 95 % bands of h(t) and of depths of sensors hold the truth, in linearised and in whole runs?

    bin/with-fenicsx python3 bench/sensor_coverage.py results/sensor_coverage [--whole 20]

The cylinder of sensor_accuracy.py with sensors 2 and 8 mm deep in the mould, whose true depths are
off by 0.3 mm (one deviation, drawn anew each time), and noise of 0.5, 1 and 2 K. Linearised draws
fit the samples of a model that is linear about the truth: how many bands hold each number, how far
the depths are recovered, and how many bands hold h if depths are wrongly said to be known. Whole
runs do the same by castx identify, with runs of castx in this process; all noises take turns, so
that it may be stopped and goes on when started again. Prints what the processors took.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import redirect_stdout
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.case.reading.read import load_case
from castx.command.run import run
from castx.errors import ConvergenceError
from castx.foundry.identification.covariance import BAND, deviations
from castx.foundry.identification.fit import Unknown, fit
from castx.foundry.identification.sensors import Candidate
from castx.input.toml_written import toml_text
from castx.studies.asked.identify import Identify
from castx.studies.asked.unknowns import SoughtNumber
from castx.studies.inverse.design import slope_tables, with_slopes
from castx.studies.inverse.identify import identify
from castx.studies.inverse.model import MeasuredCase
from castx.studies.inverse.parameters import Parameters
from castx.studies.runs.executor import Ended, Task
from castx.studies.runs.runner import Runner, study_folder

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from bench.sensor_accuracy import COEFFICIENT, FAR, KNOTS, case_of, places

SENSORS = ("mould 2", "mould 8")
NOISES = (0.5, 1.0, 2.0)
TIMES = np.arange(0.5, 60.25, 0.5)
AWAY = 0.3
"""Of ln h at the start of fits, against the truth; from farther away they take more runs."""


class Drawn(NamedTuple):
    """Fits of many draws.

    Attributes:
        off: what was found less the truth, knots in ln and then depths [m], (draws, numbers).
        held: whether the 95 % band of each number holds the truth, (draws, numbers).
    """

    off: FloatArray
    held: BoolArray

    @property
    def coverage(self) -> FloatArray:
        """Shares of the bands that hold the truth, (numbers,)."""
        return np.asarray(self.held.mean(axis=0))


def drawn(
    sensors: Sequence[Candidate], noise: float, draws: int, seed: int = 0, known: bool = False
) -> Drawn:
    """Fit draws of noise and depths by a model that is linear about the truth.

    Args:
        sensors: with their slopes.
        noise: deviation of a sample [K].
        draws: how many.
        seed: of them.
        known: whether depths are said to be known, which they are not.
    """
    changes = np.concatenate([one.sensitivity for one in sensors])
    samples, knots = len(sensors[0].by_depth), changes.shape[1]
    depths = np.zeros((samples * len(sensors), len(sensors)))
    for k, one in enumerate(sensors):
        depths[samples * k : samples * (k + 1), k] = one.by_depth
    unknowns = [Unknown(f"{k}", AWAY, 0.01) for k in range(knots)]
    if not known:
        unknowns += [Unknown(f"depth {k}", 0.0, 1e-4, FAR) for k in range(len(sensors))]
    matrix = changes if known else np.hstack([changes, depths])
    random = np.random.default_rng(seed)

    def model(values: Mapping[str, float]) -> FloatArray:
        return np.asarray(matrix @ np.array([values[one.name] for one in unknowns]))

    off, held = [], []
    for _ in range(draws):
        truth = np.concatenate([np.zeros(knots), FAR * random.normal(size=len(sensors))])
        measured = depths @ truth[knots:] + noise * random.normal(size=len(depths))
        found = fit(model, measured, np.array(noise), unknowns)
        off.append(found.fitted - truth[: len(unknowns)])
        held.append(np.abs(off[-1]) <= BAND * deviations(found.widened))
    return Drawn(np.array(off), np.array(held))


class RunsHere:
    """Executor of studies that runs castx in this process."""

    def ended(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Ended]]:
        """Yield the ends of tasks; see `castx.studies.runs.executor.Executor`."""
        for index, task in enumerate(tasks):
            _, case_file, _, output, *sets = task.arguments
            start = time.process_time()
            with task.log.open("w") as said, redirect_stdout(said):
                run(Path(case_file), sets[1::2], output=Path(output), comm=MPI.COMM_SELF)
            took = time.process_time() - start
            yield index, Ended(0, "", took, took)


def slopes(runner: Runner) -> list[Candidate]:
    """Return the sensors with their slopes at the truth, by eight runs."""
    sought = SoughtNumber.read({"of": "interfaces.0.heat.closed", "name": "h", "over": "time",
                                "knots": KNOTS, "start": COEFFICIENT})  # fmt: skip
    parameters = Parameters.of([sought], load_case(runner.case_file).content)
    unknowns = parameters.unknowns()
    asked = [one for one in places() if one.name in SENSORS]
    tables = slope_tables(runner, parameters, unknowns, asked)
    return [with_slopes(one, tables, unknowns, np.asarray(TIMES)) for one in asked]


def study_of(noise: float, number: str, folder: Path) -> Identify:
    """Return the study of a draw, whose curves are in a file of that name."""
    curves = [
        {"of": f"{name}.temperature", "file": f"{number}.csv", "column": name,
         "noise": noise, "depth_deviation": FAR}
        for name in SENSORS
    ]  # fmt: skip
    unknown = {"of": "interfaces.0.heat.closed", "name": "h", "over": "time", "knots": KNOTS,
               "start": [h * math.exp(-AWAY) for h in COEFFICIENT]}  # fmt: skip
    return Identify.read({"curves": curves, "unknowns": [unknown]}).relative_to(folder)


def measured(file: Path, samples: Sequence[FloatArray]) -> None:
    """Write the curves of a draw."""
    table = np.column_stack([TIMES, *samples])
    np.savetxt(file, table, delimiter=",", header=",".join(["time", *SENSORS]), comments="")


def whole(runner: Runner, noise: float) -> Iterator[tuple[FloatArray, BoolArray]]:
    """Yield what castx identify finds less the truth, and which bands hold it, draw after draw.

    A fit that does not settle has no band, and holds nothing.

    Args:
        runner: of the case with the probes.
        noise: deviation of a sample [K].
    """
    folder = runner.case_file.parent
    measured(folder / "none.csv", [np.zeros(len(TIMES))] * len(SENSORS))
    model = MeasuredCase.of(runner, study_of(noise, "none", folder))
    names, h = model.names(), slice(0, len(KNOTS))
    random = np.random.default_rng(round(10 * noise))
    for k in count():
        truth = np.concatenate([COEFFICIENT, FAR * random.normal(size=len(SENSORS))])
        exact = model(dict(zip(names, map(float, truth), strict=True)))
        noisy = model.sensors.parts(exact + noise * random.normal(size=len(exact)))
        measured(folder / f"{noise:g} K {k}.csv", noisy)
        try:
            found = identify(runner, study_of(noise, f"{noise:g} K {k}", folder)).found
        except ConvergenceError as error:
            print(f"{noise:g} K, draw {k + 1}: {error}", flush=True)
            yield np.full(len(truth), np.nan), np.zeros(len(truth), dtype=bool)
            continue
        values = np.array([one.value for one in found.estimates])
        ends = np.array([[one.low, one.high] for one in found.estimates])
        off = values - truth
        off[h] = np.log(values[h] / truth[h])
        yield off, (ends[:, 0] <= truth) & (truth <= ends[:, 1])


def whole_draws(runner: Runner, number: int) -> Iterator[tuple[float, Drawn]]:
    """Yield so many whole draws of each noise, all noises in turn so that it may be stopped."""
    draws = {noise: whole(runner, noise) for noise in NOISES}
    found: dict[float, list[tuple[FloatArray, BoolArray]]] = {noise: [] for noise in NOISES}
    for k in range(number):
        for noise in NOISES:
            off, held = next(draws[noise])
            found[noise].append((off, held))
            kept = f"{held.sum()} of {len(held)} bands hold"
            print(f"{noise:g} K, draw {k + 1}: {kept}", flush=True)
    for noise in NOISES:
        off, held = (np.array(part) for part in zip(*found[noise], strict=True))
        yield noise, Drawn(off, held)


def row(name: str, numbers: FloatArray) -> str:
    """Return a line of the table: h at its knots, then the depths."""
    return f"{name:44}" + "".join(f"{value:7.1f}" for value in numbers)


def rows(name: str, found: Drawn) -> Iterator[str]:
    """Yield coverage and spread of draws, in %; spreads of depths in 0.01 mm."""
    yield row(f"{name}: bands that hold [%]", 100.0 * found.coverage)
    scale = np.full(found.off.shape[1], 100.0)
    scale[len(KNOTS) :] = 1e5
    spread = np.sqrt(np.nanmean(found.off**2, axis=0))
    yield row("    root mean square off [%, 0.01 mm]", scale * spread)


def opened(folder: Path, size: str, step: float) -> Path:
    """Write the case with the probes of the sensors."""
    kept = ("name", "body", "below", "depth", "at")
    probes: list[dict[str, Any]] = [
        {key: value for key, value in one.probes(0.0)[0].items() if key in kept}
        | {"quantities": ["temperature"]}
        for one in places()
        if one.name in SENSORS
    ]
    case_file = folder / "case.toml"
    case_file.write_text(toml_text({**case_of(size, step), "probes": probes}))
    return case_file


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the coverage; return 1 where linearised draws lie outside 93 to 97 %."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="of the runs")
    parser.add_argument("--size", default="2.5 mm", help="of the cells")
    parser.add_argument("--step", type=float, default=0.25, help="of time [s]")
    parser.add_argument("--draws", type=int, default=2000, help="linearised ones of each noise")
    parser.add_argument("--whole", type=int, default=0, help="whole ones of each noise")
    asked = parser.parse_args(arguments)
    begun, wrong = time.process_time(), False
    print(row("", np.array(KNOTS)) + "   mould 2, 8")
    with study_folder(asked.folder.resolve()) as folder:
        runner = Runner(opened(folder, asked.size, asked.step), (), folder, RunsHere())
        sensors = slopes(runner)
        for noise in NOISES:
            found = drawn(sensors, noise, asked.draws)
            wrong |= bool(np.any(np.abs(found.coverage - 0.95) > 0.02))
            print(*rows(f"{noise:g} K, {asked.draws} linearised", found), sep="\n")
            said = drawn(sensors, noise, asked.draws // 10, known=True)
            print(*rows("    depths said to be known", said), sep="\n", flush=True)
        for noise, found in whole_draws(runner, asked.whole) if asked.whole else ():
            print(*rows(f"{noise:g} K, {asked.whole} whole", found), sep="\n", flush=True)
    print(f"{runner.made} runs of castx, {time.process_time() - begun:.0f} s of processor time")
    return int(wrong)


if __name__ == "__main__":
    raise SystemExit(main())
