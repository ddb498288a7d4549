"""The measured case of `tests.castx.cooled_mould` with its runner and study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from castx.studies.asked.identify import Identify
from castx.studies.runs.runner import Runner
from tests.castx.cooled_mould import case_text, formula, measured
from tests.castx.many_runs import Formulas

CURVE = {"of": "near.temperature", "file": "near.csv", "noise": "1 K"}
UNKNOWN = {"of": "interfaces.0.heat.closed", "name": "h"}


def opened(
    folder: Path,
    text: str | None = None,
    *,
    depth: bool = False,
    unknown: dict[str, Any] | None = None,
    others: list[dict[str, Any]] | None = None,
    executor: Any = None,
    **study: Any,
) -> tuple[Runner, Identify]:
    """Write case and curve into a folder and return runner and study."""
    (folder / "case.toml").write_text(case_text())
    (folder / "near.csv").write_text(measured(1400.0, 2e-3, 1.0) if text is None else text)
    curve = {**CURVE, "depth_deviation": "0.3 mm"} if depth else CURVE
    unknowns = [{**UNKNOWN, **(unknown or {})}, *(others or [])]
    asked = Identify.read({"curves": [curve], "unknowns": unknowns} | study).relative_to(folder)
    runs = folder / "study"
    runs.mkdir(exist_ok=True)
    return Runner(folder / "case.toml", (), runs, executor or Formulas(formula)), asked
