"""Descriptions survive the way to the process that meshes."""

import pickle

import pytest

from castx.meshes.cad.description import CadFile, CadPart, Selector

pytestmark = pytest.mark.serial


def test_a_description_can_be_sent():
    part = CadPart(
        (CadFile("a.step", "casting"),), 0.01, ("casting",), selectors=(Selector("s", largest=2),)
    )
    assert pickle.loads(pickle.dumps(part)) == part
    assert CadFile("a.brep").unit == 1e-3
