"""Equilibrium of all bodies in contact."""
