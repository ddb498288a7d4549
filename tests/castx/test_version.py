"""The version of the package and of what it reports about itself."""

import tomllib
from pathlib import Path

import pytest
from packaging.version import Version

import castx
from castx.version import __version__

pytestmark = pytest.mark.serial


def test_the_version_is_one_and_a_proper_one():
    build = tomllib.loads((Path(castx.__file__).parents[1] / "pyproject.toml").read_text())
    source = build["tool"]["setuptools"]["dynamic"]["version"]["attr"]
    assert source == "castx.version.__version__"
    assert castx.__version__ == __version__ == str(Version(__version__))
