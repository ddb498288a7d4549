"""Pictures, curves and the report of a run."""
