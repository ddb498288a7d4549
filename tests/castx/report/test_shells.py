"""What is seen of bodies is their outside, each facet once, under its name."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from castx.domain.summary import mesh_summary
from castx.report.shells import shells_of
from tests.castx.fakes import cylinder_mesh


def area(facets):
    """Return the area of flat facets that go round, or the length of lines."""
    if facets.shape[1] == 2:
        return float(np.linalg.norm(facets[:, 1] - facets[:, 0], axis=1).sum())
    first, *others = np.moveaxis(facets, 1, 0)
    total = sum(np.cross(a - first, b - first) for a, b in pairwise(others))
    return float(np.linalg.norm(total, axis=1).sum() / 2)


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_areas_in_space_are_those_of_the_mesh(comm, cells):
    mesh = cylinder_mesh(comm, "3d", 8e-3, cells)
    summary = mesh_summary(mesh)
    shells = shells_of(mesh, ["mould/casting"])
    assert [shell.body for shell in shells] == (["casting", "mould"] if comm.rank == 0 else [])
    for shell, sizes in zip(shells, summary.bodies, strict=False):
        other = ({"casting", "mould"} - {shell.body}).pop()
        wanted = {
            "mould/casting" if name == other else f"{shell.body}/{name}": size
            for name, size in sizes.surfaces.items()
        }
        if sizes.unnamed:
            wanted[f"{shell.body}, unnamed"] = sizes.unnamed
        # Facets that are not quite flat have areas that the corners do not give exactly.
        assert {n: area(f) for n, f in shell.skins.items()} == pytest.approx(wanted, rel=1e-3)
        assert area(shell.filled) == pytest.approx(sum(wanted.values()), rel=1e-3)


@pytest.mark.ranks
def test_plane_bodies_are_filled_with_their_cells(comm):
    shells = shells_of(cylinder_mesh(comm, "axisymmetric", 8e-3, "quadrilaterals"), [])
    for shell, filled in zip(shells, (8e-4, 4e-4), strict=False):
        assert area(shell.filled) == pytest.approx(filled)
        assert area(shell.skins["casting/mould"]) == pytest.approx(0.04)


@pytest.mark.ranks
def test_named_parts_of_an_interface_have_names_of_their_own(comm):
    mesh = cylinder_mesh(comm, "axisymmetric", 8e-3, "quadrilaterals")
    points = mesh.bodies["casting"].points
    found = comm.allgather(points[(points[:, 0] > 0.02 - 1e-9) & (points[:, 1] < 0.0161)])
    low = np.unique(np.concatenate(found), axis=0)
    for shell in shells_of(replace(mesh, marked={"gate": low}), []):
        assert area(shell.skins["casting/mould, gate"]) == pytest.approx(0.016)
        assert area(shell.skins["casting/mould"]) == pytest.approx(0.024)
