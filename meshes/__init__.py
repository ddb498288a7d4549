"""Parametrised geometries, meshed with gmsh."""
