"""Commands on a small coupled case: its file, processes of their own, and what was printed."""

from __future__ import annotations

import os
import subprocess
import time
import tomllib
from collections.abc import Callable
from typing import Any

from mpi4py import MPI

import pytest

CASE = """
[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
radius = "20 mm"
height = "40 mm"
wall = "10 mm"
size = "5 mm"
[[bodies]]
name = "casting"
material = "Al-pure"
temperature = 670
[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 200
formulation = "displacement"
[[interfaces]]
bodies = ["casting", "mould"]
heat = { law = "limited", closed = 2300, gas_conductivity = 0.05 }
[[boundaries]]
on = "casting/base"
displacement = { normal = 0 }
[[boundaries]]
on = "mould/base"
displacement = { normal = 0 }
[time]
end = 0.2
first_step = 0.05
largest_step = 0.1
"""

ALLOY_CASE = CASE.replace("Al-pure", "AlSi7Mg")


def content_of(text: str) -> dict[str, Any]:
    """Return keys and values of a case file."""
    return tomllib.loads(text)


def said(comm: MPI.Intracomm, capsys: pytest.CaptureFixture[str]) -> str:
    """Return what rank 0 has printed, output and errors, with blanks instead of line ends."""
    captured = capsys.readouterr()
    return comm.bcast(" ".join((captured.out + captured.err).split()))


def start(*arguments: str) -> subprocess.Popen[str]:
    """Start castx in a process of its own, which must not take itself for a rank of this run."""
    foreign = ("PMIX", "OMPI_", "PRTE", "PMI_")
    kept = {key: value for key, value in os.environ.items() if not key.startswith(foreign)}
    kept |= {key: value for key, value in os.environ.items() if "_MCA_" in key or "ALLOW" in key}
    return subprocess.Popen(
        arguments, env=kept, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def wait_for(
    condition: Callable[[], bool], process: subprocess.Popen[str], seconds: float = 120.0
) -> None:
    """Wait until something is so while a process lives; kill it when that takes too long."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end or process.poll() is not None:
            process.kill()
            raise AssertionError(process.communicate())
        time.sleep(0.1)
