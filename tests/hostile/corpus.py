"""Input that has brought programs down: each entry makes its files and says how it is refused.

An entry gets an empty folder and returns the arguments of castx and a pattern that the refusal has.
"""

from __future__ import annotations

import base64
import itertools
import json
import os
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

Entry = Callable[[Path], tuple[list[str], str]]
ENTRIES: dict[str, Entry] = {}
HEAVY: set[str] = set()
"""Entries that take a process of their own: they ended it, or filled its memory."""

CASE = """
{more}
[geometry]
generator = "slab"
model = "plane-strain"
length = "20 mm"
width = "10 mm"
size = "5 mm"
[[bodies]]
name = "casting"
material = "{material}"
temperature = {temperature}
[time]
end = {end}
{time}
"""
FIELD = '{ file = "FILE", field = "T" }'


def entry(*, heavy: bool = False) -> Callable[[Entry], Entry]:
    """Enter a function into the corpus under its name."""

    def entered(function: Entry) -> Entry:
        ENTRIES[function.__name__] = function
        if heavy:
            HEAVY.add(function.__name__)
        return function

    return entered


def check(folder: Path, **changes: str) -> list[str]:
    """Write a case file with changes and return the arguments to check it."""
    given = {"material": "Al-pure", "temperature": "670", "end": "1", "more": "", "time": ""}
    (folder / "case.toml").write_text(CASE.format(**given | changes), encoding="utf-8")
    return ["check", str(folder / "case.toml")]


def with_field(folder: Path, name: str) -> list[str]:
    return check(folder, temperature=FIELD.replace("FILE", name))


# ---- VTU ---------------------------------------------------------------------------------------

FIELD_670 = '<DataArray type="Float64" Name="T" format="ascii">670 670 670 670</DataArray>'
POINTS = "0 0 0 0.02 0 0 0 0.01 0 0.02 0.01 0"


def vtu(
    connectivity: str = "0 1 2 1 3 2",
    offsets: str = "3 6",
    types: str = "5 5",
    points: str = POINTS,
    count: str = "4",
    data: str = FIELD_670,
    head: str = "",
) -> str:
    """Return a VTU file of two triangles on which everything can be wrong."""
    return f"""<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" {head}>
<UnstructuredGrid><Piece NumberOfPoints="{count}" NumberOfCells="{len(types.split())}">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray>
</Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">{connectivity}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{offsets}</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">{types}</DataArray></Cells>
<PointData>{data}</PointData></Piece></UnstructuredGrid></VTKFile>"""


def spoilt(name: str, text: str, pattern: str, *, heavy: bool = False) -> None:
    """Enter a spoilt VTU file."""

    def made(folder: Path) -> tuple[list[str], str]:
        (folder / "a.vtu").write_text(text, encoding="utf-8")
        return with_field(folder, "a.vtu"), pattern

    made.__name__ = name
    entry(heavy=heavy)(made)


ZLIB = 'compressor="vtkZLibDataCompressor" header_type="UInt64"'


def packed(blocks: int, size: int, block: bytes) -> str:
    """Return a field of equal compressed blocks, in the text of a VTU file."""
    header = np.array([blocks, size, 0, *[len(block)] * min(blocks, 1000)], dtype=np.uint64)
    content = base64.b64encode(header.tobytes()) + base64.b64encode(block * min(blocks, 1000))
    return f'<DataArray type="Float64" Name="T" format="binary">{content.decode()}</DataArray>'


spoilt(
    "vtu_point_that_does_not_exist", vtu("0 1 2 1 1000000 2"), "cell has point 1000000", heavy=True
)
spoilt("vtu_point_huge", vtu(f"0 1 2 1 {2**62} 2"), f"cell has point {2**62}", heavy=True)
spoilt("vtu_negative_point", vtu("0 1 2 1 -3 2"), "cell has point -3", heavy=True)
spoilt(
    "vtu_offsets_fall", vtu(offsets="6 3"), r"\"offsets\" array is not monotonically", heavy=True
)
spoilt("vtu_offsets_beyond", vtu(offsets="3 999999"), "a.vtu", heavy=True)
spoilt("vtu_width_of_a_cell", vtu(types="10 5"), "has 3 points instead of 4", heavy=True)
spoilt("vtu_kind_of_no_cell", vtu(types="250 250"), "a.vtu", heavy=True)
spoilt(
    "vtu_points_not_finite",
    vtu(points=POINTS.replace("0.02", "nan")),
    "no finite numbers",
    heavy=True,
)
spoilt(
    "vtu_field_of_texts",
    vtu(data='<DataArray type="String" Name="T" format="ascii">65 0 66 0 67 0 68 0</DataArray>'),
    "the field 'T' holds no numbers", heavy=True,
)  # fmt: skip
spoilt("vtu_short_field", vtu(data=FIELD_670.replace("670 670 670 670", "670")), "a.vtu")
spoilt("vtu_ten_thousand_million_points", vtu(count="10000000000"), "cannot be read", heavy=True)
spoilt("vtu_negative_count", vtu(count="-5"), "a.vtu", heavy=True)
spoilt(
    "vtu_claims_a_terabyte",
    vtu(head=ZLIB, data=packed(1, 10**12, zlib.compress(bytes(32)))), "cannot be read", heavy=True,
)  # fmt: skip
spoilt(
    "vtu_claims_as_many_blocks",
    vtu(head=ZLIB, data=packed(10**12, 32, zlib.compress(bytes(32)))), "cannot be read", heavy=True,
)  # fmt: skip
spoilt(
    "vtu_names_that_terminals_obey",
    vtu(data=FIELD_670.replace("T", "a&#x9b;31m\u202eT")),
    r"it has: a\\x9b31m\\u202eT",
)  # fmt: skip
spoilt(
    "vtu_entities",
    '<!DOCTYPE a [<!ENTITY b "' + "c" * 1000 + '">]>' + vtu(points="&b;" * 1000),
    "a.vtu",
)


