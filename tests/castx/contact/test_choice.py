"""What interfaces ask for, and which methods go together."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.contact.choice import Contact, check_bodies, common_method, fallbacks
from castx.contact.kinematics.rows import Treatment
from castx.contact.methods.registry import METHODS, keys
from castx.errors import CaseError
from tests.contact_methods import EXACT, WITH_FRICTION
from tests.elastic_bodies import blocks, body, elastic, problem
from tests.small_contact import SOFT

pytestmark = pytest.mark.serial


def test_defaults():
    contact = Contact("a", "b")
    assert contact.name == "a/b"
    np.testing.assert_array_equal(contact.initial_gap(np.ones((3, 2))), np.zeros(3))
    assert {name: contact.setting(name) for name in keys()} == {
        name: key.default for name, key in keys().items()
    }


def test_surfaces_touch_from_the_clearance_of_a_method_that_softens_them():
    soft = Contact("a", "b", "exponential")
    assert soft.clearance == soft.setting("clearance") > 0.0
    assert Contact("a", "b", "exponential", settings={"clearance": 3e-5}).clearance == 3e-5
    assert all(Contact("a", "b", m).clearance == 0.0 for m in METHODS if m != "exponential")


def test_a_given_setting_is_taken():
    assert Contact("a", "b", "penalty", settings={"penalty": 1e12}).setting("penalty") == 1e12


@pytest.mark.parametrize("method", WITH_FRICTION)
def test_only_condensed_motions_along_the_surface_are_unknowns(method):
    treatments = [Contact("a", "b", method, friction=mu).treatment for mu in (0.0, 0.3)]
    changed = treatments[0] is Treatment.CONDENSED
    assert treatments[1] is (Treatment.SLIDING if changed else treatments[0])


def test_methods_cannot_be_mixed(comm):
    bodies = {n: body(elastic(*SOFT)) for n in ("upper", "base")}
    contacts = [Contact("upper", "base", method) for method in EXACT]
    with pytest.raises(CaseError, match="contact methods condensed, multipliers in one case"):
        problem(blocks(comm), bodies, {}, contacts)


@pytest.mark.parametrize("key", [name for name, key in keys().items() if key.common])
def test_common_settings_are_the_same_for_all_interfaces(key):
    method = next(name for name, found in METHODS.items() if found.uses(key))
    contacts = [
        Contact("a", "b", method),
        Contact("a", "c", method, settings={key: "other"}),
    ]
    with pytest.raises(CaseError, match=rf"contact\.{key} .*other.* in one case"):
        common_method(contacts)
    assert common_method(contacts[:1]) is METHODS[method]


def test_each_interface_may_have_its_own_penalty():
    penalties = {"b": 1e9, "c": 2e9}
    contacts = [Contact("a", n, "penalty", settings={"penalty": e}) for n, e in penalties.items()]
    assert common_method(contacts) is METHODS["penalty"]


def test_fallbacks_change_the_method_alone():
    contact = Contact("a", "b", fallback=("multipliers", "penalty"), friction=0.0)
    found = fallbacks([contact])
    assert [name for name, _ in found] == ["multipliers", "penalty"]
    for name, [other] in found:
        assert other.method == name
        assert (other.secondary, other.primary) == ("a", "b")
        assert other.initial_gap is contact.initial_gap


@pytest.mark.parametrize(
    "contact, text",
    [
        (Contact("a", "rock"), ""),
        (Contact("rock", "a"), "interface rock/a: the secondary body 'rock' is rigid"),
        (Contact("a", "b", "rigid"), "interface a/b: needs a rigid primary body"),
        (Contact("a", "b", "multipliers", friction=0.1), "method 'multipliers' has no friction"),
        (Contact("a", "b", friction=0.1, pairing=Pairing("patches")), "friction needs pairing"),
    ],
)
def test_bodies_that_cannot_touch_are_refused(contact, text):
    if not text:
        check_bodies([contact], ["a", "b"])
        return
    with pytest.raises(CaseError, match=text):
        check_bodies([contact], ["a", "b"])
