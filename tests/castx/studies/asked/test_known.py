"""Ranges that a study takes from the databases, and factors on tables."""

import logging

import numpy as np
import pytest

from castx.case.reading.read import load_case
from castx.errors import CaseError
from castx.studies.asked.inputs import VariedInput
from castx.studies.asked.known import (
    changes_of_case,
    known_range,
    refuse_elsewhere,
    scaled,
    with_known_ranges,
)
from castx.studies.asked.reading import read_study
from castx.studies.asked.vary import Vary
from castx.studies.runs.runner import Runner, changes_as_overrides
from castx.studies.vary import vary
from castx.transfer.database import interface_entry
from tests.castx.many_runs import CASE, Formulas

pytestmark = pytest.mark.serial

DATA = {
    "materials": {
        "alloy": {"extends": "shop"},
        "shop": {"extends": "AlSi7Mg", "tensile_strength": "190 MPa"},
        "AlCu4.5": {"extends": "AlCu4.5"},
        "own": {"density": 2600, "conductivity": [[20, "150 W/m/K"], [500, "120 W/m/K"]]},
        "idle": {"extends": "idle"},
    },
    "bodies": [{"material": "alloy"}, {"material": "AlCu4.5"}],
    "vary": {"inputs": [{"of": "materials.idle.density", "name": "idle"}]},
    "interfaces": [{"heat": {"from": "aluminium-steel-coated", "open": "40 W/m^2/K"}}],
    "time": {"end": "60 s"},
}


@pytest.mark.parametrize(
    ("of", "low", "high", "by_factor", "entry"),
    [
        ("materials.alloy.solidification_shrinkage", 0.044, 0.066, False, "AlSi7Mg"),
        ("materials.alloy.conductivity.liquid", 0.8, 1.2, True, "AlSi7Mg"),
        ("materials.AlCu4[5].x", 0, 0, False, None),
        ("materials.alloy.tensile_strength", 0, 0, False, None),  # the case has its own
        ("materials.alloy.latent_heat", 389e3, 464e3, False, "AlSi7Mg"),
        ("materials.alloy.density", 0, 0, False, None),  # no range
        ("materials.own.density", 0, 0, False, None),
        ("interfaces[0].heat.closed", 500.0, 3000.0, False, "aluminium-steel-coated"),
        ("interfaces.0.heat.open", 0, 0, False, None),
        ("interfaces.0.heat.gas_conductivity", 0, 0, False, None),  # a table
        ("interfaces.7.heat.closed", 0, 0, False, None),
        ("time.end", 0, 0, False, None),
    ],
)
def test_what_the_databases_know(of, low, high, by_factor, entry):
    found = known_range(DATA, of)
    if entry is None:
        assert found is None
    else:
        assert found[:4] == (low, high, by_factor, entry) and found.source


def test_inputs_without_a_spread_get_that_of_the_database():
    bare = {"of": "materials.alloy.conductivity.liquid", "name": "k"}
    given = {"of": "interfaces.0.heat.closed", "low": 700, "high": 800}
    inputs, words = with_known_ranges([bare, given, "none"], DATA)
    assert inputs == [{**bare, "low": 0.8, "high": 1.2, "factor": True}, given, "none"]
    assert len(words) == 1 and "times 0.8 to 1.2, the range of AlSi7Mg (no source" in words[0]


def test_a_factor_multiplies_what_the_case_or_the_database_has():
    one = VariedInput.read(
        {"of": "materials.own.conductivity", "factor": True, "low": 1, "high": 2}
    )
    (rows,) = changes_of_case(DATA, [one], [1.5]).values()
    assert rows == [[20, "225.0 W/m/K"], [500, "180.0 W/m/K"]]
    liquid = VariedInput.read({"of": "materials.alloy.conductivity.liquid", "factor": True,
                               "low": 1, "high": 2})  # fmt: skip
    changes = changes_of_case(DATA, [liquid], [2.0])
    assert changes["materials.alloy.conductivity.liquid"] == [[613, 132.0], [800, 144.0]]
    assert changes["materials.alloy.conductivity"]["solid"][0] == [25, 160]
    assert list(changes)[-1] == "materials.alloy.conductivity.liquid"  # behind its group


def test_paths_to_no_number_of_the_case_are_refused():
    with pytest.raises(CaseError, match=r'no \[materials.aloy\]; .*did you mean "alloy"'):
        refuse_elsewhere(DATA, "materials.aloy.conductivity")
    with pytest.raises(CaseError, match=r"\[optimise\] is a study"):
        refuse_elsewhere(DATA, "optimise.runs")
    with pytest.raises(
        CaseError, match=r'nothing is made of \[materials.idle\].*material = "idle"'
    ):
        refuse_elsewhere(DATA, "materials.idle.density")
    for there in ("materials.shop.density", "materials.AlCu4.5.density", "time.end", "name"):
        refuse_elsewhere(DATA, there)


