"""Facing nodes of two bodies."""
