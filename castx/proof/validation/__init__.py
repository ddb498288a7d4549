"""Experiments as data: what was measured, what of it is known, and the model beside it.

Public: `experiment.Experiment`, `experiment.read_experiment`, `experiment.experiments`,
`page.write_page`.
"""