def test_nothing_to_multiply_is_refused():
    one = VariedInput.read({"of": "time.first_step", "factor": True, "low": 1, "high": 2})
    with pytest.raises(CaseError, match=r"time.first_step: there is nothing that a factor"):
        changes_of_case(DATA, [one], [1.5])
    with pytest.raises(CaseError, match="multiplies a number or a table"):
        scaled([1, 2, 3], 2.0)
    with pytest.raises(CaseError, match=r"factor.*: its values have no unit 'mm'"):
        VariedInput.read({"of": "a", "factor": True, "low": "1 mm", "high": "2 mm"})


def test_all_kinds_of_values_are_multiplied():
    assert scaled("20 mm", 2.0) == "40.0 mm" and scaled(3, 0.5) == 1.5
    over_gap = {"over": "gap", "table": [[0, "10 W/m^2/K"], ["1 mm", "4 W/m^2/K"]]}
    assert scaled(over_gap, 0.5)["table"] == [[0, "5.0 W/m^2/K"], ["1 mm", "2.0 W/m^2/K"]]
    assert scaled({"solid": 2, "liquid": [[600, 1]]}, 3.0) == {"solid": 6.0, "liquid": [[600, 3.0]]}


VARIED = """
[materials.alloy]
extends = "AlSi7Mg"
[vary]
draws = 4
[[vary.inputs]]
of = "materials.alloy.hardening.rate"
[[vary.inputs]]
of = "materials.alloy.hardening.saturation"
[[vary.inputs]]
of = "interfaces.0.heat.closed"
"""


def test_a_study_runs_with_the_ranges_of_the_databases(tmp_path, caplog):
    path = tmp_path / "case.toml"
    coated = CASE.replace(
        'heat = { law = "constant", closed = "2000 W/m^2/K" }',
        'heat = { from = "aluminium-steel-coated" }',
    ).replace('material = "metal"', 'material = "alloy"')
    path.write_text(coated + VARIED)
    with caplog.at_level(logging.INFO):
        study = read_study(path, Vary)
    assert "materials.alloy.hardening.rate: 30 to 120, the range of AlSi7Mg" in caplog.text
    numbers = interface_entry("aluminium-steel-coated").numbers
    ((low, high),) = next(number.ranges for number in numbers if number.name == "closed")
    seen = []

    def answer(content):
        hardening = content["materials"]["alloy"]["hardening"]
        closed = content["interfaces"][0]["heat"]["closed"]
        seen.append((hardening["rate"], hardening["saturation"][0][1] / 90e6, closed))
        return {"Kou": hardening["rate"]}, {"time": [0.0, 1.0], "near.temperature": [0.0, 1.0]}

    folder = tmp_path / "study"
    folder.mkdir()
    found = vary(Runner(path, (), folder, Formulas(answer)), study)
    np.testing.assert_allclose(found.table.values, sorted_like(found.table.values, seen))
    ends = [(30.0, 120.0), (0.5, 2.0), (low, high)]
    for column, (least, most) in zip(found.table.values.T, ends, strict=True):
        assert least <= column.min() < column.max() <= most


def sorted_like(values, seen):
    """Return the numbers that the runs had in the order of the table."""
    return [min(seen, key=lambda one: abs(one[0] - row[0])) for row in values.tolist()]


def test_changed_groups_are_taken_by_the_case():
    data = {
        "geometry": {"generator": "slab", "model": "plane-strain", "length": 0.02, "width": 0.005,
                     "size": 0.001},
        "materials": {"alloy": {"extends": "AlSi7Mg"}},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": 700}],
        "time": {"end": 60},
    }  # fmt: skip
    keys = ("conductivity.liquid", "liquid.coherency", "yield_stress")
    asked = ({"of": f"materials.alloy.{key}", "factor": True, "low": 1, "high": 2} for key in keys)
    inputs = [VariedInput.read(one) for one in asked]
    changes = changes_of_case(data, inputs, [1.1, 0.9, 2.0])
    alloy = load_case(data, changes_as_overrides(changes)).materials["alloy"]
    assert alloy.conductivity.liquid(613.0) == pytest.approx(72.6)
    assert alloy.conductivity.solid(25.0) == 160.0
    assert alloy.liquid.coherency == pytest.approx(0.81) and alloy.liquid.viscosity(600.0) == 1e6
    assert alloy.yield_stress(20.0) == 180e6
