"""The shape of the code: who may import what, and what no file may hold."""

from __future__ import annotations

import ast
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

pytestmark = pytest.mark.serial

PROJECT = Path(__file__).parents[1]

# The rooms of castx from the ground: a module imports from its own room and from those before it.
ORDER = [
    "signals start_folder imports arrays errors version commit tables stateful environment ranks "
    "form_rows profiling",
    "forms meshes meshes/cad meshes/generators",
    "input",
    "transfer",
    "transfer/laws transfer/conditions",
    "contact/methods",
    "materials/rules",
    "materials/flow_rules materials/hardening",
    "materials",
    "foundry",
    "foundry/identification",
    "case/processes",
    "case/cad case/fields",
    "case",
    "case/reading",
    "domain/cad",
    "domain",
    "domain/pairs",
    "solvers/inner",
    "solvers",
    "heat/foreign",
    "heat",
    "mechanics/constitutive",
    "mechanics/midsides",
    "mechanics/liquid",
    "mechanics/mush",
    "mechanics",
    "contact/kinematics",
    "contact/friction",
    "contact",
    "equilibrium/supports",
    "equilibrium",
    "coupling",
    "results/files results/states",
    "foundry/front foundry/pools",
    "discretisation",
    "foundry/stress",
    "foundry/followed",
    "results",
    "process",
    "checkpoint",
    "handover",
    "report",
    "report/summary",
    "report/page",
    "studies/asked",
    "studies/runs",
    "studies",
    "studies/inverse",
    "proof/verification",
    "proof/verification/heat",
    "proof/verification/solids proof/verification/contact proof/verification/coupled",
    "proof/verification/foundry",
    "proof/foreign",
    "proof/foreign/cases",
    "proof/validation",
    "proof",
    "app/text",
    "app/forms",
    "app/scenes",
    "app/runs",
    "app",
    "command/watches",
    "command command/beside",
    "__init__ __main__",
]
PLACE = {name: place for place, names in enumerate(ORDER) for name in names.split()}

