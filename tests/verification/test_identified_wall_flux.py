"""Flux through a wall by `castx identify` from steady temperatures inside a box, as a case file.

T = a y² + b x y + c x - a z² + c is harmonic, and k (b y + c) flows out through the wall x = 0. Its
flux is a table along y with five knots, the far face has its exact temperatures, the other four
their exact fluxes, all by formulas of the case file, and sensors lie between nodes at a tenth of
the depth. Source: Morelli et al., Int. J. Numer. Methods Eng. 122 (2021) 4541, with x and y
exchanged; field and data of ROMSOC/benchmarks-inverse-heat-transfer.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from castx.command.cli import execute
from castx.foundry.identification.covariance import deviations
from castx.input.toml_written import toml_text
from castx.studies.inverse.identify import RESULT
from castx.studies.runs import local
from tests.castx.studies.inverse.in_process import InProcess

pytestmark = pytest.mark.serial

CONDUCTIVITY, A, B, C = 3.0, 5.0, 10.0, 15.0
KNOTS = np.linspace(0.0, 1.0, 5)
FLUX = CONDUCTIVITY * (B * KNOTS + C)
"""Out of the wall at the knots [W/m²]."""
ALONG, ACROSS = (0.05, 0.29, 0.45, 0.61, 0.77, 0.95), (0.31, 0.57, 0.73)
SENSORS = [(0.1, y, z) for y in ALONG for z in ACROSS]
TIMES = np.arange(1.0, 13.0)
EXACT = f"{A}*y**2 + {B}*x*y + {C}*x - {A}*z**2 + {C}"
OTHERS = {
    "bottom": f"{-CONDUCTIVITY * B}*x",
    "top": f"{CONDUCTIVITY}*({2 * A} + {B}*x)",
    "back": "0",
    "front": f"{-2 * CONDUCTIVITY * A}",
}
"""Fluxes into the body through y = 0 and 1, z = 0 and 1."""


def exact(x, y, z):
    return A * y**2 + B * x * y + C * x - A * z**2 + C


def curve(k):
    return {"of": f"s{k}.temperature", "file": "measured.csv", "column": f"s{k}"}


def case_of(size, noise):
    """Return the case: a cube of little heat capacity, steady after a part of a step."""
    flux = {"of": "boundaries.0.heat.value", "name": "flux", "over": "y", "knots": KNOTS.tolist(),
            "scale": "linear", "start": -50.0, "difference": 1.0}  # fmt: skip
    given = {side: {"type": "flux", "value": {"formula": text}} for side, text in OTHERS.items()}
    wall = {"type": "flux", "value": -50.0}
    far = {"type": "temperature", "value": {"formula": EXACT}}
    return {
        "geometry": {"generator": "slab", "model": "3d", "length": 1.0, "width": 1.0, "depth": 1.0,
                     "size": size, "cells": "quadrilaterals"},
        "materials": {"solid": {"density": 1.0, "heat_capacity": 1.0,
                                "conductivity": CONDUCTIVITY}},
        "bodies": [{"name": "casting", "material": "solid", "temperature": {"formula": EXACT}}],
        "boundaries": [{"on": f"casting/{side}", "heat": heat}
                       for side, heat in {"wall": wall, "far": far, **given}.items()],
        "coupling": {"scheme": "thermal"},
        "time": {"end": float(TIMES[-1]), "fixed_step": 6.0},
        "output": {"fields": ["temperature"]},
        "probes": [{"name": f"s{k}", "body": "casting", "at": list(place),
                    "quantities": ["temperature"]} for k, place in enumerate(SENSORS)],
        "identify": {"curves": [{**curve(k), "noise": noise} for k in range(len(SENSORS))],
                     "unknowns": [flux]},
    }  # fmt: skip


def identified(folder, comm, size, noise, seed=None):
    """Return estimates and covariance that the command writes, of exact or noisy curves."""
    values = np.broadcast_to([exact(*place) for place in SENSORS], (len(TIMES), len(SENSORS)))
    if seed is not None:
        values = values + noise * np.random.default_rng(seed).normal(size=values.shape)
    heading = ",".join(["time", *(f"s{k}" for k in range(len(SENSORS)))])
    rows = np.column_stack([TIMES, values])
    np.savetxt(folder / "measured.csv", rows, delimiter=",", header=heading, comments="")
    case_file = folder / "wall.toml"
    case_file.write_text(toml_text(case_of(size, noise)))
    assert execute(["identify", str(case_file), "--output", str(folder / "study")], comm) == 0
    found = json.loads((folder / "study" / RESULT).read_text())
    return np.array([-one["value"] for one in found["estimates"]]), np.array(found["covariance"])


@pytest.fixture
def runs_here(comm, monkeypatch):
    """Let the command make its runs in this process."""
    monkeypatch.setattr(local, "LocalProcesses", lambda *_: InProcess(comm))


@pytest.mark.slow
def test_the_flux_without_and_with_noise(comm, tmp_path, runs_here):
    """Within 1 % at each knot by the error of the mesh, which falls, and scattered by noise.

    About what exact curves give: the misfit weighted by the covariance is χ² with five degrees of
    freedom.
    """
    coarse, covariance = identified(tmp_path, comm, 1.0 / 8.0, 0.2)
    fine, _ = identified(tmp_path, comm, 1.0 / 16.0, 0.2)
    errors = [np.abs(found / FLUX - 1.0).max() for found in (coarse, fine)]
    assert errors[1] < 0.01 and errors[1] < 0.5 * errors[0], errors
    noisy, same = identified(tmp_path, comm, 1.0 / 8.0, 0.2, seed=1)
    np.testing.assert_allclose(same, covariance, rtol=1e-3)
    off = noisy - coarse
    assert np.all(np.abs(off) < 3.5 * deviations(covariance))
    assert 0.3 < off @ np.linalg.solve(covariance, off) < 20.0
