"""Series are whole lines with all digits, survive being cut off and go on behind a checkpoint."""

import numpy as np
import pytest

from castx.results.files.series import (
    Series,
    change_columns,
    cut_back,
    damage_of,
    read_series,
)

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


@pytest.mark.parametrize(("left", "rows"), [(0, []), (5, []), (15, [0.0]), (18, [0.0])])
def test_a_file_that_is_cut_during_a_run_keeps_whole_lines_and_says_so(
    tmp_path, caplog, left, rows
):
    path = tmp_path / "s.csv"
    with Series(path, ["time", "a"]) as series:
        for k in range(3):
            series.append([float(k), 1.0])
        with path.open("r+") as file:
            file.truncate(left)
        series.append([3.0, 1.0])
        series.append([4.0, 1.0])
    assert read_series(path)["time"].tolist() == [*rows, 3.0, 4.0]
    assert [record for record in caplog.records if "was cut short during the run" in record.msg]


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


@pytest.mark.parametrize("replace", [False, True])
def test_a_file_that_is_removed_meanwhile_is_made_anew(tmp_path, replace):
    path = tmp_path / "s.csv"
    with Series(path, ["time", "a"]) as series:
        series.append([0.0, 1.0])
        path.unlink()
        if replace:
            path.write_text("of somebody else")
        series.append([1.0, 2.0])
        assert read_series(path)["a"].tolist() == [1.0, 2.0]
        series.append([2.0, 3.0])
        path.unlink()
    assert path.read_text() == "time,a\n0.0,1.0\n1.0,2.0\n2.0,3.0\n"


def test_a_folder_that_is_removed_meanwhile_is_an_error_of_the_disk(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    series = Series(folder / "s.csv", ["time"])
    (folder / "s.csv").unlink()
    folder.rmdir()
    with pytest.raises(OSError, match="No such file"):
        series.append([0.0])
    with pytest.raises(OSError, match="No such file"):
        series.sync()


@pytest.mark.parametrize(
    ("content", "damage"),
    [
        (b"time,a\n0.0,1.0\n1.0,2.0\n9.0,3.0\n", None),
        (b"time,a\n0.0,1.0\n", "it has 1 lines, and 2 were written before the checkpoint"),
        (b"time,a\n1.0,1.0\n0.0,2.0\n", "line 3 does not come after the one before it in time"),
        (b"time,a\n0.0,1.0\n0.5,2.0\n", "its line 3 is of t = 0.5 s, the checkpoint of 1 s"),
        (b"time,a\n0.0,1.0\n1.0\n", "it is no table of numbers"),
        (b"time,a\n0.0,one\n1.0,2.0\n", "it is no table of numbers"),
        (b"time,a\n0.0,\xff\n1.0,2.0\n", "it is no table of numbers"),
        (b"a,time\n1.0,0.0\n2.0,1.0\n", "its first column is not time"),
        (b"", "its first column is not time"),
    ],
)
def test_a_series_is_as_it_was_at_the_checkpoint_or_damaged(tmp_path, content, damage):
    (tmp_path / "s.csv").write_bytes(content)
    found = damage_of(tmp_path / "s.csv", 2, 1.0)
    assert found == damage or (damage is not None and str(found).startswith(damage))


@pytest.mark.parametrize("content", [b"", b"time,a\n1,x\n", b"time,a,a\n1,2,3\n", b"time\n\xff\n"])
def test_what_is_no_series_is_not_read(tmp_path, content):
    (tmp_path / "s.csv").write_bytes(content)
    with pytest.raises(ValueError):
        read_series(tmp_path / "s.csv")


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"time,a\n0,1\n1\n2,3\n", "line 3 has 1 entries for 2 columns"),
        (b"time,a\n0,1\n2,1\n1,3\n", "line 4 does not come after the one before it in time"),
        (b"time,a\n0,1\nnan,1\n", "line 3 does not come after"),
        (b"time,a\n0,1\ninf,1\n", "line 3 does not come after"),
    ],
)
def test_lines_that_were_lost_or_moved_are_named(tmp_path, content, why):
    (tmp_path / "s.csv").write_bytes(content)
    with pytest.raises(ValueError, match=why):
        read_series(tmp_path / "s.csv")
