"""How fast temperatures change at the start of a step, before any step is taken."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.heat.balance import HeatBalance
from castx.heat.body import ThermalBody

SAMPLES = 9
"""Temperatures between which heat capacities are compared: that of melting counts for nothing."""


def time_to_change(balance: HeatBalance, enthalpies: FloatArray, change: float) -> float:
    """Return the time in which the fastest node changes by a temperature; collective.

        t = min V c ΔT/|Q|

    with the volume V of a node, its smallest heat capacity c [J/m³/K] within ΔT, and the heat Q
    that enters it; infinite where nothing changes. Nodes of prescribed temperature are left out,
    and so is what these temperatures change at once.

    Args:
        balance: with the states of the pairs.
        enthalpies: of the owned nodes of all bodies at the start [J/m³].
        change: of the temperature [K].
    """
    unknowns = balance.unknowns
    balance.begin(enthalpies, enthalpies, 0.0, 1.0)
    start = balance.layout.create_vector()
    start.array[:] = enthalpies
    balance.evaluate(start)
    start.destroy()
    heat = np.abs(balance.leaving)
    capacities = [_capacity(body, change) for body in unknowns.bodies]
    needed = unknowns.volumes * np.concatenate([np.zeros(0), *capacities]) * change
    there = (heat > 0.0) & ~unknowns.prescribed
    found = float((needed[there] / heat[there]).min(initial=np.inf))
    return float(balance.layout.comm.allreduce(found, op=MPI.MIN))


def _capacity(body: ThermalBody, change: float) -> FloatArray:
    """Return the smallest heat capacity of the owned nodes within a change [J/m³/K], (owned,)."""
    offsets = np.linspace(-change, change, SAMPLES)
    enthalpies = body.curve.enthalpy(body.owned_temperature[:, None] + offsets)
    return np.asarray(np.diff(enthalpies, axis=1).min(axis=1) / (offsets[1] - offsets[0]))
