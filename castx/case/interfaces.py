"""The interfaces between bodies: mechanical contact and heat transfer."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from castx.case.contact import InterfaceContact
from castx.case.heat_transfer import InterfaceHeat
from castx.input.entries import Description, EntryName


class Interface(Description):
    """Two bodies that face each other.

    Attributes:
        bodies: names of the secondary body (casting side) and the primary one (mould side).
        contact: mechanical contact.
        heat: heat transfer; None where no heat is solved for.
    """

    bodies: Annotated[tuple[EntryName, ...], Field(min_length=2, max_length=2)]
    contact: InterfaceContact = InterfaceContact()
    heat: InterfaceHeat | None = None

    @property
    def secondary(self) -> str:
        """Body on the casting side."""
        return self.bodies[0]

    @property
    def primary(self) -> str:
        """Body on the mould side, whose outward normal is the normal of the pairs."""
        return self.bodies[1]

    @property
    def name(self) -> str:
        """Name as "secondary/primary"."""
        return "/".join(self.bodies)
