"""Materials: property tables, solid fraction, enthalpy, thermal strain and the database."""

from castx.materials.database import database_entry, database_names
from castx.materials.description import Liquid, MaterialDescription
from castx.materials.enthalpy import EnthalpyCurve, enthalpy_curve
from castx.materials.finding import find_material
from castx.materials.inelastic import Hardening
from castx.materials.material import Material
from castx.materials.phased import Phased
from castx.materials.solid_fraction import LeverLaw, LinearLaw, ScheilLaw, TabulatedLaw
from castx.materials.sources import OutsideRange, Property, PropertyRow, Source

__all__ = [
    "EnthalpyCurve",
    "Hardening",
    "LeverLaw",
    "LinearLaw",
    "Liquid",
    "Material",
    "MaterialDescription",
    "OutsideRange",
    "Phased",
    "Property",
    "PropertyRow",
    "ScheilLaw",
    "Source",
    "TabulatedLaw",
    "database_entry",
    "database_names",
    "enthalpy_curve",
    "find_material",
]
