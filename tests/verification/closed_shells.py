"""Liquid closed in by a shell: hollow sphere and cylinder round a core, and their exact answers.

Radii a < b; the outside has a pressure P or is held; the core has a pressure p_l = −p, or keeps its
volume but for a relative change e of its own: (d/a) u(a) = e, with d = 3 in the sphere and 2 in the
cylinder in plane strain. Positive pressures push.

Elastic shell (Lamé): u = C r + D r^{1−d} and σ_r = A C − 2 (d − 1) G D r^{−d}, with A = 3 K in the
sphere and 2 (K + G/3) in the cylinder.

Perfectly plastic shell (R. Hill, The Mathematical Theory of Plasticity (1950), chapter V): once all
of it flows outwards, p_l − P = 2 σ_Y ln(b/a) in the sphere and (2/√3) σ_Y ln(b/a) in the cylinder.
Its volume grows by ∫ tr σ/(3K), and ∫ tr σ = ∮ t·x, so that b² u(b) = a² u(a) + p a³/(3K) in the
sphere; in the cylinder σ_z = (σ_r + σ_θ)/2 and b u(b) = a u(a) + p a²/(2K), without P.

With Bingham's viscosity η the rate of flow ε̇ adds its stress, q = σ_Y + 3 η ε̇. For u̇ = u̇(a)
(a/r)^{d−1} in the sphere ε̇ = 2 u̇(a) a²/r³, and ∫ 2 q/r dr adds 4 η u̇(a)/a (1 − a³/b³); in the
cylinder ε̇ = (2/√3) u̇(a) a/r², and ∫ (2/√3) q/r dr adds 2 η u̇(a)/a (1 − a²/b²).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.equilibrium.building import MechanicsSettings
from castx.equilibrium.problem import MechanicalProblem
from castx.materials.thermal_strain import StressFreeState
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody, SurfaceLoad
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.meshes.grading import Sizing
from castx.meshes.linear_mesh import LinearMesh
from castx.meshes.model import fill_model, plane, round_surface
from castx.meshes.round_section import disc
from castx.tables import Table
from tests.elastic_bodies import drawn, elastic, fixed, heat

INNER, OUTER = 0.02, 0.04
YOUNG, POISSON = 70e9, 0.33
SHEAR, BULK = YOUNG / (2 * (1 + POISSON)), YOUNG / (3 * (1 - 2 * POISSON))
MODELS = {3: "axisymmetric", 2: "plane-strain"}
KINDS: dict[str, dict[str, Any]] = {
    "osgs": {"stabilisation": "osgs"},
    "gls": {"stabilisation": "gls"},
    "q1p0": {"formulation": "q1p0"},
}
COHERENCY, SHRINKAGE = 0.9, 0.06


@dataclass(frozen=True)
class Shell:
    """Exact answers of an elastic shell.

    Attributes:
        dimension: d, 3 for the sphere, 2 for the cylinder.
    """

    dimension: int

    @property
    def _factors(self) -> tuple[float, float]:
        d = self.dimension
        return (3 * BULK if d == 3 else 2 * (BULK + SHEAR / 3)), 2 * (d - 1) * SHEAR

    def displacement(self, c: float, d: float, radius: float) -> float:
        return c * radius + d * radius ** (1 - self.dimension)

    def core_pressure(self, c: float, d: float) -> float:
        A, B = self._factors
        return -(A * c - B * d * INNER**-self.dimension)

    def full(self, outside: float, change: float) -> tuple[float, float]:
        """Return C and D for a pressure outside and a core whose volume changes by V·change."""
        A, B = self._factors
        n = self.dimension
        matrix = [[n, n * INNER**-n], [A, -B * OUTER**-n]]
        return tuple(np.linalg.solve(matrix, [change, -outside]))  # type: ignore[return-value]

    def porous(self, outside: float, inside: float) -> tuple[float, float]:
        """Return C and D for pressures outside and in the core."""
        A, B = self._factors
        n = self.dimension
        matrix = [[A, -B * INNER**-n], [A, -B * OUTER**-n]]
        return tuple(np.linalg.solve(matrix, [-inside, -outside]))  # type: ignore[return-value]

    def held(self, moved: float, change: float) -> tuple[float, float]:
        """Return C and D for an outside that is moved, and a full core."""
        n = self.dimension
        matrix = [[n, n * INNER**-n], [OUTER, OUTER ** (1 - n)]]
        return tuple(np.linalg.solve(matrix, [change, moved]))  # type: ignore[return-value]

    def flown(self, change: float, core_pressure: float) -> float:
        """Return u(b) of a plastic shell round a full core that has grown by V·change [m]."""
        n = self.dimension
        inner = change * INNER**n / n + core_pressure * INNER**n / ({3: 3, 2: 2}[n] * BULK)
        return inner / OUTER ** (n - 1)

    def flow_pressure(self, strength: float, viscosity: float, rate: float) -> float:
        """Return p_l of a shell that flows round a full core that grows by V·rate per second."""
        n, ratio = self.dimension, INNER / OUTER
        plastic = {3: 2.0, 2: 2.0 / np.sqrt(3.0)}[n] * strength * np.log(OUTER / INNER)
        viscous = {3: 4.0, 2: 2.0}[n] * viscosity * rate / n * (1 - ratio**n)
        return float(plastic + viscous)

    def core_volume(self) -> float:
        """Return that of the part which is meshed: half a sphere, a quarter of a cylinder [m]."""
        return (2 / 3 * np.pi * INNER**3) if self.dimension == 3 else np.pi / 4 * INNER**2


def draw(cells: str, size: float) -> None:
    """Draw the quarter of a disc with a circle of nodes at the inner radius."""
    mesh = disc((0.0, INNER, OUTER), Sizing(size), "quarter", cells)
    one = np.zeros(len(mesh.cells), dtype=np.int64)
    surfaces = [
        plane("symmetry-x", 0, 0.0, 1e-9), plane("symmetry-y", 1, 0.0, 1e-9),
        round_surface("outside", OUTER, 1e-9),
    ]  # fmt: skip
    fill_model(LinearMesh(mesh.points, mesh.cells, one, mesh.order), ["casting"], surfaces)


def closed_shell(
    comm: Any,
    folder: Path,
    dimension: int,
    kind: str,
    n: int,
    *,
    shell: str = "thermo-elastic",
    liquid: float = INNER,
    pressure: Table | None = None,
    moved: Table | None = None,
    body: dict[str, Any] | None = None,
    **properties: Any,
) -> MechanicalProblem:
    """Return a casting, liquid in the core once `freeze` is called, n cells across the shell.

    Args:
        comm: the ranks.
        folder: for the mesh.
        dimension: 3 for the sphere, 2 for the cylinder.
        kind: one of `KINDS`.
        n: cells across the shell.
        shell: its law.
        liquid: radius of what is liquid at the start [m].
        pressure: on the outside over time [Pa].
        moved: normal displacement of the outside over time [m].
        body: more of the description of the body.
        properties: of the metal.
    """
    cells = "quadrilaterals" if kind == "q1p0" else "simplices"
    drawing = partial(draw, cells, (OUTER - INNER) / n)
    mesh = drawn(comm, MODELS[dimension], ["casting"], folder / "closed.msh", drawing)
    metal = elastic(
        YOUNG, POISSON, 0.0,
        **{"solidus": 600.0, "liquidus": 650.0, "latent_heat": 4e5,
           "liquid": {"viscosity": 1e4, "coherency": COHERENCY},
           "solidification_shrinkage": SHRINKAGE, **properties},
    )  # fmt: skip
    loads = () if pressure is None else (SurfaceLoad("outside", pressure=pressure),)
    at_start = solid_fraction(mesh.bodies["casting"].points, 0.0, liquid)
    unstressed = StressFreeState(600.0, solid_fraction=at_start)
    casting = MechanicalBody(
        Law(metal, unstressed, shell), starts_liquid=True, loads=loads, **KINDS[kind],
        **(body or {}),
    )  # fmt: skip
    planes = [fixed(name) for name in ("symmetry-y", "symmetry-x")[: 4 - dimension]]
    if moved is not None:
        planes.append(SurfaceDisplacement("outside", "normal", moved))
    settings = MechanicsSettings(tolerance=1e-9, linear="direct")
    made = MechanicalProblem(mesh, {"casting": casting}, {"casting": planes}, (), settings)
    freeze(made, 0.0, size=liquid)  # the first state of all
    return made


def freeze(made: MechanicalProblem, core: float, step: float = 1.0, size: float = INNER) -> None:
    """Begin a step with a solid shell and a solid fraction in the core of this radius [m]."""
    heat(made, 600.0, partial(solid_fraction, core=core, size=size), step)


def solid_fraction(x: FloatArray, core: float, size: float) -> FloatArray:
    """Return f_s at places: nodes between shell and core bear by half, as a front leaves them."""
    radius = np.hypot(x[:, 0], x[:, 1])
    between = np.abs(radius - size) <= 1e-6 * size
    return np.where(between, 0.5 * (1.0 + COHERENCY), np.where(radius > size, 1.0, core))


def settle(made: MechanicalProblem, time: float) -> dict[str, float]:
    """Find the equilibrium of a step and accept it; return the totals of the liquid."""
    made.equilibrium.solve(time)
    made.equilibrium.commit()
    totals = made.bodies["casting"].liquid_totals()
    assert totals is not None
    return totals


def outer_motion(comm: Any, made: MechanicalProblem) -> float:
    """Return the mean outward motion of the outside [m]; collective."""
    part = made.bodies["casting"]
    points = part.mesh.nodes.tabulate_dof_coordinates()[: part.owned_nodes, :2]
    moved = part.solution.x.array.reshape(-1, part.block_size)[: part.owned_nodes, :2]
    radius = np.hypot(points[:, 0], points[:, 1])
    skin = np.abs(radius - OUTER) < 1e-6 * OUTER
    outward = np.einsum("ni,ni->n", points, moved)[skin] / OUTER
    total, count = comm.allreduce(np.array([outward.sum(), skin.sum()]))
    return float(total / count)
