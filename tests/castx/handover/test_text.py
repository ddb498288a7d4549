"""Numbers keep all their digits, and a folder that cannot be written is named."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.handover.text import digits, row, write_lines

pytestmark = pytest.mark.serial


def test_rows_keep_twelve_digits_and_more():
    values = np.array([1.0 / 3.0, -1.23456789012345e8])
    assert [float(x) for x in row(values).split(",")] == pytest.approx(values, rel=1e-13)


@pytest.mark.parametrize("value", [-1.30702915157599e-09, -1.0 / 3.0e10, 1e-300, -6.02214076e23])
def test_numbers_have_twenty_characters_at_most(value):
    assert len(digits(value)) <= 20
    assert float(digits(value)) == pytest.approx(value, rel=1e-13, abs=1e-99)


def test_files_are_written_with_their_folder(tmp_path):
    path = tmp_path / "new" / "file.inp"
    write_lines(path, iter(["a", "b"]))
    assert path.read_text() == "a\nb\n"
    with pytest.raises(CaseError, match="cannot write"):
        write_lines(path / "below", ["a"])
