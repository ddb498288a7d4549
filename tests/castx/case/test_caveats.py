"""Cases that run and mean something else than their author may think."""

import pytest

from castx.case.caveats import caveats, shut_in
from castx.case.reading.read import load_case

pytestmark = pytest.mark.serial

CYLINDER = "demos/cylinder.toml"


@pytest.mark.parametrize(
    ("law", "scheme", "warned"),
    [
        ('"limited", closed = 2000, gas_conductivity = 0.05', "thermal", True),
        ('"series", closed = 2000, gas_conductivity = 0.05', "thermal", True),
        ('"series", closed = 2000, gas_conductivity = 0.05', "iterated", False),
        (
            '"series", closed = { over = "time", table = [[0, 2000], [9, 500]] }, '
            "gas_conductivity = 0.05",
            "thermal",
            False,
        ),
        (
            '"series", closed = { over = "temperature", table = [[20, 500], [600, 2000]] }, '
            "gas_conductivity = 0.05",
            "thermal",
            False,
        ),
        (
            '"series", closed = { over = "pressure", table = [[0, 500], [1e6, 2000]] }, '
            "gas_conductivity = 0.05",
            "thermal",
            True,
        ),
        ('"constant", closed = 2000', "thermal", False),
        ('"solid-fraction", closed = 2000, open = 100', "thermal", False),
    ],
)
def test_a_gap_that_nothing_opens_is_told(law, scheme, warned):
    given = [f"interfaces.0.heat={{ law = {law} }}", f'coupling.scheme="{scheme}"']
    found = [text for text in caveats(load_case(CYLINDER, given)) if "keeps its" in text]
    assert len(found) == warned
    assert not warned or ("casting/mould" in found[0] and "iterated" in found[0])


@pytest.mark.parametrize(
    ("gas", "warned"),
    [
        ("0.05", False),
        ("1.1e-3", False),
        ("0.9e-3", True),
        ("1e-12", True),
        ('{ over = "temperature", table = [[20, 1e-6], [600, 0.06]] }', True),
    ],
)
def test_a_gap_in_which_nothing_conducts_is_told(gas, warned):
    law = f'interfaces.0.heat={{ law = "series", closed = 2000, gas_conductivity = {gas} }}'
    found = [text for text in caveats(load_case(CYLINDER, [law])) if "stops all heat" in text]
    assert len(found) == warned
    assert not warned or "casting/mould" in found[0]


@pytest.mark.parametrize(
    ("expansion", "reference", "warned"),
    [
        ("[[20, 2.3e-5], [500, 2.8e-5]]", "", True),
        ("[[100, 2.3e-5], [500, 2.8e-5]]", "", True),
        ("[[100, 2.3e-5], [500, 2.8e-5]]", ", expansion_reference = 20", False),
        ("[[400, 2.3e-5], [600, 2.8e-5]]", "", False),
        ("2.4e-5", "", False),
    ],
)
def test_a_handbook_table_without_its_reference_is_told(expansion, reference, warned):
    mine = f'materials.mine={{ extends = "plain", expansion = {expansion}{reference} }}'
    plain = (
        "materials.plain={ density = 2700, heat_capacity = 1000, conductivity = 200, "
        "latent_heat = 4e5, solidus = 600, liquidus = 650, young_modulus = 7e10, "
        "poisson_ratio = 0.3 }"
    )
    given = [plain, mine, "bodies.0.material=mine", "bodies.0.law=thermo-elastic"]
    found = [text for text in caveats(load_case(CYLINDER, given)) if "expansion_reference" in text]
    assert len(found) == warned
    thermal = load_case(CYLINDER, [*given, 'coupling.scheme="thermal"'])
    assert not any("expansion_reference" in text for text in caveats(thermal))


