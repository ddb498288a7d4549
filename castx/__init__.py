"""Thermo-mechanics of metal casting: solidification, stresses, contact, and heat across it.

Public: `run`, `load_case`, `Case`, `Simulation`, `UserLaw`, `ResultsWriter`, `Results`, `draw`,
`heat_transfer_coefficient`, `gap_heat_laws`, `interface_names`, `contact_methods`, `flow_rules`,
`find_material`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from castx.start_folder import import_elsewhere
from castx.version import __version__

if TYPE_CHECKING:
    from castx.case.case import Case
    from castx.case.reading.read import load_case
    from castx.command.run import run
    from castx.contact.methods.registry import contact_methods
    from castx.materials.inelastic import flow_rules
    from castx.materials.lookup import find_material
    from castx.process.simulation import Simulation
    from castx.report.drawing import draw
    from castx.report.interface_law import heat_transfer_coefficient
    from castx.report.summary.opened import OpenedResults as Results
    from castx.results.writing import ResultsWriter
    from castx.transfer.database import interface_names
    from castx.transfer.registry import gap_heat_laws
    from castx.transfer.user_law import UserLaw

__all__ = [
    "Case",
    "Results",
    "ResultsWriter",
    "Simulation",
    "UserLaw",
    "__version__",
    "contact_methods",
    "draw",
    "find_material",
    "flow_rules",
    "gap_heat_laws",
    "heat_transfer_coefficient",
    "interface_names",
    "load_case",
    "run",
]

_MODULES = {
    "Case": "castx.case.case",
    "Results": "castx.report.summary.opened:OpenedResults",
    "ResultsWriter": "castx.results.writing",
    "Simulation": "castx.process.simulation",
    "UserLaw": "castx.transfer.user_law",
    "contact_methods": "castx.contact.methods.registry",
    "draw": "castx.report.drawing",
    "find_material": "castx.materials.lookup",
    "flow_rules": "castx.materials.inelastic",
    "gap_heat_laws": "castx.transfer.registry",
    "heat_transfer_coefficient": "castx.report.interface_law",
    "interface_names": "castx.transfer.database",
    "load_case": "castx.case.reading.read",
    "run": "castx.command.run",
}


import_elsewhere()


def __getattr__(name: str) -> object:
    """Import a public object at its first use: the solvers take a second, the version none."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from castx.imports import unsearched

    module, _, inside = _MODULES[name].partition(":")
    with unsearched():
        return getattr(import_module(module), inside or name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
