"""Does a long run need more memory the longer it lasts?

    bin/with-fenicsx python3 bench/memory.py [STEPS]

Runs a small coupled casting over so many small steps (1000 unless said otherwise) for each contact
method and linear solver, with checkpoints and field output, and prints the resident set after the
first tenth and at the end. It should grow by less than 1 %.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from castx.contact.methods.registry import names

STATM = Path("/proc/self/statm")
PAGE = 4096
METHODS = names(lambda method: method.fallback)
KINDS = [(method, linear) for method in METHODS for linear in ("direct", "iterative")]
CASE = """
[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
radius = "30 mm"
height = "60 mm"
wall = "25 mm"
size = "5 mm"
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
contact = {{ method = "{method}" }}
heat = {{ law = "limited", closed = 2300, gas_conductivity = 0.05 }}
[[boundaries]]
on = "casting/base"
displacement = {{ normal = 0 }}
[[boundaries]]
on = "mould/base"
displacement = {{ normal = 0 }}
[time]
end = {end}
fixed_step = 0.02
first_step = 0.02
largest_step = 0.02
heat_substeps = 1
[solver]
linear = "{linear}"
[output]
every = {every}
checkpoint = {every}
"""


def case_text(method: str, linear: str, steps: int) -> str:
    """Return the case of so many steps."""
    end = 0.02 * steps
    return CASE.format(method=method, linear=linear, end=end, every=end / 10)


def measure(case: Path, folder: Path, steps: int) -> tuple[float, float]:
    """Run a case in this process; return the resident set [MB] after a tenth and at the end."""
    from castx.command import progress
    from castx.command import run as running

    sizes: list[float] = []

    def note(self: object, snapshot: object) -> None:
        sizes.append(int(STATM.read_text().split()[1]) * PAGE / 1e6)

    progress.Progress.show = note  # type: ignore[method-assign]
    running.run(case, output=folder)
    return sizes[steps // 10], sizes[-1]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run each kind in a process of its own; return 1 when one grew by more than 1 %."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("steps", nargs="?", type=int, default=1000)
    parser.add_argument("--case", type=Path, help=argparse.SUPPRESS)
    asked = parser.parse_args(arguments)
    steps = asked.steps
    if asked.case is not None:  # in a process of its own, see below
        print(json.dumps(measure(asked.case, asked.case.with_suffix(""), steps)))
        return 0
    root, grown = Path(tempfile.mkdtemp(prefix="memory-")), False
    for method, linear in KINDS:
        case = root / f"{method}-{linear}.toml"
        case.write_text(case_text(method, linear, steps))
        command = [sys.executable, __file__, str(steps), "--case", str(case)]
        found = subprocess.run(command, capture_output=True, text=True, check=True)
        early, late = json.loads(found.stdout.splitlines()[-1])
        grown |= late > 1.01 * early
        print(
            f"{method:21s} {linear:10s} {early:7.1f} MB after {steps // 10} steps, {late:7.1f} MB "
            f"after {steps}: {100 * (late / early - 1):+.2f} %",
            flush=True,
        )
    return int(grown)


if __name__ == "__main__":
    sys.exit(main())
