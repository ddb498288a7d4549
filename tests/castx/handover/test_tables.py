"""Tables of the thermal history: values at nodes and on a grid, by fields that are linear."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.handover.tables import write_exaca, write_nodes
from tests.castx.handover.made_results import box, made

pytestmark = pytest.mark.serial


def made_state(folder, unfrozen=0.0, slowest=1.0):
    points, cells = box(4)
    x = points[:, 0]
    late = np.where(x > 0.03 - unfrozen, np.nan, 5.0 + 100.0 * x)
    fields = {
        "passing_time_0.0": late, "passing_time_1.0": 2.0 * late, "gradient": 1e4 * (1.0 + x),
        "front_speed": 1e-3 * (1.0 + x), "cooling_rate": 10.0 * (slowest + x),
        "arm_spacing": 2e-5 * (1.0 + x),
    }  # fmt: skip
    return made(folder / "out", "3d", points, cells, fields)


def test_nodes_have_all_columns_in_si(tmp_path):
    rows = write_nodes(made_state(tmp_path), tmp_path / "nodes.csv")
    text = (tmp_path / "nodes.csv").read_text()
    assert text.startswith("x,y,z,t_liquidus,t_solidus,G,R,cooling_rate,arm_spacing\n")
    table = np.genfromtxt(tmp_path / "nodes.csv", delimiter=",", names=True)
    assert len(table) == rows == 27
    np.testing.assert_allclose(table["t_solidus"], 10.0 + 200.0 * table["x"], rtol=1e-12)
    np.testing.assert_allclose(table["G"] * table["R"], table["cooling_rate"] * (1 + table["x"]))
    np.testing.assert_allclose(table["arm_spacing"], 2e-5 * (1.0 + table["x"]), rtol=1e-12)


def test_the_grid_of_exaca_has_the_spacing_and_the_values_of_its_points(tmp_path):
    rows, left = write_exaca(made_state(tmp_path), tmp_path / "exaca.csv", 2.5e-3)
    assert (tmp_path / "exaca.csv").read_text().startswith("x,y,z,tm,tl,cr\n")
    table = np.genfromtxt(tmp_path / "exaca.csv", delimiter=",", names=True)
    assert len(table) == rows == 13 * 9 * 5 and left == 0
    np.testing.assert_allclose(np.diff(np.unique(table["x"])), 2.5e-3)
    assert (table["tm"] == 0.0).all()
    np.testing.assert_allclose(table["tl"], 5.0 + 100.0 * table["x"], rtol=1e-6)
    np.testing.assert_allclose(table["cr"], 10.0 * (1.0 + table["x"]), rtol=1e-6)


def test_what_has_not_frozen_is_left_out_and_counted(tmp_path):
    rows, left = write_exaca(made_state(tmp_path, 0.01), tmp_path / "exaca.csv", 2.5e-3)
    assert rows + left == 13 * 9 * 5 and left > 0
    table = np.genfromtxt(tmp_path / "exaca.csv", delimiter=",", names=True)
    assert table["x"].max() < 0.02 and np.isfinite(table["tl"]).all()


def test_what_does_not_cool_is_left_out_and_counted(tmp_path):
    """The cooling rate passes zero between x = 10 and 11 mm."""
    rows, left = write_exaca(made_state(tmp_path, slowest=-0.0101), tmp_path / "exaca.csv", 2.5e-3)
    table = np.genfromtxt(tmp_path / "exaca.csv", delimiter=",", names=True)
    assert (table["cr"] > 0.0).all() and table["x"].min() == pytest.approx(0.0125)
    assert len(table) == rows == 8 * 9 * 5 and left == 5 * 9 * 5


def test_missing_fields_and_fine_grids_are_refused(tmp_path):
    state = made_state(tmp_path)
    with pytest.raises(CaseError, match="take a larger one"):
        write_exaca(state, tmp_path / "exaca.csv", 1e-6)
    points, cells = box(4)
    bare = made(tmp_path / "bare", "3d", points, cells)
    with pytest.raises(CaseError, match=r"passing_time_0.0, cooling_rate .*ExaCA"):
        write_exaca(bare, tmp_path / "exaca.csv", 1e-3)
    with pytest.raises(CaseError, match=r'"passing_times", "gradient"'):
        write_nodes(bare, tmp_path / "nodes.csv")
