"""Thermal strain e^θ of a material and the strain of its solidification, both volumetric.

Source: Chiumenti, section 2.2, where e^θ is the volumetric strain of the change of temperature.
Here the mean expansion α(T) counts from a reference temperature T_ref, as tables give it, and the
strain is zero at the stress-free temperature T_sf:

    e^θ = 3 [α(T)(T − T_ref) − α(T_sf)(T_sf − T_ref)].
"""

from __future__ import annotations

from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.materials.material import Material


def volumetric_thermal_strain(
    material: Material, temperature: Any, stress_free: float
) -> FloatArray:
    """Return e^θ = 3 [α(T)(T − T_ref) − α(T_sf)(T_sf − T_ref)], expansion positive.

    Zero above T_sf in a material that melts, and everywhere without `expansion`.

    Args:
        material: gives α [1/K] and T_ref.
        temperature: T [°C], array of any shape.
        stress_free: T_sf [°C], see `Material.stress_free_temperature`; also the default of T_ref.
    """
    temperature = np.asarray(temperature, dtype=np.float64)
    expansion = material.expansion
    if expansion is None:
        return np.zeros_like(temperature)
    given = material.expansion_reference
    reference = stress_free if given is None else given
    born = expansion(stress_free) * (stress_free - reference)
    strain = 3.0 * (expansion(temperature) * (temperature - reference) - born)
    if material.melts:
        strain = np.where(temperature > stress_free, 0.0, strain)
    return np.asarray(strain)


def shrinkage_strain(material: Material, solid_fraction: Any) -> FloatArray:
    """Return the part of the solidification shrinkage that strains the solid skeleton, volumetric.

    Metal shrinks in proportion to f_s, by s = `solidification_shrinkage` in all. What it loses
    below coherency other liquid replaces (`liquid_shrinkage`); from there on the skeleton follows,
    −s (f_s − f_c). A material without `liquid` has no coherency: f_c = 0.

    Args:
        material: gives the shrinkage s and the coherency f_c.
        solid_fraction: f_s, array of any shape.
    """
    beyond = np.maximum(np.asarray(solid_fraction, dtype=np.float64) - _coherency(material), 0.0)
    return np.asarray(-material.description.solidification_shrinkage * beyond)


def liquid_shrinkage(material: Material, solid_fraction: Any) -> FloatArray:
    """Return by what share of its volume metal has shrunk before coherency, s min(f_s, f_c).

    It is demand of feeding metal; where none can follow it leaves a void.

    Args:
        material: gives the shrinkage s and the coherency f_c.
        solid_fraction: f_s, array of any shape.
    """
    share = np.minimum(np.asarray(solid_fraction, dtype=np.float64), _coherency(material))
    return np.asarray(material.description.solidification_shrinkage * share)


def _coherency(material: Material) -> float:
    return 0.0 if material.liquid is None else material.liquid.coherency
