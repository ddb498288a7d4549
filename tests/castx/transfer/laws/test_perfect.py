"""The law of perfect contact."""

from __future__ import annotations

import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.errors import CaseError
from castx.transfer.laws.perfect import LAW

pytestmark = pytest.mark.serial


def test_it_joins_temperatures_and_builds_no_coefficient():
    heat = InterfaceHeat.read({"law": "perfect"})
    assert heat.declared is LAW
    assert (LAW.exchange, LAW.build) == ("perfect", None)


@pytest.mark.parametrize("key, value", [("closed", 5), ("radiation", {"emissivities": [1, 1]})])
def test_it_takes_no_numbers(key, value):
    with pytest.raises(CaseError, match=f"{key}: the law 'perfect' takes no further numbers"):
        InterfaceHeat.read({"law": "perfect", key: value})
