"""Thermal strain e^θ of a material and the strain of its solidification, both volumetric.

Source: Chiumenti, section 2.2, where e^θ is the volumetric strain of the change of temperature.
Here the mean expansion α(T) counts from a reference temperature T_ref, as tables give it, and the
strain is zero at the stress-free temperature T_sf:

    e^θ = 3 [α(T)(T − T_ref) − α(T_sf)(T_sf − T_ref)].

Metal expands as long as it is a solid: above a temperature T_s its strain stays that of T_s. What
freezes has T_s = T_sf, so that it has no strain before it contracts. A chill, core or die begins as
a solid; its T_sf is the temperature at its start, or the one of the case, and its T_s that at which
it melts. Its liquid keeps the volume of the solid: frozen and cold again it fills its place.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from castx.arrays import FloatArray
from castx.materials.material import Material


@dataclass(frozen=True, eq=False)
class StressFreeState:
    """State in which a body has neither thermal strain nor one of solidification.

    Attributes:
        temperature: T_sf [°C], one number or one for each node.
        solid_below: T_s [°C]; None: T_sf in a material that melts, infinite in another.
        solid_fraction: one number or one for each node.
    """

    temperature: float | FloatArray
    solid_below: float | None = None
    solid_fraction: float | FloatArray = 0.0

    @classmethod
    def at_start(cls, material: Material, initial: float | FloatArray, hottest: float) -> Self:
        """Return the state of a body that starts with given temperatures.

        What is solid at the start is free of strain there, what is not at the temperature at which
        the metal begins to contract; or all of it at the one that the case gives.

        Args:
            material: of the body.
            initial: temperature at the start [°C], one number or one for each node.
            hottest: highest one of the body on all ranks [°C].
        """
        given, contracts, solidus = (
            material.given_stress_free, material.contraction_start, material.solidus
        )  # fmt: skip
        if contracts is None or solidus is None:
            return cls(initial if given is None else given)
        if given is not None:
            return cls(given, solidus, 1.0) if hottest < solidus else cls(given)
        solid = np.asarray(initial) < contracts
        fraction = np.where(solid, material.solid_fraction_at(np.asarray(initial)), 0.0)
        return cls(np.minimum(initial, contracts), contracts, fraction)

    def at(self, spread: Callable[[FloatArray], FloatArray]) -> Self:
        """Return the state at other places, from a function that finds nodal values there."""
        temperature, fraction = (
            value if np.ndim(value) == 0 else spread(np.asarray(value))
            for value in (self.temperature, self.solid_fraction)
        )
        return replace(self, temperature=temperature, solid_fraction=fraction)

    def thermal_strain(self, material: Material, temperature: FloatArray) -> FloatArray:
        """Return e^θ at the nodes; the value of the liquid at an infinite temperature.

        Args:
            material: of the body.
            temperature: at the nodes [°C], shape (nodes,).
        """
        return volumetric_thermal_strain(material, temperature, self.temperature, self.solid_below)

    def shrinkage(self, material: Material, solid_fraction: FloatArray) -> FloatArray:
        """Return the strain of solidification since this state at the nodes, shape (nodes,).

        Args:
            material: of the body.
            solid_fraction: at the nodes, shape (nodes,).
        """
        start = np.asarray(self.solid_fraction)
        return shrinkage_strain(material, solid_fraction) - shrinkage_strain(material, start)

    def strain(
        self, material: Material, temperature: FloatArray, solid_fraction: FloatArray
    ) -> FloatArray:
        """Return thermal strain and strain of solidification together, shape (nodes,).

        Args:
            material: of the body.
            temperature: at the nodes [°C], shape (nodes,).
            solid_fraction: at the nodes, shape (nodes,).
        """
        thermal = self.thermal_strain(material, temperature)
        return np.asarray(thermal + self.shrinkage(material, solid_fraction))

    def strain_at(self, material: Material, solid_fraction: float) -> FloatArray:
        """Return both strains as freezing metal reaches a solid fraction, shape () or (nodes,).

        Args:
            material: of the body; it melts.
            solid_fraction: one number.
        """
        reached = np.asarray(material.temperature_at(solid_fraction))
        return self.strain(material, reached, np.asarray(solid_fraction))


def volumetric_thermal_strain(
    material: Material,
    temperature: Any,
    stress_free: float | FloatArray,
    solid_below: float | None = None,
) -> FloatArray:
    """Return e^θ = 3 [α(T)(T − T_ref) − α(T_sf)(T_sf − T_ref)], expansion positive.

    Above T_s it is that of T_s; without `expansion` it is zero.

    Args:
        material: gives α [1/K] and T_ref.
        temperature: T [°C], array of any shape.
        stress_free: T_sf [°C], one number or in the shape of T; also the default of T_ref.
        solid_below: T_s [°C]; None: T_sf in a material that melts, infinite in another.
    """
    temperature = np.asarray(temperature, dtype=np.float64)
    expansion = material.expansion
    if expansion is None:
        return np.zeros_like(temperature)
    given = material.expansion_reference
    reference = stress_free if given is None else given
    born = expansion(stress_free) * (stress_free - reference)
    if solid_below is not None:
        temperature = np.minimum(temperature, solid_below)
    elif material.melts:
        temperature = np.minimum(temperature, stress_free)
    return np.asarray(3.0 * (expansion(temperature) * (temperature - reference) - born))


def shrinkage_strain(material: Material, solid_fraction: Any) -> FloatArray:
    """Return the part of the solidification shrinkage that strains the solid skeleton, volumetric.

    Metal shrinks in proportion to f_s, by s = `solidification_shrinkage` in all. What it loses
    up to f_c other liquid replaces (`liquid_shrinkage`); from there on the skeleton follows,
    −s (f_s − f_c). A material without `liquid` has f_c = 0.

    Args:
        material: gives the shrinkage s and f_c, `fed_until`.
        solid_fraction: f_s, array of any shape.
    """
    beyond = np.maximum(np.asarray(solid_fraction, dtype=np.float64) - material.fed_until, 0.0)
    return np.asarray(-material.description.solidification_shrinkage * beyond)


def liquid_shrinkage(material: Material, solid_fraction: Any) -> FloatArray:
    """Return the volume share of the shrinkage that liquid feeds, s min(f_s, f_c).

    It is demand of feeding metal; where none can follow it leaves a void.

    Args:
        material: gives the shrinkage s and f_c, `fed_until`.
        solid_fraction: f_s, array of any shape.
    """
    share = np.minimum(np.asarray(solid_fraction, dtype=np.float64), material.fed_until)
    return np.asarray(material.description.solidification_shrinkage * share)
