"""From a case file to a checked case."""
