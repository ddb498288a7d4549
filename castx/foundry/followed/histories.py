"""The quantities that are followed through a run, as one: fields, totals, records, saved states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.case.fields.feeding import EMPTIED
from castx.case.fields.heat import FLUX_ERROR
from castx.discretisation.flux_errors import flux_errors_of
from castx.foundry.followed.last_liquid import last_liquid_of
from castx.foundry.pools.feeders import feeders_of
from castx.foundry.pools.feeding_path import FEEDING_PATH, Pores, feeding_reach_of
from castx.foundry.stress.die_surfaces import LIFE, STRAIN_RANGE, die_surfaces_of
from castx.foundry.stress.ejection_force import ejection_forces_of
from castx.foundry.stress.first_opening import FIRST_OPENING, first_openings_of
from castx.foundry.stress.heat_flux import HEAT_FLUX, heat_fluxes_of
from castx.foundry.stress.mush_suction import SUCTION_MARGIN, suction_margins_of
from castx.stateful import Arrays, Saved, Stateful, part_of, saved_parts

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh
    from castx.domain.pairs.node_pairs import NodePairs

OF_MELTING = (EMPTIED, FEEDING_PATH, SUCTION_MARGIN)
"""Fields at the nodes of bodies that melt."""
NODAL = (*OF_MELTING, FIRST_OPENING)
"""All fields at nodes that are found from what is followed."""
CELLWISE = (HEAT_FLUX, FLUX_ERROR, STRAIN_RANGE, LIFE)
"""Those in cells."""


class FollowedQuantity(Stateful, Protocol):
    """A quantity that is followed through a run; each method is collective."""

    def update(self, state: Any, /) -> None:
        """Take over the state after an accepted step."""

    def field(self, body: str, name: str, /) -> FloatArray | None:
        """Return a field of a body, ghosts included; None: it is not from here."""

    def totals(self) -> dict[str, float]:
        """Return totals by the name of their column in history.csv."""

    def described(self) -> Any:
        """Return the entry of the part in run.json, equal on all ranks."""


class Histories:
    """All quantities that are followed.

    Args:
        parts: by the name that they have in run.json and in checkpoints.
    """

    def __init__(self, parts: Mapping[str, FollowedQuantity]) -> None:
        self._parts = parts

    def update(self, state: Any) -> None:
        """Take over the state after an accepted step; collective."""
        for part in self._parts.values():
            part.update(state)

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return a field of a body, ghosts included; None: nothing here knows it; collective."""
        for part in self._parts.values():
            found = part.field(body, name)
            if found is not None:
                return found
        return None

    def totals(self) -> dict[str, float]:
        """Return all totals by the name of their column; collective."""
        return {name: value for part in self._parts.values()
                for name, value in part.totals().items()}  # fmt: skip

    def described(self) -> dict[str, Any]:
        """Return the entries in run.json by part; collective."""
        found = {name: part.described() for name, part in self._parts.items()}
        return {name: said for name, said in found.items() if said}

    def saved(self) -> dict[str, Saved]:
        """Return the states of all parts; collective."""
        return saved_parts(self._parts)

    def restore(self, arrays: Arrays) -> None:
        """Restore the histories of an earlier part of the run; collective."""
        for name, part in self._parts.items():
            if saved := part_of(arrays, name):
                part.restore(saved)


def histories_of(
    case: Case, mesh: CastingMesh, pairs: Mapping[str, NodePairs], pores: Pores
) -> Histories:
    """Return the histories to follow in a case.

    Args:
        case: what is run.
        mesh: the bodies.
        pairs: of all interfaces, by name.
        pores: returns the pore fraction of the nodes of a body, if a field asks for it.
    """
    return Histories(
        {
            "feeding": feeders_of(case, mesh),
            "last_liquid": last_liquid_of(case, mesh),
            "openings": first_openings_of(case, mesh, pairs),
            "heat_flux": heat_fluxes_of(case, mesh),
            "flux_errors": flux_errors_of(case, mesh),
            "die": die_surfaces_of(case, mesh),
            "feeding_distance": feeding_reach_of(case, mesh, pairs, pores),
            "suction": suction_margins_of(case, mesh),
            "ejection": ejection_forces_of(case, mesh, pairs),
        }
    )
