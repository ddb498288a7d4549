"""A surface clamped by a machine: a total force F and the stiffness k of the machine behind it.

Both are spread evenly over the surface Γ of area A. Along the direction d in which the machine
presses, the traction on the body is

    t = (F - k d·u)/A d,

on a flat surface with the outward normal n = -d therefore t = -(F + k n·u)/A n: where the surface
moves back, the force rises. The stiffness is an elastic foundation: E. Winkler, Die Lehre von der
Elasticität und Festigkeit (1867). A frame that holds in all directions has t = -(k/A) u.
"""

from __future__ import annotations

from typing import Any

import ufl


def clamp_work(eta: Any, pressure: Any, direction: Any, ds: Any) -> Any:
    """Return ∫_Γ (F/A) d·η, the work of the clamp force at rest.

    Args:
        eta: variation of the displacement.
        pressure: F/A [Pa].
        direction: unit vector d in which the machine presses.
        ds: weighted measure of the surface.
    """
    return pressure * ufl.inner(direction, eta) * ds


def backing_work(eta: Any, u: Any, foundation: Any, direction: Any, ds: Any) -> Any:
    """Return ∫_Γ (k/A) (d·u) (d·η), the work against the springs of the machine.

    Args:
        eta: variation of the displacement.
        u: displacement.
        foundation: k/A [Pa/m].
        direction: unit vector d in which the machine presses.
        ds: weighted measure of the surface.
    """
    return foundation * ufl.inner(direction, u) * ufl.inner(direction, eta) * ds


def frame_work(eta: Any, u: Any, foundation: Any, ds: Any) -> Any:
    """Return ∫_Γ (k/A) u·η, the work against a frame that holds in all directions.

    Args:
        eta: variation of the displacement.
        u: displacement.
        foundation: k/A [Pa/m].
        ds: weighted measure of the surface.
    """
    return foundation * ufl.inner(u, eta) * ds
