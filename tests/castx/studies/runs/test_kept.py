"""Runs on disk."""

import pytest

from castx.errors import CaseError
from castx.studies.runs.kept import KEPT, KeptRun, read_kept, write_kept

pytestmark = pytest.mark.serial


def test_it_is_read_back(tmp_path):
    run = KeptRun(
        digest="0 ab", changes={"a.0": [[0, "1 mm"]]}, ended="refused", said="no", seconds=0.1,
        processor_seconds=0.08, folder="runs/ab",
    )  # fmt: skip
    assert read_kept(tmp_path) is None
    write_kept(tmp_path, run)
    assert read_kept(tmp_path) == run
    assert not run.is_finished


def test_a_broken_one_is_refused_with_a_cure(tmp_path):
    (tmp_path / KEPT).write_text('{"digest": ')
    with pytest.raises(CaseError, match=r"kept.json is broken; delete"):
        read_kept(tmp_path)
