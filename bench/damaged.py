"""Damaged results folders and absurd numbers: does anything end in a traceback, or never?

    bin/with-fenicsx python3 bench/damaged.py [--seed S] [--folders N] [--numbers N] [--limit T]

Runs a short case once and damages copies of its folder, one or two files each: cut short, emptied,
bytes flipped, lines lost or doubled, numbers or keys replaced, taken away, another file in its
place. Each is asked for by `castx report`, `castx export` and `castx run --restart`. Then runs the
case with one of its numbers absurd. Each command has its own process and a limit. Right is an end
with a known exit code and without a traceback; a run that still steps when its time is up is
counted by itself.
"""

from __future__ import annotations

import argparse
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent.parent))

from tests.castx.mutations import BASE, leaves, toml

CASE: dict[str, Any] = {
    **BASE,
    "time": {"end": 5, "largest_step": 1},
    "output": {"checkpoint": "2 s", "fields": ["temperature", "gap"]},
}
KNOWN = (0, 1, 2, 3)
"""Exit codes of castx: done, failed as said, refused, not converged."""
ABSURD = (0.0, -1.0, 1e-300, 1e-12, -1e-12, 1e12, -1e12, 1e30, 1e300, 1e-30, -273.16, 1e6, 1e-6)
Damage = Callable[[random.Random, bytes], bytes]


def cut(rng: random.Random, content: bytes) -> bytes:
    """Lose the end of a file."""
    return content[: rng.randrange(len(content) + 1)]


def emptied(rng: random.Random, content: bytes) -> bytes:
    """Lose all of a file."""
    return b""


def flipped(rng: random.Random, content: bytes) -> bytes:
    """Change some bytes of a file."""
    found = bytearray(content)
    for _ in range(rng.randint(1, 8)):
        if found:
            found[rng.randrange(len(found))] = rng.randrange(256)
    return bytes(found)


def lines_lost(rng: random.Random, content: bytes) -> bytes:
    """Lose, double or exchange a line."""
    lines = content.split(b"\n")
    one, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    match rng.randrange(3):
        case 0:
            del lines[one]
        case 1:
            lines.insert(other, lines[one])
        case _:
            lines[one], lines[other] = lines[other], lines[one]
    return b"\n".join(lines)


def numbers_replaced(rng: random.Random, content: bytes) -> bytes:
    """Replace a number of a text."""
    found = list(re.finditer(rb"-?\d+\.?\d*(?:e[+-]?\d+)?", content))
    if not found:
        return content
    one = rng.choice(found)
    other = rng.choice((b"nan", b"-1", b"1e400", b"x", b"", b"99999999999", b"null", b"[]"))
    return content[: one.start()] + other + content[one.end() :]


def keys_lost(rng: random.Random, content: bytes) -> bytes:
    """Rename a word of a text, such as a key or a column."""
    found = list(re.finditer(rb"[a-z_]{3,}", content))
    if not found:
        return content
    one = rng.choice(found)
    return content[: one.start()] + b"other" + content[one.end() :]


DAMAGES: tuple[Damage, ...] = (
    cut, emptied, flipped, lines_lost, numbers_replaced, keys_lost, keys_lost, numbers_replaced,
)  # fmt: skip


def damage(rng: random.Random, folder: Path) -> list[str]:
    """Damage one or two files of a results folder and return what was done."""
    done = []
    for _ in range(rng.randint(1, 2)):
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        file = rng.choice(files)
        name = str(file.relative_to(folder))
        if rng.random() < 0.15:
            file.unlink()
            done.append(f"{name}: taken away")
        elif rng.random() < 0.1:
            shutil.copy(rng.choice(files), folder / "other")
            (folder / "other").replace(file)
            done.append(f"{name}: another file in its place")
        else:
            how = rng.choice(DAMAGES)
            file.write_bytes(how(rng, file.read_bytes()))
            done.append(f"{name}: {how.__name__}")
    return done


