"""Do the tests notice a small fault in the code?

    bin/with-fenicsx python3 bench/mutation.py [--only TEXT …] [--ranks NUMBER] [--limit SECONDS]
    bin/with-fenicsx python3 bench/mutation.py --draw NUMBER [--seed NUMBER]

Plants the faults of bench/mutants.toml one after the other in a copy of this checkout, runs the
tests that should notice, and prints those that no test did. A fault replaces one line or a part of
it: a sign, a factor, a threshold, a tolerance, a default. A fault with `ranks = 2` leaves out what
the ranks owe each other; its tests run under mpirun, and ranks that wait for ever have caught it.

With --draw the faults come from bench/drawn_faults.py instead: --draw 400 --seed 1.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from bench.drawn_faults import Fault

CHECKOUT = Path(__file__).resolve().parent.parent
LIST = CHECKOUT / "bench" / "mutants.toml"
COPIED = ("castx", "forms", "meshes", "tests", "docs", "demos", "bench", "pyproject.toml")
SURVIVED, CAUGHT, HANGS = "survived", "caught", "caught (too slow)"
UNTRIED = "tests fail anyway"
UNINSTALLED = (
    "import sys; "
    "sys.meta_path[:] = [f for f in sys.meta_path if 'editable' not in str(f.__module__)]; "
)
"""Python code that forgets the checkout that is installed, so that the folder it runs in counts."""
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


class Planted(NamedTuple):
    """A drawn fault, and the tests that should notice on one rank."""

    fault: Fault
    tests: tuple[str, ...]
    ranks: int = 1

    @property
    def path(self) -> str:
        """Path of the file, relative to the checkout."""
        return self.fault.path

    def planted(self, code: str) -> str:
        """Return the code with the fault."""
        return self.fault.planted(code)


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
    code = "import castx.errors as a, castx.forms.heat as b; print(a.__file__, b.__file__)"
    command = [sys.executable, "-c", UNINSTALLED + code]
    found = subprocess.run(command, cwd=target, capture_output=True, text=True)
    if found.stdout.count(str(target)) != 2:
        raise RuntimeError(f"the copy is not what is imported: {found.stdout}{found.stderr}")
    return target


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
    code = UNINSTALLED + "import pytest; sys.exit(pytest.main(sys.argv[1:]))"
    command = [sys.executable, "-B", "-c", code, "-x", "-q", "--all", "-p", "no:cacheprovider"]
    launch = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    environment = {"OMPI_MCA_mpi_yield_when_idle": "1", **os.environ}
    with tempfile.TemporaryFile("w+") as said:
        running = subprocess.Popen(
            [*launch, *command, *tests], cwd=checkout, env=environment, stdout=said,
            stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            code_of_exit = running.wait(limit)
        except subprocess.TimeoutExpired:
            os.killpg(running.pid, signal.SIGKILL)
            running.wait()
            return HANGS
        said.seek(0)
        text = said.read()
    if code_of_exit in NO_TESTS and "Error" not in text:
        raise RuntimeError(f"pytest did not run {' '.join(tests)}:\n{text}")
    return SURVIVED if code_of_exit == 0 else CAUGHT


def tried(
    chosen: Sequence[Mutant] | Sequence[Planted],
    checkout: Path,
    limit: float,
    passes: dict[tuple[tuple[str, ...], int], bool],
) -> Iterator[tuple[Mutant | Planted, str]]:
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


def stages(path: str, whole: bool) -> list[tuple[str, ...]]:
    """Return the tests that try a file one after the other: its own, its room's, all of them.

    Args:
        path: of the file, relative to the checkout.
        whole: whether all tests are tried in the end.
    """
    folder, _, name = path.rpartition("/")
    own, room = f"tests/{folder}/test_{name}", f"tests/{folder}"
    found: list[tuple[str, ...]] = [(test,) for test in (own, room) if (CHECKOUT / test).exists()]
    return found + [("tests",)] * whole


def try_drawn(chosen: Sequence[Fault], results: Path, limit: float, whole: bool) -> int:
    """Try drawn faults, write each verdict as a line of JSON, print the survivors.

    Faults that stand in the results already are not tried again.
    """
    known = results.read_text(encoding="utf-8").splitlines() if results.exists() else []
    verdicts = {said["fault"]: said["verdict"] for said in map(json.loads, known)}
    passes: dict[tuple[tuple[str, ...], int], bool] = {}
    with tempfile.TemporaryDirectory() as folder, results.open("a", encoding="utf-8") as file:
        checkout = copy_of_checkout(Path(folder))
        for fault in chosen:
            name = f"{fault} (byte {fault.start})"
            if name in verdicts:
                continue
            verdict = SURVIVED
            for tests in stages(fault.path, whole):
                mutant = Planted(fault, tests)
                verdict = next(said for _, said in tried([mutant], checkout, limit, passes))
                if verdict in (CAUGHT, HANGS):
                    break
            verdicts[name] = verdict
            file.write(json.dumps({"fault": name, "verdict": verdict}) + "\n")
            file.flush()
            print(f"{time.strftime('%H:%M:%S')}  {verdict:18}  {name}", flush=True)
    survivors = [name for name, said in verdicts.items() if said not in (CAUGHT, HANGS)]
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
    parser.add_argument("--whole", action="store_true", help="try all tests on what survives")
    given = parser.parse_args(arguments)
    if given.draw:
        from drawn_faults import drawn  # beside this script

        return try_drawn(
            drawn(given.draw, given.seed), given.results, given.limit, given.whole
        )
    chosen = [
        mutant
        for mutant in mutants()
        if any(text in str(mutant) for text in given.only) and given.ranks in (None, mutant.ranks)
    ]
    counts: Counter[tuple[str, bool]] = Counter()
    survivors = []
    with tempfile.TemporaryDirectory() as folder:
        checkout = copy_of_checkout(Path(folder))
        for mutant, said in tried(chosen, checkout, given.limit, {}):
            print(f"{time.strftime('%H:%M:%S')}  {said:18}  {mutant}", flush=True)
            room = mutant.path.rpartition("/")[0].removeprefix("castx/").partition("/")[0]
            counts[room, said in (CAUGHT, HANGS)] += 1
            if said not in (CAUGHT, HANGS):
                survivors.append(mutant)
    for room in sorted({name for name, _ in counts}):
        caught = counts[room, True]
        print(f"{room:12} {caught:4} of {caught + counts[room, False]:4} caught")
    print(f"{len(chosen) - len(survivors)} of {len(chosen)} caught; survivors:")
    print(*(f"  {mutant}" for mutant in survivors), sep="\n")
    return int(bool(survivors))


if __name__ == "__main__":
    sys.exit(main())
