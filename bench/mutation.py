"""Do the tests notice a small fault in the code?

    bin/with-fenicsx python3 bench/mutation.py [--only TEXT …] [--ranks NUMBER] [--limit SECONDS]
    bin/with-fenicsx python3 bench/mutation.py --draw NUMBER [--seed NUMBER]

Plants the faults of bench/mutants.toml one after the other in a copy of this checkout, runs the
tests that should notice, and prints those that no test did. A fault replaces one line or a part of
it: a sign, a factor, a threshold, a tolerance, a default. A fault with `ranks = 2` leaves out what
the ranks owe each other; its tests run under mpirun, and ranks that wait for ever have caught it.

With --draw the faults come from bench/drawn_faults.py instead: --draw 400 --seed 1. Each is tried
by the tests of one rank that execute its line, nearest and cheapest first; bench/line_tests.py
finds them in what bench/executed_lines.py has recorded. A run that was ended goes on later.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pytest

if TYPE_CHECKING:
    from bench.drawn_faults import Fault

CHECKOUT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(CHECKOUT))
LIST = CHECKOUT / "bench" / "mutants.toml"
COPIED = (
    "castx", "forms", "meshes", "tests", "docs", "demos", "bench", "bin", "deploy", "validation",
    ".ci", "pyproject.toml", "ARCHITECTURE.md", "CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md",
    "COPYING", "COPYING.LESSER", "Dockerfile", "MANIFEST.in", "README.md", "environment.yml",
)  # fmt: skip
SURVIVED, CAUGHT, HANGS = "survived", "caught", "caught (too slow)"
UNTRIED = "tests fail anyway"
OWN = """import sys

