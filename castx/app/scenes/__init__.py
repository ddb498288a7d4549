"""Scenes of the page, each from a process of its own: the mesh of a case, the last moment of a run.

Public: `asking.Scenes`, `mesh.mesh_scene`, `moment.moment_scene`.
"""
