"""Bodies whose surfaces move equally, or are held, at nodes that are tied to another body."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.errors import CaseError
from castx.mechanics.fixed_directions import SurfaceDisplacement
from tests.castx.contact.test_tied import SOFT, STIFF, facing
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    heat,
    motion,
    places,
    problem,
)

TIED = Contact("upper", "base", "tied")


def uniform(surface, direction="normal"):
    """Return a surface whose nodes move equally."""
    return SurfaceDisplacement(surface, direction, None)


def strips(comm, conditions, model="plane-strain", uneven=0.0, symmetry=True):
    """Return two heated strips, one tied on the other."""
    bodies = {"upper": body(elastic(*SOFT)), "base": body(elastic(*STIFF))}
    mesh = blocks(comm, model, upper=(0.04, 0.01), base=(0.04, 0.02), size=0.01, symmetry=symmetry)
    made = problem(mesh, bodies, conditions, [TIED])
    heat(made, lambda x: 120.0 + uneven * x[:, 0])
    made.equilibrium.solve(0.0)
    return made


@pytest.mark.ranks
def test_ends_of_tied_strips_that_stay_plane(comm):
    """Plane strain, free upwards: Σ h E/(1 - ν²) (e - (1 + ν) α ΔT) = 0 gives their one strain."""
    made = strips(comm, {"upper": [uniform("side")], "base": [uniform("side"), fixed("bottom")]})
    stiffness = [h * e / (1.0 - nu**2) for h, (e, nu, _) in zip((1, 2), (SOFT, STIFF), strict=True)]
    free = [(1.0 + nu) * alpha * 100.0 for _, nu, alpha in (SOFT, STIFF)]
    strain = np.dot(stiffness, free) / np.sum(stiffness)
    for name in ("upper", "base"):
        own, points = motion(made, name), places(made, name)
        np.testing.assert_allclose(own[:, 0], strain * points[:, 0], atol=1e-12)


@pytest.mark.ranks
def test_a_plane_end_follows_the_corner_that_it_is_tied_to(comm):
    made = strips(comm, {"upper": [uniform("side")], "base": [fixed("bottom")]}, uneven=1e3)
    upper, base = facing(comm, made)
    upper, base = everywhere(comm, upper), everywhere(comm, base)
    np.testing.assert_allclose(upper, base, atol=1e-12 * np.abs(upper).max())
    at_end = np.isclose(everywhere(comm, places(made, "upper"))[:, 0], 0.02)
    end = everywhere(comm, motion(made, "upper"))[at_end, 0]
    assert end == pytest.approx(base[:, 0].max(), rel=1e-12) and len(end) > 1


@pytest.mark.ranks
def test_edges_in_space_need_both_ends_plane(comm):
    ends = {"upper": [uniform("side", "x")], "base": [fixed("bottom", "z")]}
    with pytest.raises(CaseError, match=r"tied to 'base' at 1\d nodes.* give it the same cond"):
        strips(comm, ends, "3d", symmetry=False)
    ends["base"].append(uniform("side", "x"))
    upper, base = facing(comm, strips(comm, ends, "3d", uneven=1e3, symmetry=False))
    upper, base = everywhere(comm, upper), everywhere(comm, base)
    np.testing.assert_allclose(upper, base, atol=1e-12 * np.abs(upper).max())


@pytest.mark.ranks
@pytest.mark.parametrize("other", [[], [uniform("side")]])
def test_refuses_to_hold_one_of_two_tied_nodes(comm, other):
    """The pair would slide, since the condition has taken the direction."""
    held = {"upper": [fixed("side")], "base": [fixed("bottom"), *other]}
    with pytest.raises(CaseError, match="tied to 'base', which can move there: name the bodies"):
        strips(comm, held)
    strips(comm, {"upper": [], "base": [fixed("bottom"), fixed("side")]})
