"""Runs beside a run: in other meshes and steps, and with another coherency.

Public: `estimate.run_estimate`, `sensitivity.run_sensitivity`, `adapted.run_adapted`.
"""
