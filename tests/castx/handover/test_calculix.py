"""Input of CalculiX: what its files hold, and that CalculiX leaves the state as it is."""

import os
import shutil
import subprocess

import numpy as np
import pytest

from castx.errors import CaseError
from castx.handover.calculix import write_calculix
from tests.castx.handover.made_results import box, made

pytestmark = pytest.mark.serial

CCX = os.environ.get("CASTX_CCX") or shutil.which("ccx")
KINDS = {
    "C3D4": ("3d", 4, 1), "C3D8": ("3d", 8, 8), "CAX3": ("axisymmetric", 3, 1),
    "CAX4": ("axisymmetric", -4, 4), "CPE3": ("plane-strain", 3, 1),
    "CPE4": ("plane-strain", -4, 4), "CPS3": ("plane-stress", 3, 1),
}  # fmt: skip


def state_of(folder, kind, law="thermo-elastic", size=20e6, **nodal):
    """Return a body of two random stresses, which forces keep in equilibrium."""
    model, corners, count = KINDS[kind]
    points, cells = box(corners)
    points[:, 0] += 0.02 * (model == "axisymmetric")
    random = np.random.default_rng(5)
    stress = size * random.normal(size=(len(cells), count, 6))
    if model != "3d":
        stress[..., 4:] = 0.0
    if model == "plane-stress":
        stress[..., 2] = 0.0
    name = "point_stress" if abs(corners) in (8, -4) or corners < 0 else "stress"
    cellwise = {name: stress.reshape(len(cells), -1)}
    if law != "thermo-elastic":
        cellwise["plastic_strain"] = random.uniform(0.0, 0.01, len(cells))
    fields = {"temperature": 20.0 + 3e3 * points[:, 0], **nodal}
    return made(folder / "out", model, points, cells, fields, cellwise, law=law), stress


def rows_of(path, heading):
    """Return the numbers below a heading of an input file."""
    found, on = [], False
    for line in path.read_text().splitlines():
        if line.startswith("*"):
            on = line.startswith(heading)
        elif on:
            found.append([float(value) for value in line.rstrip(",").split(",")])
    return np.array(found)


@pytest.mark.parametrize("kind", KINDS)
def test_stresses_stand_at_the_points_of_the_element(tmp_path, kind):
    state, stress = state_of(tmp_path, kind)
    handed = write_calculix(state, tmp_path / "ccx")
    assert handed.files[0].name == "casting.inp"
    rows = rows_of(tmp_path / "ccx/casting-state.inp", "*INITIAL CONDITIONS, TYPE=STRESS")
    layers = 1 if kind.startswith("C3D") else 2
    assert len(rows) == len(stress) * stress.shape[1] * layers
    of_first = rows[rows[:, 0] == 1.0]
    assert of_first[:, 1].tolist() == list(range(1, len(of_first) + 1))
    np.testing.assert_allclose(of_first[: stress.shape[1], 2:], stress[0], rtol=1e-12)
    mesh = (tmp_path / "ccx/casting-mesh.inp").read_text()
    assert f"*ELEMENT, TYPE={kind}, ELSET=ALL" in mesh
    temperature = rows_of(tmp_path / "ccx/casting-state.inp", "*INITIAL CONDITIONS, TYPE=TEMP")
    np.testing.assert_allclose(temperature[:, 1], 20.0 + 3e3 * state.points[:, 0])


@pytest.mark.skipif(CCX is None, reason="no CalculiX: install calculix-ccx or set CASTX_CCX")
@pytest.mark.parametrize("kind", KINDS)
def test_calculix_stays_in_equilibrium(tmp_path, kind):
    state, stress = state_of(tmp_path, kind)
    folder = tmp_path / "ccx"
    write_calculix(state, folder)
    ended = subprocess.run([CCX, "casting"], cwd=folder, capture_output=True, text=True, timeout=60)
    assert ended.returncode == 0, ended.stdout[-2000:]
    moved, found = printed(folder / "casting.dat")
    given = rows_of(folder / "casting-state.inp", "*INITIAL CONDITIONS, TYPE=STRESS")
    largest = np.abs(stress).max()
    np.testing.assert_allclose(found[:, 2:8], given[:, 2:], rtol=0.0, atol=1e-5 * largest)
    assert np.abs(moved[:, 1:4]).max() < 1e-5 * 0.03 * largest / 70e9


def printed(path):
    """Return displacements and stresses that CalculiX has printed."""
    found, kind = {"displacements": [], "stresses": []}, None
    for line in path.read_text().splitlines():
        heading = next((name for name in found if line.strip().startswith(name)), None)
        if heading is not None:
            kind = heading
        elif line.strip():
            found[kind].append([float(value) for value in line.split()])
    return (np.array(rows) for rows in found.values())


