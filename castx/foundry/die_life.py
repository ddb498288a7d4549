"""Life of a die surface: strain range of a cycle, and cycles to a crack by thermal fatigue."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray

ROUNDS = 60


def strain_range(
    stress_range: FloatArray, plastic_range: FloatArray, young_modulus: FloatArray
) -> FloatArray:
    """Return the strain range of a settled cycle, the width of its loop, Δε = Δσ_vM/E + Δε_eq.

    Args:
        stress_range: of the von Mises stress between the extremes of the cycle [Pa].
        plastic_range: equivalent of the difference of the viscoplastic strains of both extremes,
            √(2/3)‖Δε_vp‖; not what flows to and fro between them, which is twice that.
        young_modulus: E [Pa].
    """
    return np.asarray(stress_range / np.asarray(young_modulus) + plastic_range)


def restrained_strain(expansion: float, rise: FloatArray, poisson_ratio: float) -> FloatArray:
    """Return the strain of a surface that may not expand in its plane, α ΔT/(1 - ν).

    With E it is its stress, E α ΔT/(1 - ν).

    Args:
        expansion: α [1/K].
        rise: ΔT [K].
        poisson_ratio: ν.
    """
    return np.asarray(expansion * np.asarray(rise) / (1.0 - poisson_ratio))


@dataclass(frozen=True)
class Fatigue:
    """Strain-life curve of Basquin, Coffin and Manson, Δε/2 = (σ_f′/E) (2N)^b + ε_f′ (2N)^c.

    S. S. Manson and G. R. Halford, Fatigue and Durability of Structural Materials, 2006, ch. 3. The
    coefficients are isothermal; oxidation and soldering are left out.

    Attributes:
        strength: σ_f′ [Pa].
        strength_exponent: b, negative.
        ductility: ε_f′.
        ductility_exponent: c, negative.
    """

    strength: float
    strength_exponent: float
    ductility: float
    ductility_exponent: float

    def cycles(self, strain_range: FloatArray, young_modulus: float | FloatArray) -> FloatArray:
        """Return N, the cycles to a crack; infinite without strain.

        Newton's method in ln 2N for ln Δε/2, a curve that bends one way only: from the shorter of
        the lives of its two parts it comes nearer without overshooting.

        Args:
            strain_range: Δε of a cycle, (n,).
            young_modulus: E, one for all or (n,) [Pa].
        """
        half = np.abs(np.asarray(strain_range, dtype=np.float64)) / 2.0
        with np.errstate(divide="ignore", invalid="ignore"):
            wanted = np.log(half)
            parts = [
                (np.log(self.strength / young_modulus), self.strength_exponent),
                (np.log(self.ductility), self.ductility_exponent),
            ]
            reversals = np.maximum(*((wanted - level) / slope for level, slope in parts))
            for _ in range(ROUNDS):
                shares = [level + slope * reversals for level, slope in parts]
                total = np.logaddexp(*shares)
                slope = sum(
                    np.exp(share - total) * exponent
                    for share, (_, exponent) in zip(shares, parts, strict=True)
                )
                reversals = np.where(half > 0.0, reversals - (total - wanted) / slope, np.inf)
            return np.asarray(0.5 * np.exp(reversals))
