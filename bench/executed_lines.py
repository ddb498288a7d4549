"""Which lines of the code does each test execute, and how long does it take?

    nice bin/with-fenicsx python3 bench/executed_lines.py [--folder FOLDER] [TESTS …]

Runs the tests that one rank runs, once, in a copy of this checkout, and keeps for each test that
passes the lines of castx that it executes in functions. Several runs at a time share the tests.
What a fixture of a module or of the session executes counts for all tests that ask for it; what
child processes execute is not seen.
"""

from __future__ import annotations

import argparse
import inspect
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Sequence
from hashlib import sha256
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest

CHECKOUT = Path(__file__).resolve().parent.parent
FOLDER = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "castx/executed_lines"
RECORDED = ("castx", "forms", "meshes")


class Record(NamedTuple):
    """What one run of the tests noted.

    Attributes:
        tests: names of those that passed.
        columns: of the places, file and line.
        executed: a bit for each test and place, eight places a byte, (tests, bytes).
    """

    tests: tuple[str, ...]
    columns: dict[tuple[str, int], int]
    executed: npt.NDArray[np.uint8]

    def tests_of(self, place: tuple[str, int]) -> set[str]:
        """Return the tests that execute a line of a file."""
        if place not in self.columns:
            return set()
        byte, bit = divmod(self.columns[place], 8)
        return {self.tests[k] for k in np.flatnonzero(self.executed[:, byte] & (128 >> bit))}


class ExecutedLines:
    """Which tests execute a line, and how long they take.

    Attributes:
        seconds: of each test that passes [s].

    Args:
        records: of all runs that shared the tests.
        seconds: of each test [s].
        digests: of the files whose lines were recorded.
    """

    def __init__(
        self, records: Sequence[Record], seconds: dict[str, float], digests: dict[str, str]
    ) -> None:
        self._records, self.seconds, self._digests = records, seconds, digests

    def knows(self, path: str, code: str) -> bool:
        """Return whether a file still is what it was when its lines were recorded."""
        return self._digests.get(path) == digest(code)

    def tests_of(self, path: str, lines: Iterable[int]) -> set[str]:
        """Return the tests that execute any of the lines of a file."""
        found: set[str] = set()
        for line in lines:
            found.update(*(record.tests_of((path, line)) for record in self._records))
        return found


class LineRecorder:
    """Plugin of pytest that notes the lines which each test executes in functions.

    Args:
        checkout: folder of the code.
    """

    tool = sys.monitoring.COVERAGE_ID if sys.version_info >= (3, 12) else 0

    def __init__(self, checkout: Path) -> None:
        self.lines: dict[str, set[tuple[str, int]]] = {}
        self.seconds: dict[str, float] = {}
        self._roots = tuple(f"{checkout / name}{os.sep}" for name in RECORDED)
        self._checkout = checkout
        self._paths: dict[str, str] = {}
        self._running: set[tuple[str, int]] = set()
        self._of_fixture: dict[Any, set[tuple[str, int]]] = {}
        self._failed: set[str] = set()

    def start(self) -> None:
        """Watch all modules of castx that are imported from now on."""
        get_code = SourceFileLoader.get_code

        def watched(loader: SourceFileLoader, name: str) -> CodeType | None:
            code = get_code(loader, name)
            if code is not None and os.path.realpath(loader.path).startswith(self._roots):
                self._watch(code)
            return code

        SourceFileLoader.get_code = watched  # type: ignore[method-assign, assignment]
        sys.monitoring.use_tool_id(self.tool, "castx lines")
        sys.monitoring.register_callback(self.tool, sys.monitoring.events.LINE, self._executed)

    def _watch(self, code: CodeType) -> None:
        """Ask for the lines of all functions in a code; modules and classes run at import."""
        if code.co_flags & inspect.CO_OPTIMIZED:
            path = Path(os.path.realpath(code.co_filename)).relative_to(self._checkout).as_posix()
            self._paths[code.co_filename] = path
            sys.monitoring.set_local_events(self.tool, code, sys.monitoring.events.LINE)
        for inner in code.co_consts:
            if isinstance(inner, CodeType):
                self._watch(inner)

    def _executed(self, code: CodeType, line: int) -> object:
        self._running.add((self._paths[code.co_filename], line))
        return sys.monitoring.DISABLE

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Iterator[None]:
        """Note what a fixture executes, if several tests share it."""
        if fixturedef.scope == "function":
            return (yield)
        outside = self._begin()
        try:
            return (yield)
        finally:
            self._of_fixture[fixturedef] = self._running
            outside |= self._running
            self._running = outside
            sys.monitoring.restart_events()

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Note what a test executes with its fixtures, unless another run has claimed it."""
        self._begin()
        answer = yield
        if item.nodeid in self.seconds and item.nodeid not in self._failed:
            assert isinstance(item, pytest.Function)
            defined: dict[str, Sequence[Any]] = item._fixtureinfo.name2fixturedefs
            for found in defined.values():
                for fixture in found:
                    self._running |= self._of_fixture.get(fixture, set())
            self.lines[item.nodeid] = self._running
        return answer

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Note how long a test took and whether it passed."""
        name = report.nodeid
        self.seconds[name] = self.seconds.get(name, 0.0) + report.duration
        if report.outcome != "passed":
            self._failed.add(name)

    def _begin(self) -> set[tuple[str, int]]:
        """Begin anew; return what was noted before."""
        before, self._running = self._running, set()
        sys.monitoring.restart_events()
        return before

    def write(self, file: Path) -> None:
        """Write what was noted: tests, their times, places, which test executes which place."""
        tests = sorted(self.lines)
        places = sorted({place for executed in self.lines.values() for place in executed})
        number = {place: index for index, place in enumerate(places)}
        executed = np.zeros((len(tests), len(places)), dtype=bool)
        for row, test in enumerate(tests):
            executed[row, [number[place] for place in self.lines[test]]] = True
        files = [
            file for name in RECORDED for file in sorted((self._checkout / name).rglob("*.py"))
        ]
        np.savez_compressed(
            file,
            tests=np.frombuffer("\n".join(tests).encode(), dtype=np.uint8),
            seconds=np.array([self.seconds[test] for test in tests]),
            paths=np.array([path for path, _ in places], dtype=str),
            lines=np.array([line for _, line in places], dtype=int),
            executed=np.packbits(executed, axis=1),
            files=np.array([file.relative_to(self._checkout).as_posix() for file in files]),
            digests=np.array([digest(file.read_text(encoding="utf-8")) for file in files]),
        )