def test_forces_are_left_out_on_release(tmp_path):
    state, _ = state_of(tmp_path, "C3D4")
    kept = write_calculix(state, tmp_path / "kept")
    free = write_calculix(state, tmp_path / "free", release=True)
    assert len(rows_of(tmp_path / "kept/casting-forces.inp", "*CLOAD")) > 0
    assert (tmp_path / "free/casting-forces.inp").read_text() == ""
    assert kept.forces == free.forces > 0.1


def test_elements_are_divided_into_classes_of_yield_strength(tmp_path):
    points, _ = box(4)
    strength = 100e6 + 1e9 * points[:, 0]
    state, _ = state_of(tmp_path, "C3D4", "thermo-elasto-plastic", yield_strength=strength)
    handed = write_calculix(state, tmp_path / "ccx")
    table = np.genfromtxt(tmp_path / "ccx/casting-elements.csv", delimiter=",", names=True)
    assert handed.classes.quantity == "yield_strength"
    of_cells = strength[state.cells].mean(axis=1)
    np.testing.assert_allclose(table["yield_strength"], of_cells, rtol=1e-12)
    np.testing.assert_allclose(table["plastic_strain"], state.values("plastic_strain"))
    inputs = [path.read_text() for path in (tmp_path / "ccx").glob("*.inp")]
    assert len(inputs) == 5 and not any("PLASTIC STRAIN" in text.upper() for text in inputs)
    assert handed.classes.width == pytest.approx(np.ptp(of_cells) / 20)
    text = (tmp_path / "ccx/casting-materials.inp").read_text()
    used = np.unique(table["class"]).astype(int)
    assert text.count("*MATERIAL") == text.count("*SOLID SECTION") == len(used) <= 20
    listed = rows_of_set(text, f"YIELD_STRENGTH_{used[0]}")
    assert listed == (np.flatnonzero(table["class"] == used[0]) + 1).tolist()
    middle = handed.classes.middles[used[0] - 1]
    assert f"*PLASTIC\n{middle:.10g}, 0, 20" in text


def rows_of_set(text, name):
    lines = text.split(f"*ELSET, ELSET={name}\n")[1].split("*")[0].replace("\n", "")
    return [int(number) for number in lines.rstrip(",").split(",")]


@pytest.mark.parametrize(("size", "share"), [(1e5, 0.0), (500e6, 1.0)])
def test_stress_beyond_the_yield_stress_is_noticed(tmp_path, size, share):
    state, stress = state_of(tmp_path, "C3D4", "thermo-elasto-plastic", size)
    handed = write_calculix(state, tmp_path / "ccx")
    assert handed.over == pytest.approx(share, abs=0.05)
    limit = np.interp(20.0 + 3e3 * state.points[state.cells, 0].mean(axis=1), [20, 400],
                      [100e6, 40e6])  # fmt: skip
    s = stress[:, 0]
    pairs = (s[:, [0, 1, 2]] - s[:, [1, 2, 0]]) ** 2
    mises = np.sqrt(0.5 * pairs.sum(axis=1) + 3.0 * (s[:, 3:] ** 2).sum(axis=1))
    assert handed.excess == pytest.approx((mises / limit).max(), rel=1e-6)
    assert write_calculix(state, tmp_path / "elastic", elastic=True).over is None
    assert "*PLASTIC" not in (tmp_path / "elastic/casting-materials.inp").read_text()


def test_bricks_need_the_stress_of_their_points(tmp_path):
    points, cells = box(8)
    stress = {"stress": np.zeros((len(cells), 6))}
    state = made(tmp_path / "out", "3d", points, cells, None, stress)
    with pytest.raises(CaseError, match=r'(?s)point_stress of .*"point_stress"\]'):
        write_calculix(state, tmp_path / "ccx")


def test_oblique_planes_are_equations(tmp_path):
    model, corners, _ = KINDS["C3D4"]
    points, cells = box(corners, sizes=(0.02, 0.02, 0.01))
    normal = [2.0**-0.5, -(2.0**-0.5), 0.0]
    symmetry = [{"normal": [0.0, 1.0, 0.0], "offset": 0.0}, {"normal": normal, "offset": 0.0}]
    state = made(tmp_path / "out", model, points, cells, None,
                 {"stress": np.zeros((len(cells), 6))}, symmetry=symmetry)  # fmt: skip
    write_calculix(state, tmp_path / "ccx")
    deck = (tmp_path / "ccx/casting.inp").read_text()
    diagonal = np.abs(points[:, 0] - points[:, 1]) < 1e-9
    assert deck.count("*EQUATION") == diagonal.sum()
    held = rows_of(tmp_path / "ccx/casting.inp", "*BOUNDARY")
    # On y = 0 along y, and one node along z.
    assert (held[:, 1] == 2).sum() == (np.abs(points[:, 1]) < 1e-9).sum()
    assert (held[:, 1] == 3).sum() == 1 and len(held) == (held[:, 1] == 2).sum() + 1
