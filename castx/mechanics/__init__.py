"""Momentum balance of one body."""
