"""Scheil curves of an ideal binary alloy of a database of its own, beside the closed form.

Both phases are ideal solutions, so that the mole fractions of the second element in solid and
liquid have the ratio k = exp(-16.9633/R) = 0.13 at all temperatures. For the straight liquidus of
the closed form its slope must not change: T_m is that of the tangent at x0.
"""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from castx.materials.scheil import Composition, case_text, scheil_table

pytestmark = pytest.mark.serial

HAVE = all(find_spec(name) for name in ("pycalphad", "scheil"))
needs_packages = pytest.mark.skipif(not HAVE, reason="pycalphad and scheil are not installed")
GAS, HEAT, MELTING, PARTITION, SHARE = 8.3145, 10700.0, 933.25, 0.13, 0.02
DATABASE = f"""
ELEMENT /- ELECTRON_GAS 0 0 0 !
ELEMENT VA VACUUM 0 0 0 !
ELEMENT AA LIQUID 27 0 0 !
ELEMENT BB LIQUID 27 0 0 !
TYPE_DEFINITION % SEQ *!
PHASE LIQUID % 1 1.0 !
CONSTITUENT LIQUID :AA,BB: !
PARAMETER G(LIQUID,AA;0) 100 0; 6000 N !
PARAMETER G(LIQUID,BB;0) 100 0; 6000 N !
PHASE SOLID % 1 1.0 !
CONSTITUENT SOLID :AA,BB: !
PARAMETER G(SOLID,AA;0) 100 -{HEAT}+{HEAT / MELTING}*T; 6000 N !
PARAMETER G(SOLID,BB;0) 100 {-GAS * np.log(PARTITION)}*T; 6000 N !
"""


@pytest.fixture
def database(tmp_path):
    file = tmp_path / "ideal.tdb"
    file.write_text(DATABASE)
    return file


def liquidus(share):
    """Return the liquidus [°C] where the solvent has equal potentials: an exact phase line."""
    ratio = np.log((1.0 - PARTITION * share) / (1.0 - share))
    return HEAT / (HEAT / MELTING + GAS * ratio) - 273.15


@needs_packages
def test_an_ideal_binary_alloy(database):
    rows = np.array(scheil_table(database, Composition.of(["AA", "BB=2"]), 0.25, rest=0.05))
    assert rows[-1] == pytest.approx([liquidus(SHARE), 0.0], abs=0.01)
    for fraction, error in ((0.2, 0.02), (0.5, 0.05), (0.8, 0.15), (0.9, 0.3)):
        found = np.interp(fraction, rows[::-1, 1], rows[::-1, 0])
        exact = liquidus(SHARE * (1.0 - fraction) ** (PARTITION - 1.0))
        assert found == pytest.approx(exact, abs=error), fraction
    assert 0.93 < rows[0, 1] < 0.96


@needs_packages
def test_the_text_is_that_of_a_material_in_a_case(database):
    import tomllib

    alloy = Composition.of(["aa", "bb=2"])
    rows = scheil_table(database, alloy, 4.0, rest=0.2)
    metal = tomllib.loads(case_text(rows, database, alloy))["materials"]["alloy"]
    metal |= {"density": 2700, "heat_capacity": 1000, "conductivity": 100, "latent_heat": 4e5}
    case = read_case({
        "geometry": {"generator": "slab", "model": "plane-strain", "length": 0.1, "width": 0.1,
                     "size": 0.1},
        "materials": {"alloy": metal},
        "bodies": [{"name": "casting", "material": "alloy", "temperature": 700}],
        "coupling": {"scheme": "thermal"}, "time": {"end": 1},
    }, Path("case.toml"))  # fmt: skip
    law = case.materials["alloy"].solid_fraction
    assert law.liquidus == pytest.approx(liquidus(SHARE), abs=0.01)


@needs_packages
@pytest.mark.parametrize(("words", "said"), [(["AA", "CC=2"], "no element 'CC'")])
def test_unknown_elements_are_refused(database, words, said):
    with pytest.raises(CaseError, match=said):
        scheil_table(database, Composition.of(words))


@pytest.mark.skipif(HAVE, reason="pycalphad and scheil are installed")
def test_missing_packages_are_refused_with_what_installs_them(database):
    with pytest.raises(CaseError, match="pip install pycalphad scheil"):
        scheil_table(database, Composition.of(["AA", "BB=2"]))


@pytest.mark.parametrize(
    "words", [["AL"], ["AL", "SI"], ["AL", "SI=-1"], ["AL", "SI=7", "SI=8"], ["AL", "SI=100"]]
)
def test_compositions_that_are_none_are_refused(words):
    with pytest.raises(CaseError, match="SI=7"):
        Composition.of(words)
