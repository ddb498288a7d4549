"""Heat of a plate that freezes from its wall, on nodes of a fine grid in implicit Euler steps.

The plate is that of `castx/proof/verification/solids/freezing_plate.py`, in its dimensionless
quantities.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import solve_banded

from castx.arrays import FloatArray
from castx.proof.verification.solids.freezing_plate import Plate


def control_volumes(cells: int) -> FloatArray:
    found = np.full(cells + 1, 1.0 / cells)
    found[[0, -1]] *= 0.5
    return found


def freezing(
    plate: Plate, cells: int, ambient: Callable[[float], float] = lambda time: -1.0
) -> tuple[FloatArray, FloatArray]:
    """Return temperatures and solid fractions of the nodes, both (steps + 1, cells + 1).

    Implicit Euler steps, by Newton's method that goes back where it must.

    Args:
        plate: in its steps.
        cells: of the grid.
        ambient: temperature of what cools or heats the wall, over time; taken amid the steps.

    Raises:
        AssertionError: a step has not converged.
    """
    latent, step = 1.0 / plate.stefan, plate.end / plate.steps
    states: list[FloatArray] = [np.full(cells + 1, latent)]
    for number in range(plate.steps):
        states.append(_after(states[-1], ambient((number + 0.5) * step), step, plate))
    found = np.array(states)
    return _temperature(found, latent), np.clip(1.0 - found / latent, 0.0, 1.0)


def _temperature(enthalpy: FloatArray, latent: float) -> FloatArray:
    found: FloatArray = np.minimum(enthalpy, 0.0) + np.maximum(enthalpy - latent, 0.0)
    return found


def _after(start: FloatArray, outside: float, step: float, plate: Plate) -> FloatArray:
    """Return the enthalpies of the nodes after a step."""
    cells, latent, biot = len(start) - 1, 1.0 / plate.stefan, plate.biot
    volumes = control_volumes(cells)
    inner = np.full(cells, float(cells))
    at_nodes = np.concatenate([[biot], inner]) + np.append(inner, 0.0)

    def residual(enthalpy: FloatArray) -> FloatArray:
        temperature = _temperature(enthalpy, latent)
        flux = np.diff(temperature) * cells
        gained = np.append(flux, 0.0) - np.concatenate([[0.0], flux])
        gained[0] += biot * (outside - temperature[0])
        return np.asarray(volumes * (enthalpy - start) / step - gained)

    enthalpy, wrong = start, residual(start)
    for _ in range(1000):
        if np.abs(wrong).max() < 1e-11 * (1.0 + biot):
            return enthalpy
        slope = ((enthalpy <= 0.0) | (enthalpy >= latent)).astype(float)
        bands = np.zeros((3, cells + 1))
        bands[1] = volumes / step + at_nodes * slope
        bands[0, 1:], bands[2, :-1] = -inner * slope[1:], -inner * slope[:-1]
        change, size = solve_banded((1, 1), bands, wrong), np.linalg.norm(wrong)
        for factor in 0.5 ** np.arange(30):
            trial = enthalpy - factor * change
            if np.linalg.norm(residual(trial)) < (1.0 - 1e-4 * factor) * size:
                break
        enthalpy, wrong = trial, residual(trial)
    raise AssertionError("the heat of the reference has not converged")
