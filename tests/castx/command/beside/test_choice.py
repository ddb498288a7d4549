"""Options of `castx run` choose what solves a case, and which tables follow."""

from __future__ import annotations

import pytest
import typer

from castx.command.beside.adapted import adapted_table, run_adapted
from castx.command.beside.choice import chosen
from castx.command.beside.estimate import estimate_table, run_estimate
from castx.command.beside.sensitivity import run_sensitivity, sensitivity_table
from castx.command.listing import profile_table
from castx.command.run import run_case
from castx.command.terminal import VariedNumber

pytestmark = pytest.mark.serial


def test_each_option_has_its_run_and_its_table():
    assert chosen(None, 0, estimate=False, profile=False) == (run_case, [])
    assert chosen(None, 0, estimate=True, profile=True) == (
        run_estimate, [profile_table, estimate_table],
    )  # fmt: skip
    by = VariedNumber.COHERENCY
    assert chosen(by, 0, estimate=False, profile=False) == (run_sensitivity, [sensitivity_table])
    solve, tables = chosen(None, 3, estimate=False, profile=False)
    assert (solve.func, solve.keywords, tables) == (run_adapted, {"rounds": 3}, [adapted_table])


def test_two_of_them_are_refused():
    with pytest.raises(typer.BadParameter, match="take one"):
        chosen(VariedNumber.COHERENCY, 1, estimate=False, profile=False)
