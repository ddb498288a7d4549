"""Results on disk: probes.csv, history.csv, fields/castx.pvd and run.json."""

from castx.results.series import read_series
from castx.results.writing import Results

__all__ = ["Results", "read_series"]
