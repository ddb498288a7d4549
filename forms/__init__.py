"""The mathematics of castx as pure UFL functions."""
