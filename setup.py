"""What `pyproject.toml` cannot say: distributions hold the commit of the checkout they are of."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

CHECKOUT = Path(__file__).parent
COMMIT = runpy.run_path(str(CHECKOUT / "castx" / "commit.py"))


def write_commit(package: Path) -> None:
    """Write the commit into a folder of castx; a source distribution has it there already."""
    found = COMMIT["checked_out"](CHECKOUT)
    if found is not None:
        (package / COMMIT["BUILT"]).write_text(f"{found}\n")


class BuildWithCommit(build_py):
    """Modules of a wheel, and the commit beside them."""

    def run(self) -> None:
        """Copy modules and data."""
        super().run()
        if not self.editable_mode:
            write_commit(Path(self.build_lib) / "castx")


class SourcesWithCommit(sdist):
    """Files of a source distribution, and the commit among them."""

    def make_release_tree(self, base_dir: str, files: Any) -> None:
        """Copy the files."""
        super().make_release_tree(base_dir, files)
        write_commit(Path(base_dir) / "castx")


setup(cmdclass={"build_py": BuildWithCommit, "sdist": SourcesWithCommit})
