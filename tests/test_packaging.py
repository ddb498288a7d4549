"""What is installed: dependencies are what is imported, wheels are complete, versions agree."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from datetime import date
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.version import Version

from castx.version import __version__
from tests.test_architecture import LIBRARY, PROJECT, imported_modules, inside_castx

pytestmark = pytest.mark.serial

BUILD = tomllib.loads((PROJECT / "pyproject.toml").read_text())["project"]
MODULES_OF = {
    "dolfinx-solver-real": {"basix", "dolfinx", "petsc4py", "ufl"},
    "vtk": {"vtkmodules"},
}
"""Modules of packages, where their names differ or they bring several."""
KINDS = ["Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"]
"""Kinds of changes, as Keep a Changelog has them."""
COMMIT = "0123456789" * 4
"""Of the checkout from which the distributions are built."""
CONDA_NAMES = {
    "dolfinx-solver-real": {"fenics-dolfinx", "petsc", "petsc4py"},
    "gmsh": {"python-gmsh"},
    "matplotlib": {"matplotlib-base"},
}


def required(*extras: str) -> set[str]:
    """Return the names of the packages that castx needs, DOLFINx and those of extras among them."""
    chosen = [BUILD["optional-dependencies"][extra] for extra in ("fenicsx", *extras)]
    return {Requirement(text).name for text in sum(chosen, BUILD["dependencies"])}


def modules_of(package: str) -> set[str]:
    return MODULES_OF.get(package, {package.replace("-", "_")})


def test_dependencies_are_what_is_imported():
    imported = {name.split(".")[0] for path in LIBRARY for name in imported_modules(path)}
    imported -= {"castx", *sys.stdlib_module_names}
    packages = required("calphad", "app", "slurm", "tables")
    assert imported == set().union(*(modules_of(name) for name in packages))


def test_the_conda_environment_has_the_same_packages():
    lines = re.findall(r"^  - ([\w-]+)(?: |$)", (PROJECT / "environment.yml").read_text(), re.M)
    packages = set().union(*(CONDA_NAMES.get(name, {name}) for name in required()))
    channels, tools = {"conda-forge", "nodefaults"}, {"python", "pip", "setuptools"}
    assert set(lines) == packages | channels | tools


def changelog() -> dict[str, str]:
    """Return the entries of the changelog by their headings, such as "[0.1.0] - 2026-11-23"."""
    _, *parts = re.split(r"^## (.+)\n", (PROJECT / "CHANGELOG.md").read_text(), flags=re.M)
    return dict(zip(parts[::2], parts[1::2], strict=True))


def test_the_changelog_begins_with_what_is_unreleased_and_goes_on_with_dated_versions():
    unreleased, *released = changelog()
    assert unreleased == "[Unreleased]"
    forms = [re.fullmatch(r"\[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)", line) for line in released]
    assert all(forms), f"CHANGELOG.md: a version is '## [0.1.0] - 2026-11-23': {released}"
    entries = [(Version(form[1]), date.fromisoformat(form[2])) for form in forms if form]
    assert entries == sorted(entries, reverse=True)


@pytest.mark.parametrize(("heading", "text"), changelog().items())
def test_an_entry_of_the_changelog_has_lists_below_its_kinds_of_changes(heading, text):
    before, *parts = re.split(r"^### (.+)\n", text, flags=re.M)
    kinds, lists = parts[::2], parts[1::2]
    assert kinds == sorted(set(kinds), key=KINDS.index), f"{heading}: kinds are {KINDS}, in order"
    assert "\n- " not in f"\n{before}", f"{heading}: a change stands below one of {KINDS}"
    for kind, items in zip(kinds, lists, strict=True):
        lines = [line for line in items.splitlines() if line]
        assert lines and lines[0].startswith("- "), f"{heading}, {kind}: a list is needed"
        assert not [line for line in lines if not line.startswith(("- ", "  "))], heading


def test_the_newest_version_of_the_changelog_and_the_citation_are_of_this_version():
    newest = re.findall(r"\[(.+?)\]", list(changelog())[1])
    assert newest == [__version__]
    citation = (PROJECT / "CITATION.cff").read_text()
    assert re.findall(r"^version: (.+)$", citation, re.M) == [__version__]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The folder of a source distribution, and of the wheel that is built from it."""
    checkout, dist = (tmp_path_factory.mktemp(name) for name in ("checkout", "dist"))
    passed_over = shutil.ignore_patterns(".*_cache", "__pycache__", "*.egg-info", "_build")
    shutil.copytree(
        PROJECT, checkout, symlinks=True, dirs_exist_ok=True,
        ignore=lambda folder, names: {".git", *passed_over(folder, names)},
    )  # fmt: skip
    (checkout / ".git").mkdir()
    (checkout / ".git" / "HEAD").write_text(f"{COMMIT}\n")
    build(checkout, "sdist", dist)
    with tarfile.open(dist / f"castx-{__version__}.tar.gz") as archive:
        archive.extractall(dist, filter="data")
    build(dist / f"castx-{__version__}", "wheel", dist)
    return dist


