"""What is said of a body: each parameter changes the answer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from castx.errors import CaseError
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody
from tests.castx.mechanics.lone_bodies import slab_mesh
from tests.elastic_bodies import body, elastic, everywhere, fixed, heat, motion, problem, pushed

VARIATIONS: dict[str, Callable[[], Any]] = {
    "formulation": lambda: body(elastic(70e9, 0.33, 2e-5), formulation="displacement"),
    "stabilisation": lambda: body(elastic(70e9, 0.33, 2e-5), stabilisation="gls"),
    "body_force": lambda: body(elastic(70e9, 0.33, 2e-5), body_force=(1e6, 0.0)),
    "loads": lambda: body(elastic(70e9, 0.33, 2e-5), loads=(pushed("far", 1e6),)),
    "stress_free": lambda: body(elastic(70e9, 0.33, 2e-5), stress_free=40.0),
    "young_modulus": lambda: body(elastic([[0.0, 70e9], [100.0, 40e9]], 0.33, 2e-5)),
    "poisson_ratio": lambda: body(elastic(70e9, 0.3, 2e-5)),
    "expansion": lambda: body(elastic(70e9, 0.33, 1e-5)),
}


@pytest.mark.parametrize("name", VARIATIONS)
def test_every_parameter_changes_the_answer(comm, name):
    answers = []
    for solid in (body(elastic(70e9, 0.33, 2e-5)), VARIATIONS[name]()):
        made = problem(slab_mesh(comm), {"casting": solid}, {"casting": [fixed("wall", "all")]})
        heat(made, lambda x: 20 + 4e3 * x[:, 0])
        made.equilibrium.solve(0.0)
        answers.append(everywhere(comm, motion(made, "casting")[:, :2]))
    change = np.abs(answers[1] - answers[0]).max()
    assert change > 1e-4 * np.abs(answers[0]).max()


@pytest.mark.parametrize("formulation", ["mixed", "q1p0", "taylor-hood"])
def test_grains_have_the_formulation_in_displacement_alone(formulation):
    sand = elastic(5e8, 0.25, granular={"cohesion": 1e6, "friction_angle": 30.0})
    law = Law(sand, 20.0, "drucker-prager")
    with pytest.raises(CaseError, match=f"no formulation '{formulation}'.*use \"displacement\""):
        MechanicalBody(law, formulation)
    assert MechanicalBody(law, "displacement").law.is_granular
