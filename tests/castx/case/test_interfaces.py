"""Interfaces: two bodies, contact and the initial gap."""

import pytest

from castx.case.interfaces import Interface
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial

LIMITED = {"law": "limited", "closed": 800, "gas_conductivity": 0.04}




def test_an_interface_has_two_sides():
    interface = Interface.read({"bodies": ["casting", "mould"], "heat": LIMITED})
    assert (interface.name, interface.secondary, interface.primary) == (
        "casting/mould",
        "casting",
        "mould",
    )
    with pytest.raises(Refusal, match="bodies: at least 2 needed, there are 1"):
        Interface.read({"bodies": ["casting"]})
    with pytest.raises(Refusal, match="bodies: at most 2 allowed"):
        Interface.read({"bodies": ["a", "b", "c"]})
