"""Saved states from which a run restarts on any number of ranks."""
