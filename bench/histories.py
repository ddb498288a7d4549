"""How far do the histories and probes of two runs of the same steps differ?

    bin/with-fenicsx python3 bench/histories.py results/before results/after [--most 1e-8]

For two states of the code, solvers or numbers of ranks, with tolerances far below the difference
that is looked for. Prints the columns that differ most, each as a share of the largest value that
its quantity has in any body, interface or place, and fails where one differs by more than --most.
What is zero but for rounding, errors of balances and the effort of a step are left out.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from castx.arrays import FloatArray
from castx.results.files.run_tables import TIME, RunTables
from castx.results.history import COUNTERS

LEFT_OUT = {"energy_error", "force_error", *COUNTERS}
SHOWN = 12
"""Columns that are printed."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the columns that differ most; return 1 where they do by more than is asked."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("first", type=Path, help="folder of a run")
    parser.add_argument("second", type=Path, help="folder of another one")
    parser.add_argument("--most", type=float, default=1e-8, help="difference that is allowed")
    asked = parser.parse_args(arguments)
    runs = RunTables(asked.first), RunTables(asked.second)
    found = differences(*(run.history for run in runs))
    found |= differences(*(run.probes for run in runs))
    ordered = sorted(found.items(), key=lambda column: -column[1])
    for name, difference in ordered[:SHOWN]:
        print(f"{difference:.1e}  {name}")
    print(f"{len(found)} columns, {len(runs[0].history[TIME])} moments")
    return int(ordered[0][1] > asked.most)


def differences(
    first: Mapping[str, FloatArray], second: Mapping[str, FloatArray]
) -> dict[str, float]:
    """Return the largest difference of each common column as a share of its quantity.

    Raises:
        SystemExit: the runs have different steps.
    """
    times = first[TIME], second[TIME]
    if len(times[0]) != len(times[1]) or not np.allclose(*times, rtol=1e-12):
        sys.exit("the runs have different steps: give both the same time.fixed_step and end")
    names = [name for name in first if name in second and _is_compared(name)]
    scales: dict[str, float] = {}
    for name in names:
        quantity = _quantity(name)
        largest = max(np.nanmax(np.abs(run[name]), initial=0.0) for run in (first, second))
        scales[quantity] = max(scales.get(quantity, 0.0), float(largest))
    return {
        name: _largest(first[name], second[name]) / scales[_quantity(name)]
        for name in names
        if scales[_quantity(name)] > 0
    }


def _largest(first: FloatArray, second: FloatArray) -> float:
    """Return the largest difference; infinity where only one of two values exists."""
    one_only = np.isnan(first) != np.isnan(second)
    apart = np.where(one_only, np.inf, np.abs(first - second))
    return float(np.nanmax(apart, initial=0.0))


def _is_compared(name: str) -> bool:
    """Return whether a column belongs to the answer."""
    return name != TIME and LEFT_OUT.isdisjoint(name.split("."))


def _quantity(name: str) -> str:
    """Return the quantity of a column, the same for all components, bodies and extremes."""
    quantity = name.partition(".")[2] or name
    for extreme in ("min_", "mean_", "max_"):
        quantity = quantity.removeprefix(extreme)
    return quantity.partition(".")[0]


if __name__ == "__main__":
    sys.exit(main())
