"""The meshed bodies: mesh, submeshes, named surfaces, measures."""
