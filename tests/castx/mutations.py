"""Case files and meshes spoilt at random, and what castx says of them."""

from __future__ import annotations

import json
import math
import re
import time
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpi4py import MPI

import gmsh
from hypothesis import strategies as st

from castx.case.geometry import Geometry
from castx.command.cli import execute
from castx.domain.source import gmsh_session, write_mesh
from tests.castx.case_data import cylinder

BASE = cylinder(geometry__size="8 mm", probes__1__at=["30 mm", "50 mm"])
LONGEST = 5.0
"""Time in which a refusal has to come [s]."""

WRONG: tuple[Any, ...] = (
    "", " ", "x", "aluminum", "-", "1e999", "nan", "5 parsecs", "20 kg", "30 mm^2", "10 degC",
    "../../etc", "\u0000", "a" * 5000, True, False, 0, -1, -1e-300, 1e300, 1e-300, 10**30,
    math.nan, math.inf, -math.inf, [], [[]], [1, 2, 3, 4], [[0, 1], [0, 2]], [["a", "b"]],
    [[1, 2, 3]], {}, {"x": 1}, {"table": []}, [{}], {"over": "temperature", "table": [[20, 1]]},
    [None],
)  # fmt: skip
"""Values of which hardly any is right anywhere."""


def leaves(value: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Yield the paths to everything inside a value."""
    if isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield (*path, key)
            yield from leaves(item, (*path, key))


PATHS = tuple(leaves(BASE))


def inline(value: Any) -> str:
    """Return a value as TOML has it in one line."""
    if isinstance(value, Mapping):
        pairs = (f"{json.dumps(str(key))} = {inline(item)}" for key, item in value.items())
        return "{" + ", ".join(pairs) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(inline(item) for item in value) + "]"
    if isinstance(value, float) and not math.isfinite(value):
        return "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    return '"none"' if value is None else json.dumps(value)


def toml(data: Mapping[str, Any]) -> str:
    """Return a case file with the content of a table."""
    return "".join(f"{json.dumps(key)} = {inline(value)}\n" for key, value in data.items())


@st.composite
def case_tables(draw: st.DrawFn) -> str:
    """Draw a case file with one to three wrong entries."""
    data = deepcopy(BASE)
    for _ in range(draw(st.integers(1, 3))):
        spoil(draw, data)
    return toml(data)


def spoil(draw: st.DrawFn, data: dict[str, Any]) -> None:
    """Spoil one entry; a path that an earlier one has cut off stays as it is."""
    *above, key = draw(st.sampled_from(PATHS))
    place: Any = data
    try:
        for step in above:
            place = place[step]
        place[key]
    except (LookupError, TypeError):
        return
    match draw(st.sampled_from(("wrong", "wrong", "delete", "rename", "more", "twice"))):
        case "wrong":
            place[key] = draw(st.sampled_from(WRONG))
        case "delete":
            del place[key]
        case "rename" if isinstance(place, dict):
            place[f"{key}{draw(st.sampled_from(('s', '_', 'x', ' ', '')))}"] = place.pop(key)
        case "more" if isinstance(place, dict):
            place[draw(st.sampled_from(("colour", "temperatur", "exec", "__class__")))] = 1
        case "twice" if isinstance(place, list):
            place.append(deepcopy(place[int(key)]))


@st.composite
def case_texts(draw: st.DrawFn) -> bytes:
    """Draw a case file whose text is damaged."""
    text = toml(BASE).encode()
    begin = draw(st.integers(0, len(text) - 1))
    match draw(st.sampled_from(("cut", "delete", "insert", "swap", "double"))):
        case "cut":
            return text[:begin]
        case "delete":
            return text[:begin] + text[begin + draw(st.integers(1, 30)) :]
        case "insert":
            return text[:begin] + draw(st.binary(min_size=1, max_size=8)) + text[begin:]
        case "swap":
            other = draw(st.sampled_from((b'"', b"[", b"=", b"}", b"\n")))
            return text[:begin] + other + text[begin + 1 :]
        case _:
            return text + text.splitlines(keepends=True)[begin % text.count(b"\n")]


def mesh_text(path: Path, version: float) -> bytes:
    """Return the mesh of the case as gmsh writes it in a version of its format."""
    with gmsh_session():
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        write_mesh(Geometry.model_validate(BASE["geometry"]), path)
    return path.read_bytes()


def mesh_case(name: str) -> str:
    """Return the case with a mesh file in place of the generator."""
    return toml({**BASE, "geometry": {"model": "axisymmetric", "file": name}})


@st.composite
def meshes(draw: st.DrawFn, mesh: bytes) -> bytes:
    """Draw a damaged gmsh file."""
    lines = mesh.split(b"\n")
    number = draw(st.integers(0, len(lines) - 1))
    match draw(st.sampled_from(("cut", "flip", "number", "line", "section", "name", "junk"))):
        case "cut":
            return mesh[: draw(st.integers(0, len(mesh)))]
        case "flip":
            place = draw(st.integers(0, len(mesh) - 1))
            other = bytes([mesh[place] ^ draw(st.integers(1, 255))])
            return mesh[:place] + other + mesh[place + 1 :]
        case "number":
            words = lines[number].split(b" ")
            wrong = (b"-1", b"0", b"nan", b"inf", b"1e300", b"99999999", b"x", b"", b"3000000000")
            words[draw(st.integers(0, len(words) - 1))] = draw(st.sampled_from(wrong))
            lines[number] = b" ".join(words)
        case "line":
            del lines[number]
        case "section":
            name = draw(st.sampled_from((b"Entities", b"Nodes", b"Elements", b"PhysicalNames")))
            return re.sub(rb"\$%s.*\$End%s\n" % (name, name), b"", mesh, flags=re.DOTALL)
        case "name":
            old = draw(st.sampled_from((b"casting", b"mould", b"outside", b"base")))
            return mesh.replace(b'"%s"' % old, draw(st.sampled_from((b'"wheel"', b'""', b'"top"'))))
        case _:
            return draw(st.binary(max_size=200))
    return b"\n".join(lines)


@dataclass(frozen=True)
class Answer:
    """What castx made of a file.

    Attributes:
        code: exit code.
        text: what it said.
        seconds: how long it took.
    """

    code: int
    text: str
    seconds: float

    def faults(self, file: Path) -> list[str]:
        """Return what is wrong with a refusal; any other answer must be an accepted case."""
        found = []
        if self.code not in (0, 2):
            found.append(f"exit code {self.code}")
        if "Traceback" in self.text:
            found.append("a traceback")
        if self.seconds > LONGEST:
            found.append(f"it took {self.seconds:.1f} s")
        if self.code == 2 and str(file) not in self.text:
            found.append("the file is not named")
        if self.code == 2 and not re.search(CURES, self.text):
            found.append("no cure")
        return found


CURES = (
    r"allowed|known|needed|needs|must|use |give|at most|at least|available|leave|missing|such as|"
    r"did you mean|increase|makes|unit|not a TOML file|UTF-8|there is no|cannot read|there already|"
    r"more than|has no|has |choose|rename|refine|change|export|add|differ|would fit|letters|either|"
    r"is named|repair"
)
"""Words of which each refusal has at least one: what is allowed, or what to do."""


def answer(file: Path, capsys: Any) -> Answer:
    """Check a case file as a user would."""
    capsys.readouterr()
    begin = time.perf_counter()
    code = execute(["check", str(file)], MPI.COMM_SELF)
    seconds = time.perf_counter() - begin
    captured = capsys.readouterr()
    return Answer(code, " ".join((captured.err + captured.out).split()), seconds)
