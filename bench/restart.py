"""Kill a run at random moments, again and again: is any lost, and do all end in the same state?

    bin/with-fenicsx python3 bench/restart.py [RUNS] [--ranks N] [--seed S]

Runs a short case once without disturbance, then RUNS times (100 unless said otherwise): each is
killed with SIGKILL at a random moment of its life, from the first import to the last file, gone on
with by `--restart` and killed again, up to three times, then left in peace. One that was done
before its first kill does not count and begins anew. Prints when the runs were killed and the
largest difference of the final states and tables.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from castx.arrays import FloatArray
from castx.results.files.series import read_series

CASE = """
[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
radius = "20 mm"
height = "40 mm"
wall = "10 mm"
size = "3 mm"
[[bodies]]
name = "casting"
material = "AlSi7Mg"
law = "thermo-elasto-viscoplastic"
temperature = 670
[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 200
formulation = "displacement"
[[interfaces]]
bodies = ["casting", "mould"]
heat = { law = "limited", closed = 2300, gas_conductivity = 0.05 }
[[boundaries]]
on = "casting/base"
displacement = { normal = 0 }
[[boundaries]]
on = "mould/base"
displacement = { normal = 0 }
[[probes]]
name = "centre"
body = "casting"
at = [0, 0.02]
quantities = ["temperature", "stress"]
[time]
end = 4
first_step = 0.05
largest_step = 0.1
[solver]
linear = "direct"
[output]
every = 1
checkpoint = 0.1
fields = ["temperature", "displacement", "von_mises", "solidification_time"]
"""


def command(case: Path, folder: Path, ranks: int, *more: str) -> list[str]:
    """Return the command that runs the case."""
    launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    run = [sys.executable, "-m", "castx", "run", str(case), "--output", str(folder)]
    return [*launcher, *run, *more]


def killed(arguments: list[str], after: float) -> bool:
    """Start a run and kill it and all its ranks after some time [s]; return whether it lived."""
    process = subprocess.Popen(
        arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    try:
        process.wait(timeout=after)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return True
    return False


def difference(one: Path, other: Path) -> float:
    """Return the largest relative difference of the final states and tables of two runs."""
    largest = 0.0
    for name in ("probes.csv", "history.csv"):
        a, b = read_series(one / name), read_series(other / name)
        if list(a) != list(b) or len(a["time"]) != len(b["time"]):
            return float("inf")
        for key in (key for key in a if key not in ("wall", "energy_error", "support_force")):
            largest = max(largest, relative(a[key], b[key]))
    paths = [folder / "checkpoint" / "state.npz" for folder in (one, other)]
    with np.load(paths[0]) as state, np.load(paths[1]) as other_state:
        for name in state.files:
            if "/heat/enthalpy/" in name or "/motion/" in name or name.endswith("/gap"):
                largest = max(largest, relative(state[name], other_state[name]))
    return largest


def relative(a: FloatArray, b: FloatArray) -> float:
    """Return the largest difference of two arrays over their largest value."""
    if a.shape != b.shape:
        return float("inf")
    scale = max(float(np.nanmax(np.abs(a), initial=0.0)), 1e-300)
    return float(np.nanmax(np.abs(a - b), initial=0.0)) / scale


def main(arguments: Sequence[str] | None = None) -> int:
    """Return 1 when a run was lost or ended otherwise."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("runs", nargs="?", type=int, default=100)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args(arguments)
    dice = random.Random(asked.seed)
    root = Path(tempfile.mkdtemp(prefix="restart-"))
    case = root / "case.toml"
    case.write_text(CASE)
    begin = time.perf_counter()
    subprocess.run(command(case, root / "whole", asked.ranks), check=True, capture_output=True)
    life = time.perf_counter() - begin
    print(f"one run takes {life:.1f} s", flush=True)
    lost, kills, largest = [], 0, 0.0
    for number in range(asked.runs):
        folder = root / f"{number:03d}"
        again = command(case, folder, asked.ranks, "--restart")
        moments: list[str] = []
        wanted = dice.randint(1, 3)
        while len(moments) < wanted:
            after = dice.uniform(0.0, life)
            begin = time.perf_counter()
            if killed(again, after):
                moments.append(f"{after:.2f}")
            elif moments:
                break
            else:  # faster than the first one
                life = min(life, time.perf_counter() - begin)
                shutil.rmtree(folder)
        kills += len(moments)
        last = subprocess.run(again, capture_output=True, text=True)
        found = float("inf") if last.returncode else difference(root / "whole", folder)
        largest = max(largest, found)
        if last.returncode or found > 1e-6:
            lost.append(number)
            print(last.stderr[-2000:])
        print(f"{number:4d}  killed after {', '.join(moments)} s: {found:.1e}", flush=True)
    print(f"{asked.runs} runs, {kills} kills, lost: {lost or 'none'}, difference {largest:.1e}")
    return int(bool(lost))


if __name__ == "__main__":
    sys.exit(main())
