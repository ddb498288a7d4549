"""Gaps of node pairs as functions of the unknowns."""
