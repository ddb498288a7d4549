"""Malformed case files and meshes: is each refused soon, with file, key and cure?

    bin/with-fenicsx python3 bench/malformed.py [REFUSALS] [--seed S]

Draws spoilt case files and meshes (tests/castx/mutations.py) until so many were refused (200 unless
said otherwise), all in one process, and prints how often what was at fault.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from hypothesis import HealthCheck, given, seed, settings
from hypothesis import strategies as st

sys.path.insert(0, str(Path(__file__).parent.parent))

from tests.castx.mutations import (
    Answer,
    answer,
    case_tables,
    case_texts,
    mesh_case,
    mesh_text,
    meshes,
)


class Captured:
    """What is written to standard output and errors, as pytest's capsys has it."""

    def __init__(self) -> None:
        self._out, self._err = io.StringIO(), io.StringIO()

    def readouterr(self) -> Any:
        """Return what was written since the last call."""
        found = SimpleNamespace(out=self._out.getvalue(), err=self._err.getvalue())
        for stream in (self._out, self._err):
            stream.seek(0)
            stream.truncate()
        return found

    def __enter__(self) -> Captured:
        self._stack = contextlib.ExitStack()
        self._stack.enter_context(contextlib.redirect_stdout(self._out))
        self._stack.enter_context(contextlib.redirect_stderr(self._err))
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()


def main(arguments: Sequence[str] | None = None) -> int:
    """Draw until enough were refused; return 1 when one was not as it should be."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("refusals", nargs="?", type=int, default=200)
    parser.add_argument("--seed", type=int, help="of the draw; else another one each time")
    asked = parser.parse_args(arguments)
    wanted = asked.refusals
    folder = Path(tempfile.mkdtemp(prefix="malformed-"))
    case, part = folder / "case.toml", folder / "part.msh"
    kinds = [("tables", case_tables(), case), ("texts", case_texts(), case)]
    for version in (4.1, 2.2):
        whole = mesh_text(folder / f"whole-{version}.msh", version)
        kinds.append((f"mesh {version}", meshes(whole), part))
    faulty = 0
    for kind, strategy, file in kinds:
        answers: list[tuple[Answer, bytes]] = []
        draw(kind, strategy, file, case, wanted, answers, asked.seed)
        codes = Counter(found.code for found, _ in answers)
        longest = max(found.seconds for found, _ in answers)
        print(f"{kind}: {len(answers)} drawn, exit codes {dict(codes)}, longest {longest:.2f} s")
        wrong: dict[str, tuple[Answer, bytes]] = {}
        for found, content in answers:
            for fault in found.faults(case):
                faulty += 1
                wrong.setdefault(f"{fault}: {found.text[-200:]}", (found, content))
        for number, (fault, (_, content)) in enumerate(wrong.items()):
            example = folder / f"{kind.replace(' ', '-')}-{number}"
            example.write_bytes(content)
            print(f"  {fault}\n    {example}")
    return int(faulty > 0)


def draw(
    kind: str,
    strategy: st.SearchStrategy[Any],
    file: Path,
    case: Path,
    wanted: int,
    answers: list[tuple[Answer, bytes]],
    number: int | None,
) -> None:
    """Draw files of one kind until enough were refused."""
    if kind.startswith("mesh"):
        case.write_text(mesh_case(file.name))

    @settings(
        max_examples=3 * wanted,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(strategy)
    def check(content: str | bytes) -> None:
        if sum(found.code == 2 for found, _ in answers) >= wanted:
            return
        raw = content.encode() if isinstance(content, str) else content
        file.write_bytes(raw)
        with captured:
            answers.append((answer(case, captured), raw))

    captured = Captured()
    (check if number is None else seed(number)(check))()


if __name__ == "__main__":
    sys.exit(main())
