"""The version of castx."""

__version__ = "0.1.0"