def build(source: Path, kind: str, dist: Path) -> None:
    command = f"from setuptools import build_meta; build_meta.build_{kind}({str(dist)!r})"
    ended = subprocess.run(
        [sys.executable, "-c", command], cwd=source, capture_output=True, text=True, timeout=300,
        check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr


def test_the_wheel_holds_the_whole_library_and_nothing_else(built):
    """Built from the source distribution, which therefore is complete too."""
    with zipfile.ZipFile(built / f"castx-{__version__}-py3-none-any.whl") as wheel:
        names = set(wheel.namelist())
        metadata = wheel.read(f"castx-{__version__}.dist-info/METADATA").decode()
        assert wheel.read("castx/commit.txt").decode() == f"{COMMIT}\n"
    others = (path for path in (PROJECT / "castx").rglob("*") if path.is_file())
    files = [*LIBRARY, *(path for path in others if path.suffix not in {".py", ".pyc"})]
    expected = {f"castx/{inside_castx(path)}" for path in files} | {"castx/commit.txt"}
    assert {name for name in names if ".dist-info/" not in name} == expected
    for part in ("forms/heat", "meshes/cad/reading", "materials/database/", "report/page/"):
        assert any(name.startswith(f"castx/{part}") for name in names), part
    assert f"Version: {__version__}\n" in metadata
    assert {f"{name}" for name in required()} <= set(
        re.findall(r"^Requires-Dist: ([\w-]+)", metadata, re.M)
    )


def test_what_is_installed_has_a_tested_version():
    """The wheels by a constraint of pip, the Debian packages by a list of their versions."""
    wheels = {
        re.sub(r"[-_.]+", "-", name).lower(): version
        for name, version in re.findall(
            r"^([\w.-]+)==(\S+)$", (PROJECT / "bin/wheels-lock.txt").read_text(), re.M
        )
    }
    extras = BUILD["optional-dependencies"]
    for requirement in (*BUILD["dependencies"], *extras["fenicsx"], *extras["test"]):
        name, _, least = requirement.partition(">=")
        parts = [[int(n) for n in re.findall(r"\d+", v)] for v in (wheels[name.lower()], least)]
        assert parts[0] >= parts[1], requirement
    packages = re.sub(r"#.*", "", (PROJECT / "bin/debian-packages.txt").read_text()).split()
    versions = (PROJECT / "bin/debian-versions.txt").read_text()
    assert set(packages) <= set(re.findall(r"^([\w.+-]+)=\d", versions, re.M))


def test_the_source_distribution_holds_what_users_and_developers_need(built):
    source = built / f"castx-{__version__}"
    for name in (
        "CHANGELOG.md", "CITATION.cff", "COPYING.LESSER", "Dockerfile", "README.md",
        "environment.yml", "bin/with-fenicsx", "demos/cylinder.toml", "docs/install.md",
        "tests/conftest.py",
    ):  # fmt: skip
        assert (source / name).is_file(), name
