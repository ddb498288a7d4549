"""The page of a folder with a bar from CAD, open in a headless browser."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.cad_files import write_cad
from tests.castx.app.browser import Browser, found_browser
from tests.castx.app.served import served


@contextmanager
def opened_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, files: Mapping[str, str]
) -> Iterator[tuple[Browser, Path]]:
    """Give the browser and the folder; the page must not have had errors in the end.

    Args:
        tmp_path: for the folder and the profile of the browser.
        monkeypatch: of the test, which runs in the folder.
        files: texts beside `bar.step`, by the names of their files.
    """
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)
    write_cad(folder / "bar.step", lambda occ: [occ.addBox(0, 0, 0, 60, 20, 20)], ["bar"])
    for name, text in files.items():
        (folder / name).write_text(text)
    with (
        served(folder, claim=False) as page,
        Browser(found_browser() or "", tmp_path / "profile") as browser,
    ):
        browser.open(page.address)
        browser.wait_for("document.body && document.body.dataset.ready === 'yes'")
        yield browser, folder
        assert browser.errors == []
