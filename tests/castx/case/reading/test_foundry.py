"""Fields of the foundry are refused where data are missing: the key, the material and the cure."""

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from tests.castx.case_data import REMOVED, cylinder

pytestmark = pytest.mark.serial

FILE = Path("cylinder.toml")
ALLOY = {"bodies__0__material": "AlSi7Mg"}
ALL = [
    "dimensionless_niyama", "pore_fraction", "clyne_davies", "arm_spacing", "passing_times",
    "front_speed",
]  # fmt: skip
STRONG = {"extends": "AlSi7Mg", "strength": {"base": 6e7, "slope": 1e5}}
MOULD = {"material": "sand-silica", "temperature": 20}
IRON = {"bodies__0__material": "GJL-250", "bodies__0__temperature": 1300}
HOT = {"material": "sand-silica", "temperature": 700}


@pytest.mark.parametrize(
    "changes",
    [
        {**ALLOY, "output__fields": ALL},
        {"output__fields": ["front_speed", "passing_times"]},
        {"output__fields": ["modulus"], "foundry": {"modulus_constant": "2.4e6 s/m^2"}},
        {"output__fields": ["modulus"], "foundry": {"modulus_mould": MOULD}},
        {**ALLOY, "foundry": {"at": {"temperature": "565 degC"}, "passing_times": [0.3]}},
        {
            "materials__strong": STRONG,
            "bodies__0__material": "strong",
            "output__fields": ["yield_strength"],
        },
        {"bodies__1__material": "GJL-250", **ALLOY, "output__fields": ALL},  # a chill of iron
    ],
)
def test_accepted(changes):
    assert read_case(cylinder(**changes), FILE).bodies[0].name == "casting"


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        (
            {**ALLOY, "output__fields": ["brittle_strain", "brittle_strain_index"]},
            r"output.fields\[1\].*'AlSi7Mg' of body 'casting' has no critical_strain; give it in",
        ),
        (
            {**ALLOY, "output__fields": ["suction_margin"]},
            r"output.fields\[0\].*no body has feeding = \"darcy\"; give it to a casting",
        ),
        (
            {
                **ALLOY,
                "bodies__0__feeding": "darcy",
                "bodies__0__law": "thermo-elasto-viscoplastic",
                "foundry": {"mass_feeding_limit": 0.8},
            },
            "mass_feeding_limit.*has no effect with feeding = .darcy.: feeders sink by what",
        ),
        ({**IRON, "output__fields": ["tearing_margin"]}, "has no melt_viscosity, arm_spacing"),
        ({"output__fields": ["brittle_strain"]}, "has no mush, and so no brittle_strain"),
        (
            {"output__fields": ["cold_crack_index"]},
            "'aluminium' of body 'casting' has no tensile_strength; give it in",
        ),
        (
            {"bodies__0__temperature": 400.0, "output__fields": ["cold_crack_index"]},
            r"output.fields\[0\].*no body that deforms has a tensile_strength; give it in its mat",
        ),
        (
            {"output__fields": ["pore_fraction"]},
            r"output.fields\[0\].*'aluminium' of body 'casting' freezes at one temperature: a "
            "material without a freezing range has no mush, and so no pore_fraction; leave it out",
        ),
        ({"output__fields": ["clyne_davies"]}, "without a freezing range has no mush"),
        (
            {**IRON, "output__fields": ["gap", "dimensionless_niyama"]},
            r"output.fields\[1\].*'GJL-250' of body 'casting' has no melt_viscosity, arm_spacing; "
            r"give it in \[materials.GJL-250\], or leave dimensionless_niyama out",
        ),
        ({**ALLOY, "output__fields": ["yield_strength"]}, "has no strength; give it in"),
        (
            {
                "materials__wet": {"extends": "AlSi7Mg", "liquid": "none"},
                "bodies__0__material": "wet",
                "output__fields": ["pore_fraction"],
            },
            "has no solidification_shrinkage; give it in",
        ),
        ({"output__fields": ["modulus"]}, "foundry.modulus_constant: missing; the field modulus"),
        (
            {
                "output__fields": ["modulus"],
                "foundry": {"modulus_mould": {"material": "sand", "temperature": 20}},
            },
            "foundry.modulus_mould.material.*unknown material 'sand'",
        ),
        (
            {"output__fields": ["modulus"], "foundry": {"modulus_mould": HOT}},
            "foundry.modulus_mould.temperature.*must lie below the solidus of 'casting', 660 °C",
        ),
        (
            {"foundry": {"modulus_constant": 2e6, "modulus_mould": MOULD}},
            "both say the constant of the modulus; leave one out",
        ),
        (
            {**ALLOY, "foundry": {"at": {"temperature": 640}}},
            "foundry.at.temperature.*body 'casting' freezes from 613 to 557 °C; take a temperature",
        ),
        ({"foundry": {"at": 1.2}}, r"foundry.at.*must be at least 0 and at most 1"),
        ({"foundry": {"at": {"temprature": 600}}}, "a solid fraction is needed, or"),
        ({"foundry": {"at": {"temperature": "3 s"}}}, "foundry.at.temperature"),
        ({"foundry": {"passing_times": [0.5, 0.5]}}, r"foundry.passing_times\[1\].*there already"),
        ({"foundry": {"passing_times": []}}, "foundry.passing_times"),
        ({"foundry": {"passing_times": [1.5]}}, r"foundry.passing_times\[0\].*at most 1"),
        ({"foundry": {"pool_limit": 0}}, "foundry.pool_limit = 0: must be positive"),
        ({"foundry": {"feeders": ["top"]}}, r"foundry.feeders\[0\].*a surface is named"),
        (
            {"foundry": {"feeders": ["casting/top", "mould/top"]}},
            r"foundry.feeders\[1\].*no body 'mould' that freezes",
        ),
        ({"foundry": {"feeders": ["casting/top"] * 2}}, r"foundry.feeders\[1\].*there already"),
        ({"foundry": {"modulus_constant": 0}}, "foundry.modulus_constant = 0: must be positive"),
    ],
)
def test_refused(changes, text):
    with pytest.raises(CaseError, match=text):
        read_case(cylinder(**changes), FILE)


def test_what_nobody_asks_for_needs_no_data():
    changes = {**IRON, "materials__steel__density": REMOVED}
    with pytest.raises(CaseError) as refusal:
        read_case(cylinder(**changes), FILE)
    assert "melt_viscosity" not in str(refusal.value)
