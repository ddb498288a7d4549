"""Cost of commands that do little: what do imports, small reports and a single solve take?

    bin/with-fenicsx python3 bench/start_up.py [NAME ...] [--times N] [--imports]

Runs commands in processes of their own, each N times (5 unless said otherwise), and prints the
least CPU seconds of each with those of all its own processes, from the first import to the end. The
first start of each, which compiles forms and bytecode, does not count. With --imports it prints for
each the modules whose own import took longest instead.

    version     castx --version
    check       castx check of a plate with a few cells
    imports     what `castx run` imports, and the end of the process
    run         castx run of the same plate, one step
    report      castx report of demos/cylinder.toml, which has been run before
    blocks      castx run of two elastic blocks in space, 8,112 nodes and 169 pairs, one step
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

CASE = """
[geometry]
generator = "stacked_blocks"
model = "{model}"
upper = {upper}
base = {base}
size = "{size}"
cells = "quadrilaterals"
[[bodies]]
name = "upper"
material = "{material}"
temperature = 500
law = "thermo-elastic"
[[bodies]]
name = "base"
material = "steel-H13"
temperature = 200
law = "thermo-elastic"
[[interfaces]]
bodies = ["upper", "base"]
heat = {{ law = "limited", closed = 2000, gas_conductivity = 0.05 }}
[[boundaries]]
on = "base/bottom"
displacement = {{ normal = 0 }}
[[boundaries]]
on = "upper/top"
pressure = "10 MPa"
{planes}
[time]
end = 1
fixed_step = 1
"""
PLANE = '[[boundaries]]\non = "{body}/symmetry-{axis}"\ndisplacement = {{ normal = 0 }}\n'
CASTX = ("-m", "castx")
CYLINDER = Path(__file__).parent.parent / "demos" / "cylinder.toml"
IMPORTS = """
import gc
import castx.command.cli
from castx.imports import kept
with kept():
    import castx.command.run
gc.freeze()
"""
SLOWEST = 25
"""Modules that --imports prints."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure the commands and print a line for each."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        known = commands(folder)
        parser.add_argument("names", nargs="*", choices=[*known, []], metavar="NAME")
        parser.add_argument("--times", type=int, default=5)
        parser.add_argument("--imports", action="store_true", help="name the slowest imports")
        wanted = parser.parse_args(arguments)
        environment = dict(os.environ) | {"PYTHONPYCACHEPREFIX": str(folder / "bytecode")}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        if "report" in (wanted.names or known):
            seconds([*CASTX, "run", str(CYLINDER), "--output", str(folder / "report")], environment)
        for name in wanted.names or known:
            seconds(known[name], environment)
            if wanted.imports:
                say(name, *slowest(known[name], environment))
            else:
                best = min(seconds(known[name], environment) for _ in range(wanted.times))
                say(f"{name:10}{best:6.2f} CPU s")


def commands(folder: Path) -> Mapping[str, Sequence[str]]:
    """Return the arguments of Python for each command.

    Args:
        folder: for cases and results.
    """
    plate, blocks = folder / "plate.toml", folder / "blocks.toml"
    plate.write_text(case("plane-strain", "[0.02, 0.01]", "[0.04, 0.01]", "2 mm", "AlSi7Mg"))
    blocks.write_text(
        case("3d", "[0.048, 0.046, 0.048]", "[0.048, 0.046, 0.048]", "2 mm", "steel-H13")
    )
    return {
        "version": [*CASTX, "--version"],
        "check": [*CASTX, "check", str(plate)],
        "imports": ["-c", IMPORTS],
        "run": [*CASTX, "run", str(plate), "--output", str(folder / "plate")],
        "report": [*CASTX, "report", str(folder / "report")],
        "blocks": [*CASTX, "run", str(blocks), "--output", str(folder / "blocks")],
    }


def case(model: str, upper: str, base: str, size: str, material: str) -> str:
    """Return a case of two elastic blocks, their symmetric half or quarter."""
    axes = "xy" if model == "3d" else "x"
    planes = "".join(
        PLANE.format(body=body, axis=axis) for body in ("upper", "base") for axis in axes
    )
    return CASE.format(
        model=model, upper=upper, base=base, size=size, material=material, planes=planes
    )


def seconds(arguments: Sequence[str], environment: Mapping[str, str]) -> float:
    """Return the CPU seconds of a process of Python and of those that it starts.

    Raises:
        SystemExit: it failed.
    """
    process = subprocess.Popen(
        [sys.executable, *arguments],
        env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(arguments)} ended with status {status}")
    return usage.ru_utime + usage.ru_stime


def slowest(arguments: Sequence[str], environment: Mapping[str, str]) -> list[str]:
    """Return a line for each of the modules whose own import took longest, the slowest first."""
    done = subprocess.run(
        [sys.executable, "-X", "importtime", *arguments],
        env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True,
    )  # fmt: skip
    own: Counter[str] = Counter()
    for line in done.stderr.splitlines():
        parts = line.removeprefix("import time:").split("|")
        if len(parts) == 3 and parts[0].strip().isdigit():
            own[parts[2].strip()] += int(parts[0])
    found = [f"{sum(own.values()) / 1e3:8.1f} ms  all"]
    return found + [f"{time / 1e3:8.1f} ms  {name}" for name, time in own.most_common(SLOWEST)]


def say(*lines: str) -> None:
    """Print lines at once."""
    sys.stdout.write("\n".join(lines) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
