"""The version of castx."""

__version__ = "0.2.0"
