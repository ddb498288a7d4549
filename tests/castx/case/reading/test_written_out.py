"""The numbers that interfaces take from the database, in the content of a case."""

from __future__ import annotations

from copy import deepcopy

import pytest

from castx.case.reading.changes import refuse_changes
from castx.case.reading.read import load_case
from castx.case.reading.written_out import written_out
from castx.errors import CaseError
from castx.transfer.database import interface_entry

pytestmark = pytest.mark.serial

NAME = "aluminium-steel-coated"
CASE = {
    "geometry": {
        "generator": "two_slabs", "model": "plane-strain", "length": 0.02, "mould_length": 0.02,
        "width": 0.01, "size": 0.01,
    },
    "bodies": [
        {"name": "casting", "material": "Al-pure", "temperature": 700},
        {"name": "mould", "material": "steel-H13", "temperature": 200},
    ],
    "interfaces": [{"bodies": ["casting", "mould"], "heat": {"from": NAME}}],
    "time": {"end": 1},
}  # fmt: skip


def case_with(**heat):
    case = deepcopy(CASE)
    case["interfaces"][0]["heat"] |= heat
    return case


def kept(case):
    return load_case(case).content["interfaces"][0]["heat"]


def test_the_numbers_stand_in_the_content():
    assert kept(CASE) == {"from": NAME, **interface_entry(NAME).heat}
    assert kept(case_with(closed="2 kW/m^2/K"))["closed"] == "2 kW/m^2/K"
    patch = {"within": {"y": [0, 0.005]}, "from": "aluminium-chill-copper"}
    patches = kept(case_with(patches=[patch]))["patches"]
    assert patches == [{**patch, **interface_entry("aluminium-chill-copper").heat}]


def test_what_is_written_out_is_a_case_with_the_same_content():
    for heat in ({}, {"closed": 900}, {"law": "constant"}, {"from": "aluminium-steel-coating-layer",
                 "coating": {"thickness": "50 um"}}):  # fmt: skip
        case = load_case(case_with(**heat))
        again = load_case(case.content)
        assert again.digest == case.digest and again.content == case.content
        assert again.interfaces[0].heat.given.values.keys() == (
            case.interfaces[0].heat.given.values.keys()
        )


def test_digest_follows_the_numbers_and_a_run_does_not_go_on_with_others():
    before, now = load_case(CASE), load_case(CASE, ["interfaces.0.heat.closed=900"])
    assert before.digest != now.digest
    number = interface_entry(NAME).heat["closed"]
    with pytest.raises(CaseError, match=rf"heat.closed = 900 \(it was {number}\)"):
        refuse_changes(before.content, now.content, "checkpoint.h5")


def test_cases_without_entries_stay_as_they_are():
    for case in ({}, {"interfaces": []}, {"interfaces": [{"bodies": ["a", "b"]}]}):
        assert written_out(case) == case
    plain = {"law": "constant", "closed": 5, "patches": [{"on": "a", "closed": 6}]}
    case = {"interfaces": [{"bodies": ["a", "b"], "heat": plain}]}
    assert written_out(case) == case


def test_unknown_names_are_refused_with_the_nearest_one():
    with pytest.raises(CaseError, match=r'heat.from = "aluminium-steel-coatd": no such interface'
                       r'.*did you mean "aluminium-steel-coated"'):  # fmt: skip
        load_case(case_with(**{"from": "aluminium-steel-coatd"}))
    with pytest.raises(CaseError, match=r"heat.from = 7: no such interface; known: aluminium-"):
        load_case(case_with(**{"from": 7}))
    with pytest.raises(CaseError, match=r'heat.patches\[0\].from = "iron": no such interface'):
        load_case(case_with(patches=[{"within": {"x": [0, 1]}, "from": "iron"}]))
    with pytest.raises(CaseError, match=r"heat.frm = .*unknown key.*\(did you mean \"from\""):
        load_case(case_with(frm="x"))
    with pytest.raises(CaseError, match=r"heat.closed = -1: must be positive"):
        load_case(case_with(closed=-1))
    with pytest.raises(CaseError, match=r"heat.decay_length.*the law 'series' takes closed"):
        load_case(case_with(decay_length=1e-3))
