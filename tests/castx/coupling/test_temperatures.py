"""The heat problem and prescribed temperatures can both stand where the coupling asks for one."""

from __future__ import annotations

import inspect

import pytest

from castx.coupling.prescribed import PrescribedTemperatures
from castx.coupling.temperatures import Temperatures
from castx.heat.problem import HeatProblem

pytestmark = pytest.mark.serial

METHODS = [name for name, value in vars(Temperatures).items() if inspect.isfunction(value)]


@pytest.mark.parametrize("provider", [HeatProblem, PrescribedTemperatures])
@pytest.mark.parametrize("method", [name for name in METHODS if not name.startswith("_")])
def test_methods_take_the_same_arguments(provider, method):
    wanted = inspect.signature(getattr(Temperatures, method))
    found = inspect.signature(getattr(provider, method))
    assert found.parameters == wanted.parameters
    assert found.return_annotation == wanted.return_annotation
