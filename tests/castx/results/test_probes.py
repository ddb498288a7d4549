"""Probes find their place and give exact values of linear fields on any number of ranks."""

from types import SimpleNamespace

import numpy as np
import pytest

from castx.errors import CaseError, MeshError
from castx.results.files.series import read_series
from castx.results.probes import Probes, surface_on
from tests.castx.fakes import FakeSnapshot, casting_pairs, cylinder_mesh, fake_probe

LINEAR = {
    "temperature": lambda x: 300.0 + 1000.0 * x[:, 0] - 2000.0 * x[:, 1],
    "displacement": lambda x: np.column_stack([x[:, 0] + x[:, 1], 2.0 * x[:, 1]]),
    "von_mises": lambda x: np.where(x[:, 0] < 0.02, 1.0, 2.0),
    "stress": lambda x: np.tile(np.arange(6.0), (len(x), 1)),
    "gap": lambda x: 1e-3 * x[:, 1],
    "contact_pressure": lambda x: 1e6 * x[:, 1],
}


def record(comm, folder, probes, steps=1, model="axisymmetric", cells="simplices", formulas=LINEAR):
    mesh = cylinder_mesh(comm, model, cells=cells)
    pairs = casting_pairs(mesh)
    writer = Probes(folder / "probes.csv", probes, mesh, pairs)
    writer.open()
    for step in range(steps):
        writer.append(FakeSnapshot(0.1 * step, step, mesh, pairs, formulas))
    writer.close()
    comm.Barrier()
    return read_series(folder / "probes.csv")


@pytest.mark.ranks
def test_linear_fields_are_exact_at_any_point(comm, shared_tmp_path):
    point = (0.0071, 0.0133)
    probe = fake_probe("p", point, "temperature", "displacement", body="casting")
    series = record(comm, shared_tmp_path, [probe])
    assert list(series) == ["time", "p.temperature", "p.displacement.r", "p.displacement.z"]
    assert series["p.temperature"] == pytest.approx([300.0 + 7.1 - 26.6], abs=1e-10)
    assert series["p.displacement.r"] == pytest.approx([0.0204], abs=1e-14)
    assert series["p.displacement.z"] == pytest.approx([0.0266], abs=1e-14)


def test_bilinear_fields_are_exact_on_upright_quadrilaterals(comm, shared_tmp_path):
    def product(x):
        return 1e6 * x[:, 0] * x[:, 1]

    probes = [
        fake_probe("p", (0.0071, 0.0133), "temperature", "von_mises", body="casting"),
        fake_probe("q", (0.0209, 0.0377), "temperature", "von_mises", body="mould"),
        fake_probe("g", (0.02, 0.01311), "gap", interface="casting/mould"),
    ]
    series = record(
        comm, shared_tmp_path, probes, cells="quadrilaterals",
        formulas=LINEAR | {"temperature": product},
    )  # fmt: skip
    assert series["p.temperature"] == pytest.approx([94.43], rel=1e-12)
    assert series["q.temperature"] == pytest.approx([787.93], rel=1e-12)
    assert [series["p.von_mises"][0], series["q.von_mises"][0]] == [1.0, 2.0]
    assert series["g.gap"] == pytest.approx([1e-3 * 0.01311], rel=1e-12)


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_linear_fields_are_exact_in_space(cells, comm, shared_tmp_path):
    points = [
        (0.0071, 0.0033, 0.0133),
        (0.0, 0.0, 0.04),
        (0.012, 0.0119, 0.0001),
        (0.0203, 0.01, 0.03),
    ]
    probes = [
        fake_probe(f"p{i}", point, "temperature", body="casting" if i < 3 else "mould")
        for i, point in enumerate(points)
    ]
    on_facet = np.array([0.02 * np.cos(0.4), 0.02 * np.sin(0.4), 0.0131])
    probes.append(fake_probe("g", tuple(on_facet), "gap", interface="casting/mould"))
    formulas = {
        "temperature": lambda x: 7.0 + x @ [1e3, -3e3, 5e3],
        "gap": lambda x: x @ [0.0, 0.0, 1e-3],
    }
    series = record(comm, shared_tmp_path, probes, model="3d", cells=cells, formulas=formulas)
    for i, point in enumerate(points):
        exact = 7.0 + np.array(point) @ [1e3, -3e3, 5e3]
        assert series[f"p{i}.temperature"] == pytest.approx([exact], abs=1e-9)
    assert series["g.gap"] == pytest.approx([1e-3 * 0.0131], rel=1e-9)


def test_nodes_corners_and_axis_are_found_in_both_bodies(comm, shared_tmp_path):
    points = [(0.0, 0.0), (0.0, 0.04), (0.02, 0.02), (0.03, 0.04)]
    bodies = ["casting", "casting", "mould", "mould"]
    probes = [
        fake_probe(f"p{i}", point, "temperature", "von_mises", body=body)
        for i, (point, body) in enumerate(zip(points, bodies, strict=True))
    ]
    series = record(comm, shared_tmp_path, probes)
    for i, (r, z) in enumerate(points):
        assert series[f"p{i}.temperature"] == pytest.approx([300 + 1000 * r - 2000 * z], abs=1e-9)
        assert series[f"p{i}.von_mises"] == [1.0 if bodies[i] == "casting" else 2.0]


def test_the_stress_has_the_parts_of_the_model(comm, shared_tmp_path):
    probe = fake_probe("p", (0.01, 0.01), "stress", body="casting")
    series = record(comm, shared_tmp_path, [probe])
    read = {name: values[0] for name, values in series.items() if name != "time"}
    assert read == {"p.stress.rr": 0.0, "p.stress.zz": 1.0, "p.stress.tt": 2.0, "p.stress.rz": 3.0}


