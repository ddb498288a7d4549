"""Cracks of the solid: strain in the brittle range, stress against strength, a three-bar frame."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray


def principal_values(stress: FloatArray) -> FloatArray:
    """Return the principal values of stresses (n, 6) as xx yy zz xy xz yz: (n, 3), falling [Pa].

    In an axisymmetric body, rr zz θθ rz 0 0, they are the same.
    """
    rows = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])
    return np.asarray(np.linalg.eigvalsh(stress[:, rows])[:, ::-1])


def strain_across(strain: FloatArray, direction: FloatArray) -> FloatArray:
    """Return P ε P, P = 1 - n n/‖n‖²: strains without their parts along a direction.

    Args:
        strain: (k, 6) as xx yy zz xy xz yz, shear as tensor components.
        direction: n, of any length, (k, 2 or 3); where it is zero all of the strain is kept.
    """
    rows = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])
    n = np.zeros((len(strain), 3))
    n[:, : direction.shape[1]] = direction
    length = np.linalg.norm(n, axis=1, keepdims=True)
    n = np.divide(n, length, out=np.zeros_like(n), where=length > 0.0)
    across = np.eye(3) - n[:, :, None] * n[:, None, :]
    found = across @ strain[:, rows] @ across
    return np.asarray(found[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]])


def cold_crack_index(largest_principal: FloatArray, tensile_strength: FloatArray) -> FloatArray:
    """Return the largest σ_1/R_m(T) over the cooling, not below zero.

    A stress from yield data of reheated samples is too high for the metal as cast, and so is the
    index.

    Args:
        largest_principal: σ_1 at instants of the cooling, (instants, n) [Pa].
        tensile_strength: R_m at the temperatures of these instants, (instants, n) [Pa].
    """
    return np.asarray(np.maximum(np.max(largest_principal / tensile_strength, axis=0), 0.0))


def brittle_strain_ratio(strain_gained: FloatArray, critical_strain: float) -> FloatArray:
    """Return the strain across ∇T gained over 0.9 < f < 0.99 relative to what the alloy bears.

    Args:
        strain_gained: elastic and inelastic, its largest principal value.
        critical_strain: of the alloy; it has no default, as no published one could be confirmed.
    """
    return np.asarray(np.maximum(strain_gained, 0.0) / critical_strain)


def three_bar_stresses(
    young_modulus: float, expansion: float, plastic_rest: float, thin_area: float, thick_area: float
) -> tuple[float, float]:
    """Return the residual stresses of a frame of thin bars and a thick one that cools last [Pa].

    σ_2 = E α ΔT_p A_1/(A_1 + A_2) pulls in the thick bar, σ_1 = -σ_2 A_2/A_1 presses in the thin
    ones, from equal lengths and no force on the whole.

    Args:
        young_modulus: E [Pa].
        expansion: α [1/K].
        plastic_rest: by how much the thick bar is hotter when it is plastic for the last time [K].
        thin_area: A_1 of all thin bars together [m²].
        thick_area: A_2 [m²].

    Returns:
        Of the thick bar and of the thin ones.
    """
    free = young_modulus * expansion * plastic_rest
    thick = free * thin_area / (thin_area + thick_area)
    return thick, -thick * thick_area / thin_area