@pytest.mark.parametrize(
    ("material", "temperature", "scheme", "warned"),
    [
        ("mine", 700, "iterated", True),
        ("mine", 700, "thermal", False),
        ("mine", 500, "iterated", False),
        ("AlSi7Mg", 700, "iterated", False),
    ],
)
def test_a_melt_that_is_elastic_is_told(material, temperature, scheme, warned):
    given = [
        'materials.mine={ extends = "AlSi7Mg", liquid = "none" }',
        f"bodies.0.material={material}", f"bodies.0.temperature={temperature}",
        f'coupling.scheme="{scheme}"',
    ]  # fmt: skip
    found = [text for text in caveats(load_case(CYLINDER, given)) if "elastic" in text]
    assert len(found) == warned
    assert not warned or "casting starts molten, but mine has no liquid" in found[0]


@pytest.mark.parametrize(
    ("law", "temperature", "scheme", "warned"),
    [
        ("", 700, "iterated", True),
        ("", 700, "thermal", False),
        ("", 500, "iterated", False),
        (', law = "thermo-elastic"', 700, "iterated", False),
        (', law = "thermo-elasto-viscoplastic"', 700, "iterated", False),
    ],
)
def test_a_casting_that_is_elastic_for_want_of_a_law_is_told(law, temperature, scheme, warned):
    body = f'{{ name = "casting", material = "AlSi7Mg", temperature = {temperature}{law} }}'
    case = load_case(CYLINDER, [f"bodies.0={body}", f'coupling.scheme="{scheme}"'])
    found = [text for text in caveats(case) if "has no law" in text]
    assert len(found) == warned
    assert not warned or ("casting has" in found[0] and "residual stress" in found[0])


@pytest.mark.parametrize(
    ("material", "law", "scheme", "warned"),
    [
        ("sand-silica", "", "iterated", True),
        ("sand-silica", "", "thermal", False),
        ("sand-silica", ', law = "thermo-elastic"', "iterated", False),
        ("sand-silica", ', law = "rigid"', "iterated", False),
        ("steel-H13", "", "iterated", False),
    ],
)
def test_sand_that_is_elastic_for_want_of_a_law_is_told(material, law, scheme, warned):
    body = f'{{ name = "mould", material = "{material}", temperature = 20{law} }}'
    case = load_case(CYLINDER, [f"bodies.1={body}", f'coupling.scheme="{scheme}"'])
    found = [text for text in caveats(case) if "mould of sand" in text and "no law" in text]
    assert len(found) == warned
    assert not warned or 'law = "drucker-prager"' in found[0]


@pytest.mark.parametrize(
    ("alloy", "law", "free", "scheme", "warned"),
    [
        ("GJL-250", "rigid", {}, "iterated", True),
        ("GJL-250", "rigid", {"casting": 0.0, "mould": 1.0}, "iterated", True),
        ("GJL-250", "rigid", {"casting": 1e-4}, "iterated", False),
        ("GJL-250", "rigid", {}, "thermal", False),
        ("GJL-250", "drucker-prager", {}, "iterated", False),
        ("AlSi7Mg", "rigid", {}, "iterated", False),
    ],
)
def test_iron_that_swells_within_rigid_walls_is_told(alloy, law, free, scheme, warned):
    given = [
        f"bodies.0.material={alloy}", "bodies.0.temperature=1300", "bodies.1.material=sand-silica",
        "bodies.1.temperature=20", f"bodies.1.law={law}", f'coupling.scheme="{scheme}"',
    ]  # fmt: skip
    found = list(shut_in(load_case(CYLINDER, given), free))
    assert len(found) == warned
    assert not warned or ("casting of GJL-250 swells" in found[0] and "--top open" in found[0])


def test_a_stress_free_temperature_that_does_not_suit_the_start_is_warned_of():
    def warned(word: str, body: int, stress_free: str) -> bool:
        mine = f'materials.mine={{ extends = "AlSi7Mg"{stress_free} }}'
        case = load_case("demos/stages.toml", [f"bodies.{body}.material=mine", mine])
        return any(word in warning for warning in caveats(case))

    for good in ("", ", stress_free = 200", ", stress_free = 20"):
        assert not warned("core starts", 1, good)
    assert warned("core starts solid at 200 °C", 1, ", stress_free = 557")
    for good in ("", ", stress_free = 560"):
        assert not warned("casting starts", 0, good)
    assert warned("and freezes", 0, ", stress_free = 200")