sys.meta_path[:] = [f for f in sys.meta_path if "editable" not in str(f.__module__)]
sys.path.insert(0, {!r})
"""
"""Start-up file of Python that forgets the checkout that is installed, for one in a folder."""
PORTIONS = (3.0, 15.0, 60.0)
"""Time of the first portions of tests that try a drawn fault [s]."""
START, SLOWDOWN = 120.0, 6.0
"""Time that tests of a drawn fault may take: this [s], and so many times what they take else."""
NO_TESTS = (2, 3, 4, 5)
"""Exit codes of pytest that say nothing about the fault unless it breaks the import."""


class Mutant(NamedTuple):
    """A fault: what stands in a file, what stands there instead, and who should notice.

    Attributes:
        path: of the file, relative to the checkout.
        text: what is replaced; it occurs once.
        replacement: what stands there instead.
        tests: files of tests, or single tests in them.
        ranks: number of ranks on which the tests run.
    """

    path: str
    text: str
    replacement: str
    tests: tuple[str, ...]
    ranks: int = 1

    def __str__(self) -> str:
        """Say where it is and what it changes."""
        old, new = (" ".join(part.split()) or "nothing" for part in (self.text, self.replacement))
        return f"{self.path}: {old}  →  {new}"

    def planted(self, code: str) -> str:
        """Return the code with the fault.

        Raises:
            ValueError: the text does not occur exactly once, or nothing would change.
        """
        if code.count(self.text) != 1 or self.text == self.replacement:
            raise ValueError(f"{self}: stands there {code.count(self.text)} times, not once")
        return code.replace(self.text, self.replacement)


def mutants() -> list[Mutant]:
    """Return all faults of the list."""
    files = tomllib.loads(LIST.read_text(encoding="utf-8"))["files"]
    return [
        Mutant(file["path"], text, replacement, tuple(file["tests"]), file.get("ranks", 1))
        for file in files
        for text, replacement in file["mutants"]
    ]


def copy_of_checkout(folder: Path) -> Path:
    """Return a folder with the code and the tests of this checkout.

    Raises:
        RuntimeError: Python would take some of the code from elsewhere.
    """
    target = folder / "checkout"
    target.mkdir()
    for name in COPIED:
        source = CHECKOUT / name
        if source.is_dir():
            shutil.copytree(source, target / name, symlinks=True)  # castx/forms is ../forms
        else:
            shutil.copy(source, target / name)
    isolate(target)
    code = "import castx.errors as a, castx.forms.heat as b; print(a.__file__, b.__file__)"
    found = subprocess.run(
        [sys.executable, "-P", "-c", code], env=environment(target), capture_output=True, text=True
    )
    if found.stdout.count(str(target)) != 2:
        raise RuntimeError(f"the copy is not what is imported: {found.stdout}{found.stderr}")
    return target


def isolate(checkout: Path) -> None:
    """Let processes in the `environment` of a checkout import castx from there alone."""
    _site(checkout).mkdir()
    (_site(checkout) / "sitecustomize.py").write_text(OWN.format(str(checkout)), encoding="utf-8")


def _site(checkout: Path) -> Path:
    return checkout.with_name(f"{checkout.name}-site")


def environment(checkout: Path) -> dict[str, str]:
    """Return the environment of processes that run an isolated checkout, and of their own."""
    waiting = {"OMPI_MCA_mpi_yield_when_idle": "1"}
    return {**waiting, **os.environ, "PYTHONPATH": str(_site(checkout))}


def outcome(checkout: Path, tests: Sequence[str], limit: float, ranks: int = 1) -> str:
    """Return what the tests say in a copy of the checkout.

    Args:
        checkout: the copy.
        tests: files of tests, or single tests in them.
        limit: time after which they and all that they have started are killed [s].
        ranks: number of ranks on which they run.

    Raises:
        RuntimeError: pytest did not run them.
    """
    command = [sys.executable, "-B", "-m", "pytest", "-x", "-q", "--all", "-p", "no:cacheprovider"]
    launch = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    return _said([*launch, *command, *tests], checkout, limit).verdict


class Said(NamedTuple):
    """What a run of pytest says: the verdict, and the test that failed first, if any."""

    verdict: str
    test: str = ""


def _said(command: Sequence[str], checkout: Path, limit: float) -> Said:
    """Return what a run of pytest says in a copy of the checkout.

    Raises:
        RuntimeError: pytest did not run any tests.
    """
    with tempfile.TemporaryFile("w+") as said:
        running = subprocess.Popen(
            command, cwd=checkout, env=environment(checkout), start_new_session=True,
            stdout=said, stderr=subprocess.STDOUT,
        )  # fmt: skip
        try:
            code_of_exit = running.wait(limit)
        except subprocess.TimeoutExpired:
            os.killpg(running.pid, signal.SIGKILL)
            running.wait()
            return Said(HANGS)
        said.seek(0)
        text = said.read()
    if code_of_exit in NO_TESTS and "Error" not in text:
        raise RuntimeError(f"{' '.join(command)} ran no tests:\n{text}")
    failed = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", text, re.MULTILINE)
    return Said(SURVIVED if code_of_exit == 0 else CAUGHT, failed.group(1) if failed else "")


def tried(
    chosen: Sequence[Mutant],
    checkout: Path,
    limit: float,
    passes: dict[tuple[tuple[str, ...], int], bool],
) -> Iterator[tuple[Mutant, str]]:
    """Yield each fault and what the tests say of it; they have to pass without any.

    Args:
        chosen: the faults.
        checkout: the copy of the checkout.
        limit: for the tests of one fault [s].
        passes: whether tests pass on a number of ranks without a fault; filled.
    """
    for mutant in chosen:
        key = mutant.tests, mutant.ranks
        if key not in passes:
            passes[key] = outcome(checkout, mutant.tests, limit, mutant.ranks) == SURVIVED
        if not passes[key]:
            yield mutant, UNTRIED
            continue
        file = checkout / mutant.path
        code = file.read_text(encoding="utf-8")
        file.write_text(mutant.planted(code), encoding="utf-8")
        try:
            yield mutant, outcome(checkout, mutant.tests, limit, mutant.ranks)
        finally:
            file.write_text(code, encoding="utf-8")


class Chosen:
    """Plugin of pytest that runs certain tests alone, in their order.

    Args:
        names: of the tests.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._order = {name: place for place, name in enumerate(names)}

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Leave the others out."""
        items[:] = sorted(
            (item for item in items if item.nodeid in self._order),
            key=lambda item: self._order[item.nodeid],
        )


def run_chosen(file: Path) -> int:
    """Run the tests whose names stand in a file as JSON, until one fails."""
    names: list[str] = json.loads(file.read_text(encoding="utf-8"))
    files = dict.fromkeys(name.partition("::")[0] for name in names)
    arguments = ["-x", "-q", "-p", "no:cacheprovider", *files]
    return int(pytest.main(arguments, plugins=[Chosen(names)]))


def portions(tests: Sequence[str], seconds: Mapping[str, float]) -> Iterator[list[str]]:
    """Yield tests in portions, each of which takes longer than the one before.

    Args:
        tests: in the order in which they are tried.
        seconds: that each takes without a fault.
    """
    limits, portion, total = iter(PORTIONS), list[str](), 0.0
    limit = next(limits)
    for test in tests:
        if portion and total + seconds[test] > limit:
            yield portion
            portion, total, limit = [], 0.0, next(limits, math.inf)
        portion.append(test)
        total += seconds[test]
    if portion:
        yield portion


def verdict(
    fault: Fault, tests: Sequence[str], seconds: Mapping[str, float], checkout: Path, most: float
) -> tuple[Said, int]:
    """Return what tests say of a drawn fault, and how many of them were tried.

    Args:
        fault: that is planted.
        tests: in the order in which they are tried.
        seconds: that each takes without a fault.
        checkout: copy of the checkout.
        most: time of the tests without a fault, beyond which no more are tried [s].
    """
    file = checkout / fault.path
    code = file.read_text(encoding="utf-8")
    tried, spent = 0, 0.0
    try:
        file.write_text(fault.planted(code), encoding="utf-8")
        for portion in portions(tests, seconds):
            planned = sum(seconds[test] for test in portion)
            if tried and spent + planned > most:
                break
            said = _chosen_outcome(checkout, portion, START + SLOWDOWN * planned)
            tried, spent = tried + len(portion), spent + planned
            if said.verdict != SURVIVED:
                return said, tried
    finally:
        file.write_text(code, encoding="utf-8")
    return Said(SURVIVED), tried


def _chosen_outcome(checkout: Path, tests: Sequence[str], limit: float) -> Said:
    """Return what some tests say in a copy of the checkout."""
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(tests, file)
        file.flush()
        code = "import sys; from bench.mutation import run_chosen; from pathlib import Path; "
        code += "sys.exit(run_chosen(Path(sys.argv[1])))"
        return _said([sys.executable, "-c", code, file.name], checkout, limit)


def try_drawn(chosen: Sequence[Fault], folder: Path, results: Path, most: float) -> int:
    """Try drawn faults, write each verdict as a line of JSON, print the survivors.

    Faults that stand in the results already are not tried again.

    Args:
        chosen: the faults.
        folder: where `bench/executed_lines.py` has left its record.
        results: file of the verdicts.
        most: time of the tests of one fault, beyond which no more are tried [s].
    """
    from bench.executed_lines import read
    from bench.line_tests import LineTests

    known = results.read_text(encoding="utf-8").splitlines() if results.exists() else []
    verdicts = {said["fault"]: said["verdict"] for said in map(json.loads, known)}
    executed = read(folder)
    with tempfile.TemporaryDirectory() as place, results.open("a", encoding="utf-8") as file:
        checkout = copy_of_checkout(Path(place))
        tests_of = LineTests(executed, checkout)
        for fault in chosen:
            name = f"{fault} (byte {fault.start})"
            if name in verdicts:
                continue
            tests = tests_of(fault.path, fault.line)
            said, tried = verdict(fault, tests, executed.seconds, checkout, most)
            verdicts[name] = said.verdict
            line = {"fault": name, **said._asdict(), "tried": tried, "tests": len(tests)}
            file.write(json.dumps(line, ensure_ascii=False) + "\n")
            file.flush()
            print(
                f"{time.strftime('%H:%M:%S')}  {said.verdict:18}  {name}  {said.test}", flush=True
            )
    survivors = [name for name, said in verdicts.items() if said == SURVIVED]
    print(f"{len(verdicts) - len(survivors)} of {len(verdicts)} caught; survivors:")
    print(*(f"  {name}" for name in survivors), sep="\n")
    return int(bool(survivors))


def main(arguments: Sequence[str] | None = None) -> int:
    """Try the faults and print the survivors; return 1 if there are any."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", default=[""], help="those whose file or text has one")
    parser.add_argument("--ranks", type=int, help="those whose tests run on so many ranks")
    parser.add_argument("--limit", type=float, default=600.0, help="for the tests of one [s]")
    parser.add_argument("--draw", type=int, help="number of faults drawn at random in their place")
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument("--results", type=Path, default=Path("drawn.jsonl"), help="of the draw")
    parser.add_argument("--most", type=float, default=math.inf, help="of tests of one drawn [s]")
    parser.add_argument("--lines", type=Path, help="record of executed lines, for the draw")
    given = parser.parse_args(arguments)
    if given.draw:
        from bench.drawn_faults import drawn
        from bench.executed_lines import FOLDER

        chosen = drawn(given.draw, given.seed)
        return try_drawn(chosen, given.lines or FOLDER, given.results, given.most)
    listed = [
        mutant
        for mutant in mutants()
        if any(text in str(mutant) for text in given.only) and given.ranks in (None, mutant.ranks)
    ]
    counts: Counter[tuple[str, bool]] = Counter()
    survivors = []
    with tempfile.TemporaryDirectory() as folder:
        checkout = copy_of_checkout(Path(folder))
        for mutant, said in tried(listed, checkout, given.limit, {}):
            print(f"{time.strftime('%H:%M:%S')}  {said:18}  {mutant}", flush=True)
            room = mutant.path.rpartition("/")[0].removeprefix("castx/").partition("/")[0]
            counts[room, said in (CAUGHT, HANGS)] += 1
            if said not in (CAUGHT, HANGS):
                survivors.append(mutant)
    for room in sorted({name for name, _ in counts}):
        caught = counts[room, True]
        print(f"{room:12} {caught:4} of {caught + counts[room, False]:4} caught")
    print(f"{len(listed) - len(survivors)} of {len(listed)} caught; survivors:")
    print(*(f"  {mutant}" for mutant in survivors), sep="\n")
    return int(bool(survivors))


if __name__ == "__main__":
    sys.exit(main())
