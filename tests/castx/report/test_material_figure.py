"""The curves of a material: values behind the diagrams, and a file of each kind."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.materials.database import database_names
from castx.materials.description import MaterialDescription
from castx.materials.inelastic import FLOW_RULES
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.report.material_figure import RATES, Diagram, material_diagrams, write_figure
from tests.castx.flow_reference import reference

pytestmark = pytest.mark.serial


def diagrams(material: Material) -> dict[str, Diagram]:
    return {diagram.label.partition(" [")[0]: diagram for diagram in material_diagrams(material)}


def at(diagram: Diagram, temperature: float, line: int = 0) -> float:
    curve = diagram.lines[line]
    return float(np.interp(temperature, curve.temperature, curve.values))


@pytest.mark.parametrize("name", database_names())
def test_every_entry_is_drawn_with_all_its_data(name) -> None:
    material = find_material(name, {})
    found = diagrams(material)
    expected = {"thermal conductivity", "heat capacity", "thermal diffusivity", "enthalpy"}
    if material.melts:
        expected |= {"solid fraction", "stress of flow"}
    if material.young_modulus is not None:
        granular = material.description.granular is not None
        strength = "cohesion" if granular else "yield stress"
        expected |= {"Young's modulus", "thermal strain", strength}
    assert set(found) == expected
    for diagram in found.values():
        for line in diagram.lines:
            assert np.isfinite(line.values).all() and (np.diff(line.temperature) >= 0.0).all()


def test_curves_are_the_properties() -> None:
    material = find_material("AlSi7Mg", {})
    found = diagrams(material)
    assert at(found["thermal conductivity"], 300.0) == pytest.approx(159.0)
    # Half solid at 574 °C: the mean of solid, constant beyond 557 °C, and melt.
    assert at(found["thermal conductivity"], 574.0) == pytest.approx(0.5 * (145 + 66), abs=0.5)
    assert at(found["solid fraction"], 574.0) == pytest.approx(0.5, abs=1e-3)
    assert at(found["solid fraction"], 545.0) == 1.0 and at(found["solid fraction"], 620.0) == 0.0
    rise = at(found["enthalpy"], 613.0) - at(found["enthalpy"], 557.0)
    assert 389.0 + 1.1 * 56.0 < rise < 389.0 + 1.2 * 56.0
    assert at(found["Young's modulus"], 200.0) == pytest.approx(67.0)
    strain = 100 * (21.5e-6 * 0.0 - 25.5e-6 * 537.0)
    assert at(found["thermal strain"], 20.0) == pytest.approx(strain)
    assert at(found["yield stress"], 20.0) == pytest.approx(90.0)
    hardened = 90.0 + 90.0 * (1.0 - np.exp(-60 * 0.02))
    assert at(found["yield stress"], 20.0, line=1) == pytest.approx(hardened, rel=1e-6)
    slow = at(found["stress of flow"], 400.0)
    assert slow == pytest.approx(14.0 + 75.0 * 1e-6**0.2, rel=1e-3)
    assert found["stress of flow"].lines[0].valid == (20.0, 557.0)


def test_an_isothermal_change_is_upright() -> None:
    found = diagrams(find_material("Al-pure", {}))
    curve = found["enthalpy"].lines[0]
    rise = curve.values[curve.temperature == 660.323]
    assert np.ptp(rise) == pytest.approx(397.0, rel=1e-3)


def test_norton_and_a_material_without_hardening_are_drawn() -> None:
    keys = {"law": "norton", "coefficient": 1e-40, "exponent": 5, "yield_stress": 1e8}
    material = Material("own", MaterialDescription.read(keys))
    found = diagrams(material)
    assert at(found["stress of flow"], 50.0) == pytest.approx(1e-6 * (1e-6 / 1e-40) ** 0.2)
    assert len(found["yield stress"].lines) == 1


@pytest.mark.parametrize("law", FLOW_RULES)
def test_the_stress_of_flow_of_every_rule_is_drawn(law) -> None:
    """The curve of 1e-4/s at 450 °C is the stress at which the rule flows at this rate."""
    rule = FLOW_RULES[law]
    young = [[20, 70e9], [600, 50e9]]
    keys = {"law": law, "yield_stress": 4e7, "young_modulus": young, **rule.example}
    material = Material("own", MaterialDescription.read(keys))
    stress = 1e6 * at(diagrams(material)["stress of flow"], 450.0, line=RATES.index(1e-4))
    f = stress - 4e7 * rule.threshold
    assert reference(law).rate(f, rule.example, 450.0) == pytest.approx(1e-4, rel=2e-2)


@pytest.mark.parametrize("ending", [".png", ".svg", ".PDF"])
def test_a_file_is_written(tmp_path, ending) -> None:
    path = tmp_path / f"a{ending}"
    write_figure(find_material("sand-silica", {}), path)
    assert path.stat().st_size > 5000


@pytest.mark.parametrize(
    ("name", "keys", "message"),
    [
        ("a.jpeg", {"conductivity": 1.0}, r"cannot draw .*a.jpeg: the name must end in .png, .svg"),
        ("lost/a.png", {"yield_stress": 1e6}, r"cannot write .*lost/a.png: No such file"),
        ("a.png", {"density": 1.0}, r"material 'own' has no property to draw"),
    ],
)
def test_refusals(tmp_path, name, keys, message) -> None:
    material = Material("own", MaterialDescription.read(keys))
    with pytest.raises(CaseError, match=message):
        write_figure(material, tmp_path / name)
