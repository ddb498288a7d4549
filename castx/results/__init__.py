"""Quantities and files that a run writes."""