@entry(heavy=True)
def vtu_bomb(folder: Path) -> tuple[list[str], str]:
    """4 MB that unpack to 3 GB."""
    block = zlib.compress(bytes(2**25), 9)
    header = np.array([96, 2**25, 0, *[len(block)] * 96], dtype=np.uint64)
    content = base64.b64encode(header.tobytes()) + base64.b64encode(block * 96)
    field = f'<DataArray type="Float64" Name="T" format="binary">{content.decode()}</DataArray>'
    count = 96 * 2**25 // 8
    (folder / "a.vtu").write_text(vtu(head=ZLIB, data=field, count=str(count), points=POINTS))
    return with_field(folder, "a.vtu"), "cannot be read"


@entry()
def vtu_that_is_a_pipe(folder: Path) -> tuple[list[str], str]:
    os.mkfifo(folder / "a.vtu")
    return with_field(folder, "a.vtu"), "there is no file"


# ---- XDMF --------------------------------------------------------------------------------------

XDMF = """<Xdmf Version="{version}"><Domain><Grid Name="a">
<Topology TopologyType="Triangle" NumberOfElements="2">
<DataItem Dimensions="2 3" Format="XML" NumberType="Int">0 1 2 1 3 2</DataItem></Topology>
<Geometry GeometryType="XYZ">
<DataItem Dimensions="4 3" Format="{format}">{numbers}</DataItem></Geometry>
<Attribute Name="T" Center="Node">
<DataItem Dimensions="4" Format="XML">6 6 6 6</DataItem></Attribute>
</Grid></Domain></Xdmf>"""


def xdmf(folder: Path, numbers: str = POINTS, kind: str = "XML", version: str = "3.0") -> list[str]:
    text = XDMF.format(version=version, format=kind, numbers=numbers)
    (folder / "a.xdmf").write_text(text)
    return with_field(folder, "a.xdmf")


@entry()
def xdmf_names_a_pipe(folder: Path) -> tuple[list[str], str]:
    os.mkfifo(folder / "numbers.bin")
    return xdmf(folder, "numbers.bin", "Binary"), "'numbers.bin', which is no regular file"


@entry()
def xdmf_names_a_pipe_as_hdf(folder: Path) -> tuple[list[str], str]:
    os.mkfifo(folder / "numbers.h5")
    return xdmf(folder, "numbers.h5:/points", "HDF"), "'numbers.h5', which is no regular file"


@entry()
def xdmf_names_a_device(folder: Path) -> tuple[list[str], str]:
    return xdmf(folder, "/dev/zero", "Binary"), "'/dev/zero', which is no regular file"


@entry()
def xdmf_names_nothing(folder: Path) -> tuple[list[str], str]:
    return xdmf(folder, "", "HDF"), "'nothing', which is no regular file"


@entry()
def xdmf_links_to_a_pipe(folder: Path) -> tuple[list[str], str]:
    import h5py

    os.mkfifo(folder / "pipe.h5")
    with h5py.File(folder / "numbers.h5", "w") as file:
        file["points"] = h5py.ExternalLink("pipe.h5", "/points")
    return xdmf(folder, "numbers.h5:/points", "HDF"), "numbers.h5 holds no /points of its own"


@entry()
def xdmf_lies_in_a_pipe(folder: Path) -> tuple[list[str], str]:
    import h5py

    os.mkfifo(folder / "pipe.raw")
    with h5py.File(folder / "numbers.h5", "w") as file:
        places = [(str(folder / "pipe.raw"), 0, 96)]
        file.create_dataset("points", (4, 3), "f8", external=places)
    return xdmf(folder, "numbers.h5:/points", "HDF"), "numbers.h5:/points lies in another file"


