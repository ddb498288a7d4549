"""Parts of quantities, and quantities of pairs as nodal fields."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from castx.results.states.quantities import on_secondary_nodes, parts
from tests.castx.fakes import FakeSnapshot, casting_pairs, cylinder_mesh


@pytest.mark.parametrize(
    "quantity, model, expected",
    [
        ("temperature", "3d", ()),
        ("displacement", "axisymmetric", ("r", "z")),
        ("displacement", "plane-strain", ("x", "y")),
        ("displacement", "3d", ("x", "y", "z")),
        ("stress", "axisymmetric", ("rr", "zz", "tt", "rz")),
        ("stress", "plane-stress", ("xx", "yy", "zz", "xy")),
        ("stress", "3d", ("xx", "yy", "zz", "xy", "xz", "yz")),
    ],
)
@pytest.mark.serial
def test_parts_of_vectors_and_tensors_follow_the_model(quantity, model, expected):
    assert parts(quantity, model) == expected


@pytest.mark.ranks
def test_pairs_show_on_their_nodes_and_nothing_shows_elsewhere(comm):
    """Ghosts have the values of their owners."""
    mesh = cylinder_mesh(comm)
    snapshot = FakeSnapshot(0.0, 0, mesh, casting_pairs(mesh), {"gap": lambda x: 1.0 + x[:, 1]})
    found = on_secondary_nodes(snapshot, "casting/mould", "gap")
    points = mesh.bodies["casting"].points
    on_wall = np.isclose(points[:, 0], 0.02)
    np.testing.assert_allclose(found, np.where(on_wall, 1.0 + points[:, 1], 0.0), rtol=1e-14)


@pytest.mark.serial
def test_a_node_of_several_pairs_shows_their_mean_by_area(comm):
    mesh = cylinder_mesh(comm)
    pairs = SimpleNamespace(
        secondary="casting", secondary_local=np.array([4, 2, 4]), areas=np.array([1.0, 5.0, 3.0])
    )
    values = np.array([10.0, 7.0, 20.0])
    snapshot = SimpleNamespace(
        pairs={"casting/mould": pairs}, mesh=mesh, paired=lambda interface, name: values
    )
    found = on_secondary_nodes(snapshot, "casting/mould", "contact_pressure")
    assert found[2] == 7.0 and found[4] == pytest.approx(17.5, rel=1e-15)
    assert np.count_nonzero(found) == 2
