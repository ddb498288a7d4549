"""Thermo-mechanics of metal casting: solidification, stress, contact and gap-dependent heat."""

__version__ = "0.1.0"