@entry(heavy=True)
def xdmf_that_meshio_exits_for(folder: Path) -> tuple[list[str], str]:
    return xdmf(folder, version="9.9"), "a.xdmf cannot be read: meshio says"


@entry()
def xdmf_with_a_cell_out_of_range(folder: Path) -> tuple[list[str], str]:
    arguments = xdmf(folder)
    text = (folder / "a.xdmf").read_text().replace("1 3 2", "1 77 2")
    (folder / "a.xdmf").write_text(text)
    return arguments, "a cell has point 77, and the points are 0 to 3"


@entry()
def xdmf_of_entities(folder: Path) -> tuple[list[str], str]:
    arguments = xdmf(folder)
    laughs = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10}">' for k in range(1, 12))
    text = f'<!DOCTYPE x [<!ENTITY a0 "ha">{laughs}]>' + (folder / "a.xdmf").read_text()
    (folder / "a.xdmf").write_text(text.replace(POINTS, "&a11;"))
    return arguments, "a.xdmf cannot be read"


# ---- case files --------------------------------------------------------------------------------


def numbers_with_units(name: str, text: str, pattern: str, key: str = "end") -> None:
    def made(folder: Path) -> tuple[list[str], str]:
        return check(folder, **{key: text}), pattern

    made.__name__ = f"unit_{name}"
    entry()(made)


for number, (unit, key) in enumerate(
    [
        ('"20 kdegC"', "temperature"),
        ('"20 mdegF"', "temperature"),
        ('"20 dBW^2"', "end"),
        ('"20 degC^2/K"', "temperature"),
        ('"20 dB"', "end"),
        ('"20 dBm/s"', "end"),
        ('"20 degC*degC"', "temperature"),
        ('"20 s^9/s^9"', "end"),
        ('"20 delta_degC"', "temperature"),
    ]
):
    numbers_with_units(f"{number}", unit, r"is not a unit of|unknown unit", key)
for number, unit in enumerate(["700 degRe", "20 kdegC", "20 degRe/s*s", "20 dBm"]):
    text = f'temperature_change = "{unit}"'
    numbers_with_units(f"difference_{number}", text, r"is not a unit of|unknown unit", "time")
numbers_with_units("hot", "1e30", "above 10000 °C, where every metal is vapour", "temperature")
numbers_with_units("hot_in_text", '"1e30 K"', "above 10000 °C", "temperature")


def chain(folder: Path, length: int, last: str) -> list[str]:
    parts = [f'[materials.m{k}]\nextends = "m{k + 1}"\n' for k in range(length - 1)]
    more = "".join(parts) + f'[materials.m{length - 1}]\nextends = "{last}"\n'
    return check(folder, material="m0", more=more)


@entry()
def extends_990_deep(folder: Path) -> tuple[list[str], str]:
    return chain(folder, 990, "Al-pure"), "more than 20 materials extend each other"


@entry()
def extends_100_deep(folder: Path) -> tuple[list[str], str]:
    return chain(folder, 100, "Al-pure"), "more than 20 materials extend each other"


@entry()
def extends_in_a_circle_of_900(folder: Path) -> tuple[list[str], str]:
    return chain(folder, 900, "m0"), "more than 20 materials extend each other"


@entry()
def extends_in_a_circle_of_12(folder: Path) -> tuple[list[str], str]:
    return chain(folder, 12, "m0"), "a circle: m0 → m1"


@entry()
def extends_in_many_chains(folder: Path) -> tuple[list[str], str]:
    """As much work as the limits allow: 1900 materials in chains of 19."""
    names = [[f"m{i}x{k}" for k in range(19)] for i in range(100)]
    more = "".join(
        f'[materials.{a}]\nextends = "{b}"\ndensity = 2000\n'
        for row in names
        for a, b in itertools.pairwise([*row, "Al-pure"])
    )
    return check(folder, material="m0x0", more=more + "[nonsense]\n"), "unknown key|at most"


def nested(name: str, text: str) -> None:
    def made(folder: Path) -> tuple[list[str], str]:
        return check(folder, more=text), "nested more than 20 levels deep|more than 20000 keys"

    made.__name__ = f"nested_{name}"
    entry()(made)


nested("keys", ".".join("a" * 100_000) + " = 1")
nested("tables", "[" + ".".join("1" * 100_000) + "]")
nested("inline_keys", "x = {" + ".".join("a" * 100_000) + " = 1}")
nested("inline_tables", "x = " + "{a=" * 100_000)
nested("lists", "x = " + "[" * 1_000_000)
nested("many_keys", "".join(f"a{k}.b.c.d.e.f = 1\n" for k in range(100_000)))


