"""A declaration that leaves something out is refused with the name of what is missing."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.materials.flow_rules.norton import COEFFICIENT
from castx.materials.flow_rules.norton import RULE as NORTON
from castx.materials.flow_rules.perzyna import RULE as PERZYNA
from castx.materials.hardening.voce import RULE as VOCE
from castx.materials.rules.declaration import keys_of

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("rule", [NORTON, VOCE], ids=lambda rule: rule.name)
@pytest.mark.parametrize("text", ["summary", "formula", "source"])
def test_texts(rule, text) -> None:
    with pytest.raises(TypeError, match=rf"rule '{rule.name}' declares no {text}"):
        replace(rule, **{text: ""})


def test_examples() -> None:
    with pytest.raises(TypeError, match="rule 'norton' declares no example of 'exponent'"):
        replace(NORTON, example={"coefficient": 1e-30})
    with pytest.raises(TypeError, match="'norton': example of 'coefficient': must be positive"):
        replace(NORTON, example=dict(NORTON.example) | {"coefficient": -1.0})


def test_meanings() -> None:
    unclear = replace(COEFFICIENT, meaning="")
    with pytest.raises(TypeError, match="the key 'coefficient' of rule 'norton' declares no mean"):
        replace(NORTON, keys=(unclear, *NORTON.keys[1:]))


def test_keys_of_one_name_are_one_key() -> None:
    assert list(keys_of([PERZYNA, NORTON])) == [
        "viscosity", "exponent", "coefficient", "activation_energy",
    ]  # fmt: skip
    exponent = replace(PERZYNA.keys[1], default=None)
    other = replace(PERZYNA, keys=(PERZYNA.keys[0], exponent))
    with pytest.raises(TypeError, match="rule 'norton' declares the key 'exponent' otherwise"):
        keys_of([other, NORTON])
