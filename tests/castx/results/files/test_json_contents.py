"""Small JSON files of a results folder."""

import pytest

from castx.errors import CaseError
from castx.results.files.json_contents import JsonContents, read_json, write_json

pytestmark = pytest.mark.serial


class Place(JsonContents):
    name: str
    depth: float


def test_what_is_written_is_read_with_its_letters(tmp_path):
    file, place = tmp_path / "place.json", Place(name="Straße", depth=0.1)
    assert read_json(file, Place) is None
    write_json(file, place)
    assert read_json(file, Place) == place
    assert "Straße" in file.read_text(encoding="utf-8")


@pytest.mark.parametrize("text", ["", "[]", '{"name": "a", "depth": NaN}', '{"depth": 1.0}'])
def test_other_contents_are_refused(tmp_path, text):
    (tmp_path / "place.json").write_text(text)
    with pytest.raises(CaseError, match=r"place.json cannot be read"):
        read_json(tmp_path / "place.json", Place)
