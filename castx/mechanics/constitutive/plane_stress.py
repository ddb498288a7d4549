"""The strain ε_zz of plane stress, from σ_zz = 0 at every integration point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.errors import ConvergenceError
from castx.mechanics.constitutive.response import Response

MOST_ITERATIONS = 50
ROUNDING = 1e-13
NOTHING = 1e-16
"""Strain that is rounding of thermal strains of a few percent that have cancelled: a body that
returns to where it is free of stress has no other strain to compare with."""


def normal_strain(
    in_plane: FloatArray,
    guess: FloatArray,
    respond: Callable[[FloatArray], Response],
    mean_stress: Callable[[FloatArray], tuple[FloatArray, FloatArray]],
    held: BoolArray | None = None,
) -> FloatArray:
    """Return ε_zz with s_zz(ε_zz) + p(ε_zz) = 0 by Newton's method between bounds, shape (points,).

    Args:
        in_plane: strain with ε_zz = 0, shape (points, components).
        guess: ε_zz to start from, shape (points,).
        respond: the law, a function of the deviatoric strain.
        mean_stress: p and dp/dε_zz as a function of ε_zz.
        held: points that keep the guess, shape (points,); None: there are none.

    Raises:
        ConvergenceError: the iteration did not converge.
    """
    normal = guess.copy()
    lower, upper = np.full_like(normal, -np.inf), np.full_like(normal, np.inf)
    change = np.full_like(normal, np.inf)
    found = np.zeros(len(normal), dtype=bool) if held is None else held.copy()
    for _ in range(MOST_ITERATIONS):
        response = respond(deviatoric(with_normal(in_plane, normal)))
        mean, slope = mean_stress(normal)
        n = response.direction[:, 2]
        stiffness = 2 / 3 * response.isotropic + response.radial * n**2 + slope
        if response.beside is not None:
            stiffness += response.beside.radial * response.beside.direction[:, 2] ** 2
        stress = response.stress[:, 2] + mean
        found |= np.abs(stress) <= ROUNDING * (np.abs(mean) + np.abs(response.stress[:, 2]))
        # σ_zz grows with ε_zz. Where a point yields both ways, Newton's steps go to and fro.
        np.copyto(upper, normal, where=stress > 0)
        np.copyto(lower, normal, where=stress < 0)
        step = -stress / stiffness
        halved = np.isfinite(upper - lower) & (np.abs(step) > 0.5 * np.abs(change))
        step[halved] = 0.5 * (lower[halved] + upper[halved]) - normal[halved]
        change = np.where(found, 0.0, step)
        normal += change
        strain = np.abs(in_plane).max(axis=1) + np.abs(normal)
        found |= np.abs(change) <= ROUNDING * strain + NOTHING
        if found.all():
            return normal
    worst = int(np.argmax(np.abs(change)))
    raise ConvergenceError(
        f"plane stress was not found in {MOST_ITERATIONS} iterations: σ_zz = {stress[worst]:.3g} Pa"
    )


def with_normal(in_plane: FloatArray, normal: FloatArray) -> FloatArray:
    """Return strains with ε_zz, shape (points, components)."""
    strain = in_plane.copy()
    strain[:, 2] = normal
    return strain


def deviatoric(strain: FloatArray) -> FloatArray:
    """Return the deviatoric part of strains by components, shape (points, components)."""
    result = strain.copy()
    result[:, :3] -= strain[:, :3].mean(axis=1, keepdims=True)
    return result
