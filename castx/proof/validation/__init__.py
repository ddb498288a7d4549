"""Experiments as data: measured curves, their sources, and comparison with the model.

Public: `experiment.Experiment`, `experiment.read_experiment`, `experiment.experiments`,
`page.write_page`, `band.banded`, `band_page.write_band_page`.
"""
