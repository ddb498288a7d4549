"""Runs on the page: how far one is, and how long one will take.

Public: `progress.RunProgress`, `expected.expectation`.
"""
