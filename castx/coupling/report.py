"""What one thermo-mechanical step took."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CoupledReport:
    """What one coupled step took.

    Attributes:
        passes: solutions of heat and mechanics.
        heat_iterations: Newton iterations of the heat problem, all passes.
        mechanics_iterations: those of the equilibrium.
        linear_iterations: linear iterations of the equilibrium.
        contact_changes: pairs that opened or closed.
        frozen_pairs: pairs that chattered and were frozen, at the end.
        unbalanced: equilibria that a block iteration left before they balanced.
        fallbacks: contact methods that failed before the one that served.
        temperature_change: of the fastest node [K].
        solid_fraction_change: likewise.
    """

    passes: int = 0
    heat_iterations: int = 0
    mechanics_iterations: int = 0
    linear_iterations: int = 0
    contact_changes: int = 0
    frozen_pairs: int = 0
    unbalanced: int = 0
    fallbacks: int = 0
    temperature_change: float = 0.0
    solid_fraction_change: float = 0.0

    def followed_by(self, other: CoupledReport) -> CoupledReport:
        """Return what this and another pass of the same step took together."""
        return CoupledReport(
            self.passes + other.passes,
            self.heat_iterations + other.heat_iterations,
            self.mechanics_iterations + other.mechanics_iterations,
            self.linear_iterations + other.linear_iterations,
            self.contact_changes + other.contact_changes,
            other.frozen_pairs,
            self.unbalanced + other.unbalanced,
            other.fallbacks,
            other.temperature_change,
        )
