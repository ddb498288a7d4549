from __future__ import annotations

import numpy as np
import pytest

from castx.heat.perfect_contact import JoinedNodes, Links, _flow_weights
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material

pytestmark = pytest.mark.serial


def curve(**properties):
    given = {"density": 1.0, "heat_capacity": {"solid": 3e6, "liquid": 2.6e6}, "conductivity": 1.0}
    description = MaterialDescription.read(given | properties)
    return find_material("m", {"m": description}).enthalpy


METAL = curve(latent_heat=1e9, solidus=660, liquidus=660)
OTHER = curve(latent_heat=4e8, solidus=577, liquidus=577)
ALLOY = curve(latent_heat=9e8, solidus=560, liquidus=615)
STEEL = curve(heat_capacity=4.1e6)
MIXTURES = {
    "metal on steel": (METAL, STEEL),
    "two plateaus": (METAL, OTHER),
    "one plateau twice": (METAL, METAL),
    "alloy": (ALLOY, STEEL),
    "three": (METAL, STEEL, OTHER),
}


def mixed(curves) -> tuple[JoinedNodes, np.ndarray]:
    """Return groups of various volumes and mean enthalpies over the whole range."""
    means = np.linspace(-1e8, 4e9, 400)
    volumes = np.random.default_rng(1).uniform(0.1, 1.0, (len(means), len(curves)))
    return JoinedNodes(curves, volumes), means


@pytest.mark.parametrize("curves", MIXTURES.values(), ids=MIXTURES)
def test_members_share_the_heat_at_one_temperature(curves):
    nodes, means = mixed(curves)
    enthalpies, _ = nodes.split(means)
    sums = (nodes.volumes * enthalpies).sum(axis=1) / nodes.volumes.sum(axis=1)
    assert sums == pytest.approx(means, rel=1e-13, abs=1e-3)
    temperatures = np.column_stack(
        [curve.temperature(H) for curve, H in zip(curves, enthalpies.T, strict=True)]
    )
    assert np.ptp(temperatures, axis=1).max() < 1e-9


@pytest.mark.parametrize("curves", MIXTURES.values(), ids=MIXTURES)
def test_derivatives(curves):
    nodes, means = mixed(curves)
    _, slopes = nodes.split(means)
    step = 1e3
    difference = (nodes.split(means + step)[0] - nodes.split(means - step)[0]) / (2 * step)
    assert np.isclose(slopes, difference, rtol=1e-5).all(axis=1).mean() > 0.98
    assert (nodes.volumes * slopes).sum(axis=1) == pytest.approx(nodes.volumes.sum(axis=1))


def test_temperature_stands_still_while_one_member_melts():
    nodes = JoinedNodes((METAL, STEEL), np.array([[1.0, 3.0]] * 3))
    below, above = (nodes.mean(np.full(3, T))[0] for T in (np.nextafter(660.0, 0.0), 660.0))
    enthalpies, slopes = nodes.split(np.linspace(below, above, 5)[1:-1])
    assert (METAL.temperature(enthalpies[:, 0]) == 660.0).all()
    assert STEEL.temperature(enthalpies[:, 1]) == pytest.approx(660.0, rel=1e-14)
    assert slopes[:, 0] == pytest.approx(np.full(3, 4.0))
    assert (slopes[:, 1] == 0.0).all()


def test_heat_passes_through_a_chain_of_links():
    # Members 0, 1, 2; secondary to primary: interface 0 is 0-1, interface 1 is 2-1.
    links = Links(
        dofs=np.array([[0, 1], [2, 1]]), bodies=np.zeros((2, 2)), interfaces=np.array([0, 1])
    )
    weights = _flow_weights(links, links.dofs, np.zeros(3, dtype=int), 2)
    taken = np.array([-7.0, 4.0, 3.0])
    assert weights @ taken == pytest.approx([7.0, -3.0])


def test_heat_through_a_ring_of_links_balances_the_members():
    links = Links(
        dofs=np.array([[0, 1], [0, 2], [1, 2]]),
        bodies=np.zeros((3, 2)),
        interfaces=np.array([0, 1, 2]),
    )
    weights = _flow_weights(links, links.dofs, np.zeros(3, dtype=int), 3)
    taken = np.array([-7.0, 4.0, 3.0])
    through = weights @ taken
    into = ((-1, -1, 0), (1, 0, -1), (0, 1, 1))
    received = np.array(into) @ through
    assert received == pytest.approx(taken)
