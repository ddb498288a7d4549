"""A metal that melts and yields, and steps of its law at points, for the tests beside."""

from __future__ import annotations

from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.materials.material import Material
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Conditions, Law
from castx.mechanics.constitutive.response import respond, secant_softening
from tests.elastic_bodies import elastic

YOUNG, POISSON = 60e9, 0.3
G, K = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
YIELD, VISCOSITY, COHERENCY = 20e6, 2e6, 0.6
SHRINKAGE = 0.05
FLOWING = {"yield_stress": YIELD, "hardening": 1e9, "kinematic_hardening": 2e9}


def metal(**liquid: Any) -> Material:
    """Return an aluminium-like material, with a liquid where one is given."""
    melting: dict[str, Any] = {}
    if liquid:
        melting = {"solidus": 560.0, "liquidus": 610.0, "latent_heat": 4e5, "liquid": liquid}
    return elastic(YOUNG, POISSON, 2e-5, solidification_shrinkage=SHRINKAGE * bool(liquid),
                   **FLOWING, **melting)  # fmt: skip


NEWTONIAN = {"viscosity": VISCOSITY, "coherency": COHERENCY}
NORTON = {"model": "norton", "coefficient": 1e-20, "exponent": 3.0, "coherency": COHERENCY}


def at(
    points: IntegrationPoints,
    law: Law,
    solid_fraction: float,
    temperature=560.0,
    step=0.5,
    start: float | None = None,
) -> Conditions:
    """Return the coefficients of a step to a solid fraction, from another one at its start."""
    nodes = points.cell_nodes.max() + 1
    temperatures = np.full(nodes, temperature)
    before = None if start is None else law.nodes(temperatures, np.full(nodes, start))
    return law.conditions(points, temperatures, np.full(nodes, solid_fraction), step, before)


def strains(points: IntegrationPoints, size: float, seed: int = 0) -> FloatArray:
    random = np.random.default_rng(seed).normal(size=(points.count, 4))
    random[:, :3] -= random[:, :3].mean(axis=1, keepdims=True)
    return size * random


def after(points, conditions: Conditions, start: PointHistory, strain: FloatArray) -> PointHistory:
    """Return the history that a step leaves."""
    found = respond(conditions, start, strain)
    softening = secant_softening(found, conditions, start, strain)
    shape = start.shape + conditions.shape
    return PointHistory(*found.strains, strain, softening, shape, found.mush)
