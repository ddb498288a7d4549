"""The shape of the code: who may import what, and what no file may hold."""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.serial

PROJECT = Path(__file__).parents[1]
LONGEST_FILE = 400
# Where the user comes in, and all ranks are what is meant if nothing else is said.
ENTRY_POINTS = {PROJECT / "castx/command/cli.py", PROJECT / "castx/command/run.py"}
# What the files of these folders may import, beside the small change of the standard library.
LEGAL_IMPORTS = {
    "forms": {"ufl", "castx.forms"},
    "meshes": {"gmsh", "numpy", "castx.meshes"},
}
STANDARD_LIBRARY = {
    "__future__",
    "collections",
    "dataclasses",
    "enum",
    "functools",
    "math",
    "typing",
}


def python_files(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (PROJECT / folder).rglob("*.py"))


LIBRARY = python_files("castx", "forms", "meshes")


def named(path: Path) -> str:
    return str(path.relative_to(PROJECT))


def imported_modules(path: Path) -> Iterator[str]:
    """Yield the full name of every imported module, wherever in the file the import stands."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "." * node.level + (node.module or "")


def within(module: str, packages: set[str]) -> bool:
    return any(module == package or module.startswith(package + ".") for package in packages)


@pytest.mark.parametrize("folder", LEGAL_IMPORTS)
def test_leaf_packages_import_only_their_tool(folder):
    legal = LEGAL_IMPORTS[folder] | STANDARD_LIBRARY
    illegal = [
        f"{named(path)} imports {module}"
        for path in python_files(folder)
        for module in imported_modules(path)
        if not within(module, legal)
    ]
    assert not illegal


def test_leaf_packages_have_one_name():
    files = LIBRARY + python_files("tests", "demos", "bench")
    second_name = [
        f"{named(path)} imports {module}"
        for path in files
        for module in imported_modules(path)
        if within(module, set(LEGAL_IMPORTS)) or module.startswith(".")
    ]
    assert not second_name


@pytest.mark.parametrize(
    "question", ["dolfinx.__version__", 'version("fenics-dolfinx")', "ImportError"]
)
def test_only_compat_knows_versions(question):
    files = [path for path in LIBRARY if path != PROJECT / "castx/domain/compat.py"]
    assert not [named(path) for path in files if question in path.read_text()]


def places(path: Path, expression: str) -> list[str]:
    """Return where a file uses a name, or an attribute of a name."""
    return [
        f"{named(path)}:{node.lineno}"
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Name | ast.Attribute) and ast.unparse(node) == expression
    ]


def test_library_takes_its_communicator():
    files = [path for path in LIBRARY if path not in ENTRY_POINTS]
    assert not [place for path in files for place in places(path, "MPI.COMM_WORLD")]


def test_library_does_not_print():
    assert not [place for path in LIBRARY for place in places(path, "print")]


def test_files_stay_short():
    lengths = {named(path): len(path.read_text().splitlines()) for path in LIBRARY}
    assert not {name: lines for name, lines in lengths.items() if lines > LONGEST_FILE}


def test_packages_of_the_build_are_the_folders_on_disk():
    build = tomllib.loads((PROJECT / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = {path.parent for path in python_files("castx") if path.name == "__init__.py"}
    on_disk = {".".join(folder.relative_to(PROJECT).parts) for folder in folders}
    assert set(build["packages"]) == on_disk | {"castx.forms", "castx.meshes"}
    for package, folder in build["package-dir"].items():
        assert (PROJECT / folder / "__init__.py").is_file()
        assert (PROJECT / package.replace(".", "/")).resolve() == PROJECT / folder


def test_build_takes_every_other_file_along():
    build = tomllib.loads((PROJECT / "pyproject.toml").read_text())["tool"]["setuptools"]
    package = PROJECT / "castx"
    taken = {path for glob in build["package-data"]["castx"] for path in package.glob(glob)}
    files = {path for path in package.rglob("*") if path.is_file()}
    assert taken == {path for path in files if path.suffix not in {".py", ".pyc"}}


def test_every_folder_of_the_library_is_a_package():
    without = {path.parent for path in LIBRARY if not (path.parent / "__init__.py").exists()}
    assert not without


def test_image_and_launcher_install_the_same_packages():
    image = (PROJECT / "Dockerfile").read_text()
    recipe = (PROJECT / "bin/build-root").read_text()
    for package_list in ("debian-packages.txt", "dpkg-excludes.conf"):
        assert f"bin/{package_list}" in image
        assert f"$here/{package_list}" in recipe
    assert image.count("apt-get install") == image.count("xargs apt-get install") == 1
