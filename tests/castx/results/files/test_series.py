"""Series are whole lines with all digits, survive being cut off and go on behind a checkpoint."""

import numpy as np
import pytest

from castx.results.files.series import Series, change_columns, cut_back, read_series

pytestmark = pytest.mark.serial


def test_lines_are_on_disk_at_once_and_a_cut_line_is_left_out(tmp_path):
    with Series(tmp_path / "s.csv", ["time", "a.b"]) as series:
        series.append([0.0, 1.0])
        series.append([1.0, float("nan")])
        text = (tmp_path / "s.csv").read_text()
    (tmp_path / "cut.csv").write_text(text + "2.0")
    read = read_series(tmp_path / "cut.csv")
    np.testing.assert_array_equal(read["time"], [0.0, 1.0])
    np.testing.assert_array_equal(read["a.b"], [1.0, np.nan])


def test_a_line_of_the_wrong_length_is_an_error(tmp_path):
    with Series(tmp_path / "s.csv", ["time"]) as series:
        with pytest.raises(ValueError, match="1 columns"):
            series.append([0.0, 1.0])


def test_a_series_is_cut_back_and_goes_on_with_other_columns(tmp_path):
    path = tmp_path / "s.csv"
    with Series(path, ["time", "a", "b"]) as series:
        for k in range(4):
            series.append([0.1 * k, 1.0 / 3.0, float(k)])
    path.write_text(path.read_text() + "0.4,0.3")
    whole = path.read_text().splitlines(keepends=True)
    cut_back(path, 2)
    assert path.read_text() == "".join(whole[:3])
    with Series(path, ["time", "a", "b"], resumed=True) as series:
        series.append([0.2, 1.0 / 3.0, 2.0])
    assert path.read_text() == "".join(whole[:3]) + "0.2,0.3333333333333333,2.0\n"
    with Series(path, ["time", "b", "c"], resumed=True) as series:
        series.append([0.3, 3.0, 7.0])
    read = read_series(path)
    np.testing.assert_array_equal(read["b"], [0.0, 1.0, 2.0, 3.0])
    np.testing.assert_array_equal(read["c"], [np.nan, np.nan, np.nan, 7.0])
    cut_back(tmp_path / "none.csv", 3)
    with Series(tmp_path / "none.csv", ["time"], resumed=True) as series:
        series.append([1.0])
    assert read_series(tmp_path / "none.csv")["time"].tolist() == [1.0]


def test_numbers_are_read_with_the_same_bits(tmp_path):
    numbers = [1.0 / 3.0, 1e-300, -np.pi * 1e10, np.nextafter(1.0, 2.0)]
    with Series(tmp_path / "s.csv", ["a", "b", "c", "d"]) as series:
        series.append(numbers)
    assert [column[0] for column in read_series(tmp_path / "s.csv").values()] == numbers


def test_columns_change_their_order_and_missing_ones_are_not_a_number(tmp_path):
    path = tmp_path / "s.csv"
    path.write_text("time,a\n0.0,1.5\n1.0,2.5\n")
    change_columns(path, ["a", "new", "time"])
    assert path.read_text() == "a,new,time\n1.5,nan,0.0\n2.5,nan,1.0\n"
