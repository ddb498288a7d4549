"""Kinds of values in a case file: quantities with units, choices, tables, coordinates."""
