"""Checks 4, 5 and 6 of the mechanics: the answer does not depend on place, side and units.

A heavy block, hot at one side, lifts off its base in part and floats sideways. It is rotated and
translated, mirrored, and computed in millimetres and megapascals. Reference: the case itself.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial

import gmsh
import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.equilibrium.newton import EquilibriumReport
from castx.equilibrium.problem import MechanicalProblem
from castx.meshes.generators.stacked_blocks import stacked_blocks
from tests.contact_methods import EXACT
from tests.elastic_bodies import (
    body,
    drawn,
    elastic,
    everywhere,
    fixed,
    heat,
    motion,
    places,
    problem,
    pushed,
    sorted_by_place,
)

pytestmark = pytest.mark.sampled

BLOCKS = {"plane-strain": ([0.02, 0.03], [0.03, 0.02])}
BLOCKS["3d"] = ([*BLOCKS["plane-strain"][0], 0.02], [*BLOCKS["plane-strain"][1], 0.03])


@dataclass(frozen=True)
class Frame:
    """Where the case lies and the units of its numbers.

    Attributes:
        rotation: orthogonal matrix, shape (3, 3).
        shift: translation after it [m].
        length: the metre in the unit of length.
        stress: the pascal in the unit of stress.
    """

    rotation: np.ndarray = field(default_factory=lambda: np.eye(3))
    shift: np.ndarray = field(default_factory=lambda: np.zeros(3))
    length: float = 1.0
    stress: float = 1.0

    def back(self, points: np.ndarray) -> np.ndarray:
        """Return where points lie in the case itself [m]."""
        d = points.shape[1]
        return np.asarray((points / self.length - self.shift[:d]) @ self.rotation[:d, :d])


def about_z(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


IN_SPACE = about_z(0.6) @ about_z(0.9)[np.ix_((1, 2, 0), (1, 2, 0))]
MOVED = {
    "plane-strain": Frame(about_z(0.6), np.array([0.5, -0.3, 0.0])),
    "3d": Frame(IN_SPACE, np.array([0.5, -0.3, 0.2])),
}


def draw(model: str, frame: Frame) -> None:
    upper, base = BLOCKS[model]
    stacked_blocks(model=model, upper=upper, base=base, size=0.005, symmetry=False)
    matrix = np.column_stack([frame.rotation, frame.shift]) * frame.length
    gmsh.model.mesh.affineTransform(matrix.ravel())


@dataclass(frozen=True)
class Solved:
    """A solved case with its frame."""

    made: MechanicalProblem
    report: EquilibriumReport
    frame: Frame

    def forces(self, comm) -> tuple[np.ndarray, np.ndarray]:
        """Return points and contact forces [N], sorted."""
        d = self.made.pairs[0].points.shape[1]
        points = everywhere(comm, self.frame.back(self.made.pairs[0].points))
        unit = self.frame.stress * self.frame.length ** (d - 1)
        forces = everywhere(comm, self.made.pair_values()[1])
        return sorted_by_place(points, np.asarray(forces / unit))

    def motion(self, comm, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Return points and displacements [m] and pressures [Pa], sorted."""
        values = motion(self.made, name)
        d = self.made.bodies[name].dimension
        values[:, :d] = values[:, :d] @ self.frame.rotation[:d, :d] / self.frame.length
        values[:, d:] /= self.frame.stress
        points = self.frame.back(places(self.made, name))
        return sorted_by_place(everywhere(comm, points), everywhere(comm, values))


def one_sided(x: np.ndarray) -> np.ndarray:
    """Return the temperature at places of the case itself."""
    return 20.0 + 5e3 * (x[:, 0] + 0.01) + 1e3 * x[:, -1]


def solved(
    comm, folder, model, method, frame=None, temperature=one_sided, settings=None, **law
) -> Solved:
    frame = frame or Frame()
    mesh = drawn(comm, model, ["upper", "base"], folder / "blocks.msh", partial(draw, model, frame))
    d = 3 if model == "3d" else 2
    Pa = frame.stress
    weight = -1e7 * frame.rotation[:d, d - 1] * Pa / frame.length
    heavy = {"body_force": tuple(weight), "loads": (pushed("top", 1e5 * Pa),), **law}
    made = problem(
        mesh,
        {
            "upper": body(elastic(7e9 * Pa, 0.33, 2e-5), **heavy),
            "base": body(elastic(70e9 * Pa, 0.3, 1e-5), **law),
        },
        {"base": [fixed("bottom", "all")]},
        [Contact("upper", "base", method)],
        **(settings or {"tolerance": 1e-12}),
    )
    heat(made, lambda points: temperature(frame.back(points)))
    return Solved(made, made.equilibrium.solve(0.0), frame)


def assert_same(comm, found: Solved, expected: Solved, tolerance: float) -> None:
    points, forces = expected.forces(comm)
    assert 0 < np.count_nonzero(forces) < len(forces)
    assert found.made.equilibrium.present.balance.operator.support is not None
    np.testing.assert_allclose(found.forces(comm)[0], points, atol=1e-9)
    np.testing.assert_allclose(found.forces(comm)[1], forces, atol=tolerance * forces.max())
    for name in expected.made.bodies:
        for values, reference in zip(
            found.motion(comm, name)[1].T, expected.motion(comm, name)[1].T, strict=True
        ):
            size = np.abs(reference).max()
            np.testing.assert_allclose(values, reference, atol=tolerance * size)


@pytest.mark.parametrize("formulation", ["mixed", "displacement"])
@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("model", BLOCKS)
def test_rotated_and_translated(comm, shared_tmp_path, model, method, formulation):
    still, moved = (
        solved(comm, shared_tmp_path, model, method, frame, formulation=formulation)
        for frame in (Frame(), MOVED[model])
    )
    assert_same(comm, moved, still, 1e-8)


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("model", BLOCKS)
def test_symmetric_input_gives_symmetric_output(comm, shared_tmp_path, model, method):
    made = solved(
        comm, shared_tmp_path, model, method,
        temperature=lambda x: 20.0 + 2e5 * x[:, 0] ** 2 - 8e3 * x[:, -1],
    )  # fmt: skip
    for points, values in (made.forces(comm), *(made.motion(comm, n) for n in made.made.bodies)):
        values = values.reshape(len(points), -1)
        image = points * np.eye(1, points.shape[1]).ravel() * -2 + points
        mirrored = values.copy()
        if values.shape[1] > 1:
            mirrored[:, 0] *= -1
        found = sorted_by_place(image, mirrored)
        np.testing.assert_allclose(found[0], points, atol=1e-9)
        for column, reference in zip(found[1].T, values.T, strict=True):
            np.testing.assert_allclose(column, reference, atol=1e-8 * np.abs(reference).max())


@pytest.mark.parametrize("linear", ["direct", "iterative"])
@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("model", BLOCKS)
def test_other_units_take_the_same_iterations(comm, shared_tmp_path, model, method, linear):
    settings = {"linear": linear, "tolerance": 1e-6}
    si = solved(comm, shared_tmp_path, model, method, settings=settings)
    for frame in (Frame(length=1e3, stress=1e-6), Frame(length=1e-2, stress=1e3)):
        scaled = solved(comm, shared_tmp_path, model, method, frame, settings=settings)
        assert scaled.report.iterations == si.report.iterations
        assert scaled.report.contact_changes == si.report.contact_changes
        assert abs(scaled.report.linear_iterations - si.report.linear_iterations) <= 1
        assert_same(comm, scaled, si, 1e-6)
