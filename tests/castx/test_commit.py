"""The commit of castx: of a distribution, a checkout, a further working tree, packed references."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.commit import UNKNOWN, checked_out, commit

pytestmark = pytest.mark.serial

HERE, OTHER = "1234567890" * 4, "abcdef0123" * 4


def repository(folder: Path, head: str, **files: str) -> Path:
    """Return a folder with a .git of these files; two underscores stand for a slash."""
    for name, text in {"HEAD": head, **files}.items():
        path = folder / ".git" / name.replace("__", "/")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"{text}\n")
    return folder


def test_a_head_may_be_a_commit_or_a_branch(tmp_path):
    assert checked_out(repository(tmp_path / "a", HERE)) == HERE
    branch = repository(tmp_path / "b", "ref: refs/heads/main", refs__heads__main=HERE)
    assert checked_out(branch) == HERE


def test_references_may_be_packed(tmp_path):
    packed = f"# pack-refs with: peeled\n{OTHER} refs/heads/mainly\n{HERE} refs/heads/main"
    folder = repository(tmp_path, "ref: refs/heads/main")
    (folder / ".git" / "packed-refs").write_text(packed)
    assert checked_out(folder) == HERE


def test_a_further_working_tree_has_its_references_elsewhere(tmp_path):
    main = repository(tmp_path / "main", "ref: refs/heads/main", refs__heads__main=OTHER,
                      refs__heads__more=HERE, worktrees__more__HEAD="ref: refs/heads/more",
                      worktrees__more__commondir="../..")  # fmt: skip
    further = tmp_path / "more"
    further.mkdir()
    (further / ".git").write_text(f"gitdir: {main / '.git/worktrees/more'}\n")
    assert checked_out(further) == HERE


def test_a_distribution_knows_its_commit_and_what_is_neither_says_so(tmp_path):
    package = repository(tmp_path, OTHER) / "castx"
    package.mkdir()
    assert commit(package) == OTHER
    (package / "commit.txt").write_text(HERE)
    assert commit(package) == HERE
    (package / "commit.txt").write_text("<script>")
    assert commit(package) == OTHER
    (tmp_path / ".git/HEAD").write_text("ref: refs/heads/none")
    assert commit(package) == UNKNOWN
    assert checked_out(package) is None
