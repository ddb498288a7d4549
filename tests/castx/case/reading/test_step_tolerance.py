"""Tolerances of the steps: what a run does not compute has none."""

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from tests.castx.case_data import cylinder

pytestmark = pytest.mark.serial

ALL = {"temperature": "2 K", "gap": "2 um", "strain": 1e-5}


def case_of(scheme, tolerance):
    changes = {"coupling__scheme": scheme, "time__tolerance": tolerance}
    return read_case(cylinder(**changes), Path("cylinder.toml"))


@pytest.mark.parametrize("scheme", ["iterated", "staggered", "one-way"])
def test_a_coupled_run_has_all(scheme):
    found = case_of(scheme, ALL).time.tolerance
    assert (found.temperature, found.gap, found.strain) == pytest.approx((2.0, 2e-6, 1e-5))


@pytest.mark.parametrize(
    "scheme, key, reason",
    [
        ("thermal", "gap", "nothing moves"),
        ("thermal", "strain", "nothing moves"),
        ("mechanical", "temperature", "temperatures are given"),
    ],
)
def test_what_a_run_lacks_is_refused(scheme, key, reason):
    with pytest.raises(CaseError, match=rf"time\.tolerance\.{key}.*{reason}.*leave it out"):
        case_of(scheme, {key: ALL[key]})
    other = {"thermal": "temperature", "mechanical": "gap"}[scheme]
    if scheme == "thermal":
        assert case_of(scheme, {other: ALL[other]}).time.tolerance.temperature == 2.0