def absurd(rng: random.Random) -> tuple[dict[str, Any], str]:
    """Return the case with one absurd number, and which."""
    numbers = [path for path in leaves(CASE) if _is_number(_at(CASE, path))]
    path, value = rng.choice(numbers), rng.choice(ABSURD)
    data = deepcopy(CASE)
    _at(data, path[:-1])[path[-1]] = value
    return data, f"{'.'.join(map(str, path))} = {value:g}"


def _at(data: Any, path: Sequence[str | int]) -> Any:
    for step in path:
        data = data[step]
    return data


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def outcome(arguments: Sequence[str], limit: float) -> tuple[str, str]:
    """Return how a command of castx ended, "" if rightly, and the end of what it said."""
    command = [sys.executable, "-m", "castx", *arguments]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=limit, check=False,
            cwd=Path(__file__).parent.parent,
        )  # fmt: skip
    except subprocess.TimeoutExpired as late:
        said = b"".join(part for part in (late.stdout, late.stderr) if part).decode()
        return ("steps" if re.search(r"\bstep [1-9]", said) else "no end"), said[-300:]
    said = done.stdout + done.stderr
    if "Traceback" in said:
        return "traceback", said[-1500:]
    return ("" if done.returncode in KNOWN else f"exit code {done.returncode}"), said[-300:]


def folders(rng: random.Random, count: int, root: Path, limit: float) -> Iterator[tuple[str, ...]]:
    """Yield what was damaged, asked and found, for each command."""
    case = root / "case.toml"
    case.write_text(toml(CASE))
    whole = root / "whole"
    verdict, said = outcome(["run", str(case), "--output", str(whole)], 10 * limit)
    if verdict or not (whole / "run.json").is_file():
        raise RuntimeError(f"the whole run did not end: {verdict} {said}")
    for number in range(count):
        told = ""
        for command in ("report", "export", "restart"):
            folder = root / f"damaged-{number}"
            shutil.rmtree(folder, ignore_errors=True)
            shutil.copytree(whole, folder)
            told = "; ".join(damage(random.Random(f"{rng.random()}"), folder))
            asked = {
                "report": ["report", str(folder)],
                "export": ["export", str(folder), "--to", "calculix"],
                "restart": ["run", str(case), "--output", str(folder), "--restart"],
            }[command]
            yield told, command, *outcome(asked, limit)
            shutil.rmtree(folder, ignore_errors=True)


def numbers(rng: random.Random, count: int, root: Path, limit: float) -> Iterator[tuple[str, ...]]:
    """Yield which number is absurd, and what a run of it came to."""
    for number in range(count):
        data, told = absurd(rng)
        case = root / f"absurd-{number}.toml"
        case.write_text(toml(data))
        output = root / f"absurd-{number}"
        yield told, "run", *outcome(["run", str(case), "--output", str(output)], limit)
        shutil.rmtree(output, ignore_errors=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Damage, draw and run; return 1 when something ended as it should not."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folders", type=int, default=40)
    parser.add_argument("--numbers", type=int, default=60)
    parser.add_argument("--limit", type=float, default=60.0, help="of each command [s]")
    wanted = parser.parse_args(arguments)
    rng, root = random.Random(wanted.seed), Path(tempfile.mkdtemp(prefix="damaged-"))
    found: Counter[str] = Counter()
    for made, count in ((folders, wanted.folders), (numbers, wanted.numbers)):
        for told, command, verdict, said in made(rng, count, root, wanted.limit):
            found[verdict or "right"] += 1
            if verdict:
                print(f"{verdict}: {command}: {told}\n{said}\n", flush=True)
    print(f"seed {wanted.seed}: {dict(found)}")
    shutil.rmtree(root, ignore_errors=True)
    return int(set(found) - {"right", "steps"} != set())


if __name__ == "__main__":
    sys.exit(main())
