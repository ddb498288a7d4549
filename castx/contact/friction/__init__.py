"""Coulomb friction of node pairs."""