def test_a_point_just_outside_moves_to_the_surface(comm, shared_tmp_path):
    probe = fake_probe("p", (0.021, 0.013), "temperature", body="casting")
    series = record(comm, shared_tmp_path, [probe])
    assert series["p.temperature"] == pytest.approx([300.0 + 20.0 - 26.0], abs=1e-9)


def test_a_point_far_outside_is_refused_with_its_distance(comm, shared_tmp_path):
    probe = fake_probe("far", (0.0275, 0.013), "temperature", body="casting")
    with pytest.raises(CaseError, match=r"'far' at \(0.0275, 0.013\) m lies outside body 'cast"):
        record(comm, shared_tmp_path, [probe])
    with pytest.raises(
        CaseError, match=r"0.0075 m away from its nearest point, \(0.02, 0.013\) m,"
    ):
        record(comm, shared_tmp_path, [probe])


def test_interface_quantities_are_interpolated_on_the_facet(comm, shared_tmp_path):
    at = (0.0201, 0.01311)
    probes = [fake_probe("g", at, "gap", "contact_pressure", interface="casting/mould")]
    series = record(comm, shared_tmp_path, probes)
    assert series["g.gap"] == pytest.approx([1e-3 * 0.01311], rel=1e-10)
    assert series["g.contact_pressure"] == pytest.approx([1e6 * 0.01311], rel=1e-10)


@pytest.mark.ranks
def test_a_point_off_the_interface_is_refused(comm, shared_tmp_path):
    probe = fake_probe("g", (0.0, 0.02), "gap", interface="casting/mould")
    with pytest.raises(CaseError, match="outside interface 'casting/mould'"):
        record(comm, shared_tmp_path, [probe])


def test_every_step_is_one_line_and_without_probes_there_is_the_time(comm, shared_tmp_path):
    series = record(comm, shared_tmp_path, [], steps=3)
    assert list(series) == ["time"]
    np.testing.assert_allclose(series["time"], [0.0, 0.1, 0.2])


def test_a_probe_is_as_deep_below_its_surface_as_the_case_says(comm, shared_tmp_path):
    """On either side of an interface, below a free surface, and on the surface itself."""
    at = (0.0205, 0.0133)
    sides = {"m": ("mould", "casting/mould"), "c": ("casting", "casting/mould")}
    probes = [
        fake_probe(f"{side}{depth}", at, "temperature", body=body, below=below, depth=depth)
        for side, (body, below) in sides.items()
        for depth in (0.0, 0.002, 0.0055)
    ]
    probes.append(
        fake_probe("t", (0.0071, 0.041), "temperature", body="casting", below="casting/top",
                   depth=0.003)
    )  # fmt: skip
    series = record(comm, shared_tmp_path, probes)

    def exact(r, z):
        return pytest.approx([300.0 + 1000.0 * r - 2000.0 * z], abs=1e-9)

    for depth in (0.0, 0.002, 0.0055):
        assert series[f"m{depth}.temperature"] == exact(0.02 + depth, 0.0133)
        assert series[f"c{depth}.temperature"] == exact(0.02 - depth, 0.0133)
    assert series["t.temperature"] == exact(0.0071, 0.037)


@pytest.mark.ranks
def test_depth_goes_along_the_normal_of_a_round_surface(comm, shared_tmp_path):
    """From a node of the interface too, where facets meet: the mean of their normals is radial."""
    mesh = cylinder_mesh(comm, "3d", cells="quadrilaterals")
    points = mesh.bodies["casting"].points
    on = points[np.abs(np.hypot(points[:, 0], points[:, 1]) - 0.02) < 1e-9]
    on = on[(on[:, :2] > 2e-3).all(axis=1) & (np.abs(on[:, 2] - 0.02) < 8e-3)]
    node = min(tuple(p) for found in comm.allgather(on) for p in found)
    between = (0.02 * np.cos(0.61), 0.02 * np.sin(0.61), 0.0131)
    probes = [
        fake_probe(f"p{i}", at, "temperature", body="mould", below="casting/mould", depth=0.004)
        for i, at in enumerate((node, between))
    ]
    formulas = {"temperature": lambda x: 1e3 * np.hypot(x[:, 0], x[:, 1])}
    series = record(
        comm, shared_tmp_path, probes, model="3d", cells="quadrilaterals", formulas=formulas
    )
    for i in range(2):
        assert series[f"p{i}.temperature"] == pytest.approx([24.0], rel=0.01)


def test_a_depth_beyond_the_wall_and_a_surface_elsewhere_are_refused(comm, shared_tmp_path):
    deep = {"body": "mould", "below": "casting/mould", "depth": 0.011}
    with pytest.raises(CaseError, match=r"0.011 m below .* 'mould' has ended 0.001 m before"):
        record(comm, shared_tmp_path, [fake_probe("p", (0.02, 0.02), "temperature", **deep)])
    with pytest.raises(CaseError, match=r"outside the surface 'casting/mould': it is 0.01 m away"):
        record(comm, shared_tmp_path, [fake_probe("p", (0.01, 0.02), "temperature", **deep)])
    lost = {"body": "mould", "below": "mould/lid", "depth": 0.001}
    with pytest.raises(MeshError, match="body 'mould' has no surface 'lid'"):
        record(comm, shared_tmp_path, [fake_probe("p", (0.03, 0.04), "temperature", **lost)])


def test_the_side_of_an_interface_of_two_surfaces_must_be_named():
    pairs = {"casting/mould": SimpleNamespace(secondary="casting", primary="mould", surface="skin")}
    assert surface_on("casting", "casting/mould", pairs) == "skin"
    assert surface_on("mould", "mould/wall", pairs) == "wall"
    with pytest.raises(CaseError, match='below = "mould/SURFACE"'):
        surface_on("mould", "casting/mould", pairs)