# Marks of sprawl: lines of a file and of a class, modules of a room.
LONGEST_FILE, LONGEST_CLASS, MOST_MODULES = 400, 250, 18
# What is beyond its mark, as "castx/heat/body.py", "castx/heat/body.py: HeatBody" or "castx/heat",
# with its present size. It may not grow, and its entry follows when it shrinks.
BEYOND: Mapping[str, int] = {}
# Where the user comes in, and all ranks are what is meant if nothing else is said.
ENTRY_POINTS = {PROJECT / "castx/command/cli.py", PROJECT / "castx/command/run.py"}
# What the files of these folders may import, beside the small change of the standard library.
LEGAL_IMPORTS = {
    "forms": {"ufl", "castx.forms"},
    "meshes": {"gmsh", "numpy", "castx.arrays", "castx.meshes"},
}
STANDARD_LIBRARY = {
    "__future__",
    "collections",
    "dataclasses",
    "enum",
    "functools",
    "itertools",
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


def inside_castx(path: Path) -> Path:
    """Return the path of a file of the library inside the package castx."""
    inside = path.relative_to(PROJECT)
    return inside if inside.parts[0] in LEGAL_IMPORTS else inside.relative_to("castx")


def module_name(path: Path) -> str:
    parts = ("castx", *inside_castx(path).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(path): path for path in LIBRARY}


def room_of(module: str) -> str:
    """Return the room of a module: its folder, or its own name beside the rooms."""
    inside = inside_castx(MODULES[module])
    return inside.stem if len(inside.parts) == 1 else inside.parent.as_posix()


def imports(path: Path) -> set[str]:
    """Return the modules of castx that a file imports, anywhere and for types only too."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in MODULES else str(node.module) for name in names}
    return found & set(MODULES)


IMPORTS: Mapping[str, set[str]] = {module: imports(path) for module, path in MODULES.items()}


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


def off_the_mark(
    sizes: Mapping[str, int], most: int, beyond: Mapping[str, int]
) -> dict[str, tuple[int, int]]:
    """Return size and allowed size of what is longer than allowed, or shorter than its entry."""
    allowed = {name: beyond.get(name, min(size, most)) for name, size in sizes.items()}
    out_of_date = {name for name in beyond if sizes.get(name, 0) <= most}
    wrong = {name for name, size in sizes.items() if size != allowed[name]} | out_of_date
    return {name: (sizes.get(name, 0), allowed.get(name, most)) for name in sorted(wrong)}


def test_only_one_file_spells_planes_of_symmetry():
    """All others take the name from `castx.meshes.model`; docstrings may say it."""
    said = []
    for path in LIBRARY:
        tree = ast.parse(path.read_text())
        texts = {n.value for n in ast.walk(tree) if isinstance(n, ast.Expr)}
        constants = (n for n in ast.walk(tree) if isinstance(n, ast.Constant) and n not in texts)
        said += [named(path) for n in constants if str(n.value).startswith("symmetry-")]
    assert said == ["meshes/model.py"]


def test_files_classes_and_rooms_do_not_sprawl():
    files = {named(path): len(path.read_text().splitlines()) for path in LIBRARY}
    bodies = {f"{named(path)}: {c.name}": lines_of(c) for path in LIBRARY for c in classes(path)}
    rooms = Counter(named(path.parent) for path in LIBRARY if path.stem != "__init__")
    marks = ((files, LONGEST_FILE), (bodies, LONGEST_CLASS), (rooms, MOST_MODULES))
    wrong = {}
    for sizes, most in marks:
        of_these = {name: size for name, size in BEYOND.items() if name in sizes}
        wrong |= off_the_mark(sizes, most, of_these)
    assert not wrong, "size and allowed size; see BEYOND"
    assert not set(BEYOND) - set(files) - set(bodies) - set(rooms)


@pytest.mark.parametrize(
    ("size", "beyond", "wrong"),
    [
        (10, {}, False),
        (11, {}, True),
        (14, {"a": 14}, False),
        (15, {"a": 14}, True),
        (13, {"a": 14}, True),
        (10, {"a": 10}, True),
        (0, {"gone": 14}, True),
    ],
)
def test_what_is_beyond_its_mark_neither_grows_nor_shrinks_unseen(size, beyond, wrong):
    assert bool(off_the_mark({"a": size}, 10, beyond)) == wrong


def classes(path: Path) -> list[ast.ClassDef]:
    return [node for node in ast.parse(path.read_text()).body if isinstance(node, ast.ClassDef)]


def lines_of(node: ast.ClassDef) -> int:
    return (node.end_lineno or node.lineno) - node.lineno + 1


def test_no_class_name_stands_twice():
    found: dict[str, list[str]] = {}
    for path in LIBRARY:
        for node in classes(path):
            found.setdefault(node.name, []).append(named(path))
    assert not {name: places for name, places in found.items() if len(places) > 1}


def test_the_order_of_rooms_names_what_is_there():
    tops = {path.stem for path in (PROJECT / "castx").glob("*.py")}
    assert set(PLACE) == {room_of(module) for module in MODULES} | tops
    assert len(PLACE) == sum(len(names.split()) for names in ORDER)


def test_rooms_import_only_from_rooms_before_them():
    upward = [
        f"{module} imports {imported}"
        for module, found in IMPORTS.items()
        for imported in found
        if PLACE[room_of(imported)] > PLACE[room_of(module)]
    ]
    assert not upward


def test_no_circle_of_modules():
    try:
        TopologicalSorter(IMPORTS).prepare()
    except CycleError as circle:
        pytest.fail("modules import each other: " + " -> ".join(circle.args[1]))


@pytest.mark.parametrize("room", [name for name in PLACE if (PROJECT / "castx" / name).is_dir()])
def test_a_room_says_what_it_holds(room):
    folder = PROJECT / "castx" / room
    init = ast.parse((folder / "__init__.py").read_text())
    sentence, *others = (ast.get_docstring(init) or "").split("\n\n")
    public = "".join(part for part in others if part.startswith("Public: "))
    assert sentence.endswith("."), f"{room}/__init__.py must say in a sentence what the room holds"
    assert public, f"{room}/__init__.py must name its public objects"
    missing = [
        name
        for name in re.findall(r"`([\w.]+)`", public)
        if not defines(folder / Path(*name.split(".")[:-1]).with_suffix(".py"), name)
    ]
    assert not missing


def defines(path: Path, name: str) -> bool:
    """Return whether a module defines the last part of a dotted name."""
    if not path.is_file():
        return False
    body = ast.parse(path.read_text()).body
    functions = {n.name for n in body if isinstance(n, ast.FunctionDef | ast.ClassDef)}
    targets = [t for n in body if isinstance(n, ast.Assign) for t in n.targets]
    targets += [n.target for n in body if isinstance(n, ast.AnnAssign)]
    values = {target.id for target in targets if isinstance(target, ast.Name)}
    return name.split(".")[-1] in functions | values


def test_every_module_has_its_test_beside_its_path():
    """castx/heat/body.py is tested in tests/castx/heat/test_body.py, and every other one alike."""
    without = []
    for module, path in MODULES.items():
        if path.stem in ("__init__", "__main__"):
            continue
        inside = inside_castx(path)
        top = PROJECT / "tests" / ("" if inside.parts[0] in LEGAL_IMPORTS else "castx")
        if not (top / inside.with_name(f"test_{inside.name}")).is_file():
            without.append(module)
    assert not without


def test_packages_of_the_build_are_the_folders_on_disk():
    build = tomllib.loads((PROJECT / "pyproject.toml").read_text())["tool"]["setuptools"]
    folders = {path.parent for path in python_files("castx") if path.name == "__init__.py"}
    on_disk = {".".join(folder.relative_to(PROJECT).parts) for folder in folders}
    meshes = {"castx.meshes", "castx.meshes.cad", "castx.meshes.generators"}
    assert set(build["packages"]) == on_disk | {"castx.forms"} | meshes
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