@entry()
def nested_in_set(folder: Path) -> tuple[list[str], str]:
    arguments = [*check(folder), "--set", ".".join("a" * 60_000) + "=1"]
    return arguments, "nested more than 20 levels deep"


@entry()
def nested_in_a_value_of_set(folder: Path) -> tuple[list[str], str]:
    return [*check(folder), "--set", "name={" + ".".join("a" * 60_000) + "=1}"], "name = "


@entry()
def case_file_that_terminals_obey(folder: Path) -> tuple[list[str], str]:
    more = '"\\u001b[2J\\u202e\\u009b31m" = 1\n"x\\u2066y" = "\\u001b]0;owned\\u0007"'
    return check(folder, more=more), r"unknown key"


@entry()
def material_that_terminals_obey(folder: Path) -> tuple[list[str], str]:
    return check(folder, material="\\u001b[2J\\u202eAl"), "material"


@entry()
def case_file_that_is_a_pipe(folder: Path) -> tuple[list[str], str]:
    os.mkfifo(folder / "case.toml")
    return ["check", str(folder / "case.toml")], "it is a pipe"


@entry()
def case_file_with_a_long_name(folder: Path) -> tuple[list[str], str]:
    return ["check", str(folder / ("a" * 300))], "File name too long"


# ---- places to write to ------------------------------------------------------------------------


@entry()
def output_of_300_characters(folder: Path) -> tuple[list[str], str]:
    _, file = check(folder)
    return [
        "run",
        file,
        "--output",
        str(folder / ("a" * 300)),
    ], "cannot be written: File name too long"


@entry()
def output_folder_of_300_characters(folder: Path) -> tuple[list[str], str]:
    _, file = check(folder, time=f'[output]\nfolder = "{"a" * 300}"')
    return ["run", file], "output"


@entry()
def mesh_file_of_300_characters(folder: Path) -> tuple[list[str], str]:
    _, file = check(folder)
    return ["mesh", file, "-o", str(folder / ("a" * 300 + ".msh"))], "cannot write"


@entry()
def picture_of_300_characters(folder: Path) -> tuple[list[str], str]:
    return ["materials", "Al-pure", "--plot", str(folder / ("a" * 300 + ".png"))], "cannot write"


@entry()
def report_of_300_characters(folder: Path) -> tuple[list[str], str]:
    return ["report", str(folder / ("a" * 300))], "is not a results folder"


@entry()
def report_of_a_folder_of_pipes(folder: Path) -> tuple[list[str], str]:
    for name in ("run.json", "history.csv", "probes.csv"):
        os.mkfifo(folder / name)
    return ["report", str(folder)], "is not a results folder"


@entry()
def report_of_tables_that_are_pipes(folder: Path) -> tuple[list[str], str]:
    (folder / "run.json").write_text(json.dumps({"castx": "0.1", "bodies": {}}))
    for name in ("history.csv", "probes.csv"):
        os.mkfifo(folder / name)
    return ["report", str(folder)], "is not a results folder"


# ---- meshes ------------------------------------------------------------------------------------

MSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
1
2 1 "{name}"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 0.02 0 0
3 0 0.01 0
4 0.02 0.01 0
$EndNodes
$Elements
2
1 2 2 1 1 1 2 3
2 2 2 1 1 2 4 {last}
$EndElements
"""


def mesh_case(folder: Path, text: str) -> list[str]:
    (folder / "a.msh").write_bytes(text.encode("utf-8", errors="surrogateescape"))
    _, file = check(folder)
    content = Path(file).read_text()
    head, tail = content.index("[geometry]"), content.index("[[bodies]]")
    geometry = '[geometry]\nfile = "a.msh"\nmodel = "plane-strain"\n'
    Path(file).write_text(content[:head] + geometry + content[tail:])
    return ["check", file]


@entry()
def mesh_with_names_that_terminals_obey(folder: Path) -> tuple[list[str], str]:
    text = MSH.format(name="\x1b[2J\u202ecasting\x9b31m", last=3)
    return mesh_case(folder, text), "no body 'casting'"


@entry(heavy=True)
def mesh_with_a_node_that_does_not_exist(folder: Path) -> tuple[list[str], str]:
    return mesh_case(folder, MSH.format(name="casting", last=77)), "a.msh"


@entry(heavy=True)
def mesh_of_ten_thousand_million_nodes(folder: Path) -> tuple[list[str], str]:
    text = MSH.format(name="casting", last=3).replace("$Nodes\n4", "$Nodes\n10000000000")
    return mesh_case(folder, text), "a.msh"


@entry()
def mesh_that_is_a_pipe(folder: Path) -> tuple[list[str], str]:
    arguments = mesh_case(folder, "")
    (folder / "a.msh").unlink()
    os.mkfifo(folder / "a.msh")
    return arguments, "there is no mesh file"