def digest(code: str) -> str:
    """Return what tells the code of a file from any other."""
    return sha256(code.encode()).hexdigest()


def read(folder: Path = FOLDER) -> ExecutedLines:
    """Return what the runs into a folder noted.

    Raises:
        FileNotFoundError: there is nothing in the folder.
    """
    records: list[Record] = []
    seconds: dict[str, float] = {}
    digests: dict[str, str] = {}
    for file in sorted(folder.glob("*.npz")):
        with np.load(file) as found:
            tests = tuple(found["tests"].tobytes().decode().split("\n"))
            places = zip(found["paths"].tolist(), found["lines"].tolist(), strict=True)
            columns = {place: column for column, place in enumerate(places)}
            records.append(Record(tests, columns, found["executed"]))
            seconds |= dict(zip(tests, found["seconds"].tolist(), strict=True))
            digests |= dict(zip(found["files"].tolist(), found["digests"].tolist(), strict=True))
    if not records:
        raise FileNotFoundError(f"{folder}: no lines are recorded, run bench/executed_lines.py")
    return ExecutedLines(records, seconds, digests)


def record(file: Path, tests: Sequence[str]) -> int:
    """Run tests in the current folder, a copy of the checkout, and write what they execute."""
    recorder = LineRecorder(Path.cwd().resolve())
    recorder.start()
    status = pytest.main(["-q", "-p", "no:cacheprovider", *tests], plugins=[recorder])
    recorder.write(file)
    return int(status)


def main(arguments: Sequence[str] | None = None) -> int:
    """Record the lines of all tests, or of some."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tests", nargs="*", default=["tests"])
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where the lines are kept")
    given = parser.parse_args(arguments)
    sys.path.insert(0, str(CHECKOUT))
    from bench.mutation import copy_of_checkout, environment

    given.folder.mkdir(parents=True, exist_ok=True)
    file = given.folder.resolve() / f"{time.time_ns()}.npz"
    code = (
        "import sys; from pathlib import Path; from bench.executed_lines import record; "
        "sys.exit(record(Path(sys.argv[1]), sys.argv[2:]))"
    )
    with tempfile.TemporaryDirectory() as folder:
        checkout = copy_of_checkout(Path(folder))
        return subprocess.call(
            [sys.executable, "-B", "-c", code, str(file), *given.tests],
            cwd=checkout, env=environment(checkout),
        )  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
