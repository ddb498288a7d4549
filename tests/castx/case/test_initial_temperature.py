"""The description of initial temperatures, and what a case makes of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista

from castx.case.initial_temperature import read_initial_temperature
from castx.case.reading.read import read_case
from castx.command.run import RunSettings, run_case
from castx.errors import CaseError
from tests.coupled_cases import ALUMINIUM, cylinder, merged, nodal, places, simulation

ALONG_Z = {"along": "z", "table": [[0, 150], ["60 mm", "523.15 K"]]}


def with_temperatures(casting, mould, **changes):
    """Return the cylinder as a thermal case."""
    data = cylinder({"coupling": {"scheme": "thermal"}, "time": {"end": 1.0, "fixed_step": 0.5}})
    data["bodies"][0]["temperature"], data["bodies"][1]["temperature"] = casting, mould
    return merged(data, changes)


@pytest.mark.serial
def test_numbers_tables_and_files():
    one = read_initial_temperature("943.15 K")
    assert (one.uniform, one.bounds) == (pytest.approx(670.0), pytest.approx((670.0, 670.0)))
    along = read_initial_temperature(ALONG_Z)
    assert along.uniform is None and along.hottest == pytest.approx(250.0)
    assert along.at([[9.0, 0.03]]) == pytest.approx([200.0])
    assert along.text == "150 to 250 °C along z"
    formula = read_initial_temperature({"formula": "150 + 1e3*z + r"})
    assert (formula.uniform, formula.bounds, formula.hottest) == (None, None, np.inf)
    assert formula.at([[9.0, 0.05]]) == pytest.approx([209.0])
    assert formula.text == "150 + 1e3*z + r °C"
    grid = {"along": ["r", "z"], "table": [[0, 0, 10], [1, 0, 20], [0, 1, "303.15 K"], [1, 1, 80]]}
    plane = read_initial_temperature(grid)
    assert plane.bounds == (10.0, 80.0) and plane.text == "10 to 80 °C along r and z"
    assert plane.at([[0.5, 0.5]]) == pytest.approx([35.0])
    file = read_initial_temperature({"file": "filling.vtu", "field": "T", "unit": "K"})
    assert (file.bounds, file.hottest, file.text) == (None, np.inf, "T of filling.vtu")
    assert file.relative_to(Path("/cases/a.toml")).file.path == Path("/cases/filling.vtu")


@pytest.mark.serial
@pytest.mark.parametrize(
    "value, text",
    [
        ("5 m", "'m' is not a unit of temperature"),
        (-300, "below absolute zero"),
        ({"along": "z"}, "table: missing; along and table are needed"),
        ({"along": "t", "table": [[0, 1]]}, "along: unknown; allowed: x, y, z, r"),
        ({"along": "z", "table": [[0, 1], [0, 2]]}, r"table\[1\]: the first column"),
        ({"along": "z", "table": [[0, "1 m"]]}, r"table\[0\]: 'm' is not a unit of temperature"),
        ({"along": "z", "table": [[0, 1]], "unit": "K"}, "unit: unknown key"),
        ({"file": "a.vtu"}, "field: missing; file and field are needed"),
        ({"file": "a.vtu", "field": "T", "units": "K"}, r'units: unknown key.*mean "unit"\?'),
        ({"file": "a.vtu", "field": "T", "unit": "Kelvin"}, "unit: unknown; allowed: degC, K, de"),
        ({"file": "a.py", "field": "T"}, "file: a file of type .vtu, .xdmf, .hdf is needed"),
        ({"file": 3, "field": "T"}, "file: a text in quotes"),
        ({"file": "a.vtu", "field": ""}, "field: a text in quotes"),
    ],
)
def test_refused(value, text):
    with pytest.raises(CaseError, match=text):
        read_initial_temperature(value)


@pytest.mark.serial
@pytest.mark.parametrize(
    "changes, text",
    [
        ({"coupling": {"scheme": "mechanical"}}, 'must be uniform with coupling.scheme = "mechan'),
    ],
)
def test_what_a_field_needs(changes, text):
    with pytest.raises(CaseError, match=text):
        read_case(with_temperatures(670.0, ALONG_Z, **changes), Path("case.toml"))


@pytest.mark.serial
def test_coordinate_of_the_model():
    wrong = {"along": "x", "table": [[0, 150], [1, 200]]}
    with pytest.raises(CaseError, match=r"temperature.along.*coordinates of this model: r, z"):
        read_case(with_temperatures(670.0, wrong), Path("case.toml"))
    with pytest.raises(CaseError, match=r"temperature.formula.*not x; coordinates of this model"):
        read_case(with_temperatures(670.0, {"formula": "20 + x"}), Path("case.toml"))


def test_a_formula_is_the_start_of_a_run_unless_it_gives_no_temperature(comm):
    data = with_temperatures(670.0, {"formula": "200 + 1e3*z*z - 100*r"})
    first = next(iter(simulation(comm, data)))
    r, z = places(first, "mould")[:, :2].T
    found, given = nodal(first, "mould", "temperature"), 200 + 1e3 * z * z - 100 * r
    np.testing.assert_allclose(np.sort(found), np.sort(given))
    for wrong in ("-300 - z", "1/(z - z)"):
        with pytest.raises(CaseError, match=r"temperature of 'mould'.*not finite or below"):
            simulation(comm, with_temperatures(670.0, {"formula": wrong}))


@pytest.mark.parametrize("metal", ["steel", "copper"])
def test_a_field_is_free_of_strain_as_it_starts(metal, comm, shared_tmp_path):
    """Its gradient strains nothing; with a given stress-free temperature it bends the mould."""
    copper = {**ALUMINIUM, "solidus": 1084.0, "liquidus": 1084.0}
    changes = {
        "coupling": {"scheme": "iterated"}, "materials": {"copper": copper},
        "time": {"end": 1e-6},
    }  # fmt: skip
    data = with_temperatures(670.0, ALONG_Z, **changes)
    data["bodies"][1]["material"] = metal

    def moved() -> float:
        *_, state = simulation(comm, data)
        return float(np.abs(nodal(state, "mould", "displacement")).max())

    assert moved() < 1e-9
    data["materials"][metal] = {**data["materials"][metal], "stress_free": 200.0}
    assert moved() > 1e-5


@pytest.mark.ranks
def test_the_stress_free_field_of_a_file_outlives_the_file(comm, shared_tmp_path):
    """A checkpoint keeps it: what starts from another field has the old strain again."""
    changes = {"coupling": {"scheme": "iterated"}, "time": {"end": 1e-6}}
    made = simulation(comm, with_temperatures(670.0, ALONG_Z, **changes))
    for _ in made:
        pass
    saved = made.process.now.problem.mechanics.bodies["mould"].material
    other = {"along": "z", "table": [[0, 20], [1, 30]]}
    again = simulation(comm, with_temperatures(670.0, other, **changes))
    material = again.process.now.problem.mechanics.bodies["mould"].material
    before = material.law.stress_free_state.temperature
    material.restore({name: part.values for name, part in saved.saved().items()})
    after = material.law.stress_free_state.temperature
    assert np.abs(before - 20.0).max(initial=0.0) < 1.0
    np.testing.assert_array_equal(after, saved.law.stress_free_state.temperature)
    assert np.all(after >= 150.0)


def test_table_along_a_coordinate(comm):
    state = next(iter(simulation(comm, with_temperatures(670.0, ALONG_Z))))
    z = places(state, "mould")[:, 1]
    owned = len(z)
    found = state.nodal("mould", "temperature")
    assert found[:owned] == pytest.approx(150.0 + 100.0 * z / 0.06)
    by_radius = {"along": "r", "table": [[0.03, 300], [0.055, 200]]}
    state = next(iter(simulation(comm, with_temperatures(670.0, by_radius))))
    r = places(state, "mould")[:, 0]
    expected = np.interp(r, [0.03, 0.055], [300, 200])
    assert state.nodal("mould", "temperature")[:owned] == pytest.approx(expected)


def temperature(points):
    """Return a linear field, in K."""
    return 700.0 + 2000.0 * points[:, 0] - 3000.0 * points[:, 1]


def test_field_of_another_program(comm, shared_tmp_path):
    """A file of another mesh, in kelvin, beside the case: exact for a linear field."""
    if comm.rank == 0:
        grid = pyvista.ImageData(dimensions=(8, 11, 1), spacing=(0.01, 0.0071, 1.0))
        grid = grid.cast_to_unstructured_grid().triangulate()
        grid["T"] = temperature(grid.points)
        grid.save(shared_tmp_path / "filling.vtu")
    comm.Barrier()
    given = {"file": "filling.vtu", "field": "T", "unit": "K"}
    data = with_temperatures(given, given)
    state = next(iter(simulation(comm, data, shared_tmp_path)))
    for body in ("casting", "mould"):
        expected = temperature(places(state, body)) - 273.15
        found = state.nodal(body, "temperature")[: len(expected)]
        assert found == pytest.approx(expected, abs=1e-3)  # the file holds single precision
    missing = with_temperatures({**given, "field": "temp"}, given)
    with pytest.raises(CaseError, match=r"initial temperature of 'casting': .*no field 'temp'"):
        simulation(comm, missing, shared_tmp_path)


@pytest.mark.ranks
def test_our_own_results_hand_over(comm, shared_tmp_path):
    """The last state of a run is the start of another: to single rounding on the same mesh."""
    data = with_temperatures(670.0, ALONG_Z, output={"folder": str(shared_tmp_path / "first")})
    run_case(read_case(data, shared_tmp_path / "case.toml"), RunSettings(comm))
    *_, last = simulation(comm, data)
    file = "first/fields/mould.hdf"
    again = with_temperatures(670.0, {"file": file, "field": "temperature"})
    state = next(iter(simulation(comm, again, shared_tmp_path)))
    expected = nodal(last, "mould", "temperature")
    assert nodal(state, "mould", "temperature") == pytest.approx(expected, rel=1e-6)
