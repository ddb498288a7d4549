"""The numbers of several runs of the tests together, and where their time went.

    python3 -m tests.verdict FOLDER DURATIONS

FOLDER holds for each run `NAME.xml`, the result file of pytest, and `NAME.status`, its exit status.
The durations of all tests are written to the table DURATIONS. The last line counts the tests of all
runs, and the exit status is 1 if anything failed, or nothing passed.
"""

from __future__ import annotations

import csv
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

NO_TESTS = 5
"""Exit status of pytest where no test is meant for this number of ranks."""
SHOWN = 10
"""Slowest files that are named."""


class Duration(NamedTuple):
    """Wall time of one test in one run [s]."""

    run: str
    file: str
    test: str
    seconds: float


class Run(NamedTuple):
    """Numbers of tests of one run, and what it says of its end."""

    name: str
    passed: int
    failed: int
    skipped: int
    seconds: float
    ending: str = ""

    def __str__(self) -> str:
        """Say the numbers in one line."""
        return (
            f"{self.name}: {self.passed} passed, {self.failed} failed, {self.skipped} skipped "
            f"in {self.seconds:.0f} s{self.ending}"
        )


def run_of(results: Path, status: int) -> tuple[Run, list[Duration]]:
    """Return the numbers of a run and the durations of its tests.

    A run that ends badly without a failed test counts as one failure: pytest writes its result file
    at the very end.

    Args:
        results: result file of pytest in the form of JUnit; may be missing.
        status: exit status of the run.
    """
    try:
        suite = next(ElementTree.parse(results).iter("testsuite"))
    except (OSError, ElementTree.ParseError):
        return Run(results.stem, 0, 1, 0, 0.0, f", ended with status {status} before its end"), []
    failed, skipped = count(suite, "failures", "errors"), count(suite, "skipped")
    passed = count(suite, "tests") - failed - skipped
    if status not in (0, NO_TESTS) and not failed:
        failed = 1
    run = Run(results.stem, passed, failed, skipped, float(suite.get("time", "0")))
    return run, list(_durations(run.name, suite))


def count(suite: ElementTree.Element, *kinds: str) -> int:
    """Return the number of tests of some kinds that a result file counts."""
    return sum(int(suite.get(kind, "0")) for kind in kinds)


def _durations(run: str, suite: ElementTree.Element) -> Iterator[Duration]:
    for case in suite.iter("testcase"):
        file = case.get("classname", "").replace(".", "/") + ".py"
        yield Duration(run, file, case.get("name", ""), float(case.get("time", "0")))


def slowest_files(durations: Sequence[Duration]) -> list[tuple[str, float]]:
    """Return the files whose tests took longest in all runs together, and their time [s]."""
    files: dict[str, float] = defaultdict(float)
    for duration in durations:
        files[duration.file] += duration.seconds
    return sorted(files.items(), key=lambda item: -item[1])[:SHOWN]


def main(folder: Path, table: Path) -> int:
    """Print the verdict and keep the durations; return the exit status."""
    runs, durations = [], []
    for status in sorted(folder.glob("*.status"), key=lambda path: path.stat().st_mtime_ns):
        run, times = run_of(status.with_suffix(".xml"), int(status.read_text()))
        runs.append(run)
        durations += times
    table.parent.mkdir(parents=True, exist_ok=True)
    with table.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([Duration._fields, *durations])
    passed, failed = sum(run.passed for run in runs), sum(run.failed for run in runs)
    slowest = [f"{seconds:7.1f} s  {name}" for name, seconds in slowest_files(durations)]
    lines = ["slowest files:", *slowest, "", *map(str, runs), f"{passed} passed, {failed} failed"]
    sys.stdout.write("\n".join(lines) + "\n")
    return int(failed > 0 or passed == 0)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
