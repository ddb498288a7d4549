"""Stress at a point: law, return mapping and history."""
