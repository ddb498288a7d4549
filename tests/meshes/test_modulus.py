"""Moduli of simple bodies, from volumes and surfaces written out."""

from math import pi

import pytest

from castx.meshes.modulus import block_modulus, prism_modulus, ring_modulus

pytestmark = pytest.mark.serial


def test_a_block():
    assert block_modulus([2.0, 3.0]) == pytest.approx(6.0 / 10.0)
    assert block_modulus([2.0, 3.0, 5.0]) == pytest.approx(30.0 / 62.0)


def test_a_ring_and_a_cylinder():
    volume, surface = pi * (9.0 - 4.0) * 5.0, 2.0 * pi * (5.0 * 5.0 + 9.0 - 4.0)
    assert ring_modulus(2.0, 3.0, 5.0) == pytest.approx(volume / surface)
    assert ring_modulus(2.0, 3.0, None) == pytest.approx(pi * 5.0 / (2.0 * pi * 5.0))
    assert ring_modulus(0.0, 3.0, 5.0) == pytest.approx(45.0 / (2.0 * 15.0 + 2.0 * 9.0))


def test_a_prism():
    assert prism_modulus(6.0, 10.0, None) == 0.6
    assert prism_modulus(6.0, 10.0, 5.0) == pytest.approx(block_modulus([2.0, 3.0, 5.0]))
