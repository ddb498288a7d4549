"""Do the tests notice a small fault in the code?

    bin/with-fenicsx python3 bench/mutation.py [--only TEXT …] [--limit SECONDS]

Plants the faults of bench/mutants.toml one after the other in a copy of this checkout, runs the
tests that should notice, and prints those that no test did. A fault replaces one line or a part of
it: a sign, a factor, a threshold, a tolerance, a default.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

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
    """

    path: str
    text: str
    replacement: str
    tests: tuple[str, ...]

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
        Mutant(file["path"], text, replacement, tuple(file["tests"]))
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


def outcome(checkout: Path, tests: Sequence[str], limit: float) -> str:
    """Return what the tests say in a copy of the checkout."""
    code = UNINSTALLED + "import pytest; sys.exit(pytest.main(sys.argv[1:]))"
    command = [sys.executable, "-B", "-c", code, "-x", "-q", "-p", "no:cacheprovider", *tests]
    try:
        ended = subprocess.run(
            command, cwd=checkout, timeout=limit, capture_output=True, text=True
        )
    except subprocess.TimeoutExpired:
        return HANGS
    if ended.returncode in NO_TESTS and "Error" not in ended.stdout:
        raise RuntimeError(f"pytest did not run {' '.join(tests)}:\n{ended.stdout}{ended.stderr}")
    return SURVIVED if ended.returncode == 0 else CAUGHT


def tried(chosen: Sequence[Mutant], checkout: Path, limit: float) -> Iterator[tuple[Mutant, str]]:
    """Yield each fault and what the tests say of it; they have to pass without any."""
    passes: dict[tuple[str, ...], bool] = {}
    for mutant in chosen:
        if mutant.tests not in passes:
            passes[mutant.tests] = outcome(checkout, mutant.tests, limit) == SURVIVED
        if not passes[mutant.tests]:
            yield mutant, UNTRIED
            continue
        file = checkout / mutant.path
        code = file.read_text(encoding="utf-8")
        file.write_text(mutant.planted(code), encoding="utf-8")
        try:
            yield mutant, outcome(checkout, mutant.tests, limit)
        finally:
            file.write_text(code, encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> int:
    """Try the faults and print the survivors; return 1 if there are any."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", default=[""], help="those whose file or text has one")
    parser.add_argument("--limit", type=float, default=600.0, help="for the tests of one [s]")
    given = parser.parse_args(arguments)
    chosen = [m for m in mutants() if any(text in str(m) for text in given.only)]
    counts: Counter[tuple[str, bool]] = Counter()
    survivors = []
    with tempfile.TemporaryDirectory() as folder:
        checkout = copy_of_checkout(Path(folder))
        for mutant, said in tried(chosen, checkout, given.limit):
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
