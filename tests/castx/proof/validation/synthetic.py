"""A fully known experiment: no experiment, but the exact cooling of a lumped body, disturbed.

T = T_a + (T_0 - T_a) exp(-h A t/(ρ c V)), sampled every 2 s with a fixed disturbance of known root
mean square, as a logger would write it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

START, AMBIENT, COEFFICIENT, LENGTH, CAPACITY = 600.0, 100.0, 500.0, 0.01, 2.6e6
END = 40.0
FACTS = """
title = "A lumped body cools"
source = "synthetic: the exact cooling of a lumped body with a fixed disturbance"
summary = "No experiment; it shows that the comparison works."
digits = [{ name = "temperature at the start", value = 600, unit = "°C", uncertainty = 1 }]
[[curves]]
of = "middle.temperature"
uncertainty = 2.5
source = "computed by hand"
"""
CASE = f"""
[geometry]
generator = "slab"
model = "plane-strain"
length = {LENGTH}
width = 0.005
size = 0.005
[materials.block]
density = 1.0
heat_capacity = {CAPACITY}
conductivity = 1e5
[[bodies]]
name = "casting"
material = "block"
temperature = {START}
[[boundaries]]
on = "casting/far"
heat = {{ type = "convection", coefficient = {COEFFICIENT}, ambient = {AMBIENT} }}
[[probes]]
name = "middle"
body = "casting"
at = [0.005, 0.0025]
quantities = ["temperature"]
[[measurements]]
of = "middle.temperature"
file = "logger.csv"
column = "T [K]"
unit = "K"
time = "t"
[coupling]
scheme = "thermal"
[time]
end = {END}
fixed_step = 0.1
first_step = 0.1
"""
TIMES = np.arange(2.0, END - 1.0, 2.0)
DISTURBANCE = np.where(np.arange(len(TIMES)) % 2 == 0, 2.0, -2.0)
DISTURBANCE[5] = -3.0


def exact(time):
    """Return the temperature of the body [°C]."""
    rate = COEFFICIENT / (CAPACITY * LENGTH)
    return AMBIENT + (START - AMBIENT) * np.exp(-rate * time)


def write_experiment(folder: Path) -> Path:
    """Write the files of the experiment and return its folder."""
    folder.mkdir(parents=True)
    (folder / "experiment.toml").write_text(FACTS)
    (folder / "case.toml").write_text(CASE)
    measured = exact(TIMES) + DISTURBANCE + 273.15
    rows = [f"{t},{T}" for t, T in zip(TIMES, measured, strict=True)]
    (folder / "logger.csv").write_text("\n".join(["t,T [K]", *rows]))
    return folder
