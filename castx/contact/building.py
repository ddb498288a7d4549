"""Builds the contact system of a method."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import FloatArray
from castx.contact.augmented import AugmentedMultipliers
from castx.contact.choice import Contact
from castx.contact.condensed import CondensedContact
from castx.contact.friction.condensed import CondensedFriction
from castx.contact.friction.coulomb import SlidingRows
from castx.contact.friction.penalty import PenaltyFriction
from castx.contact.kinematics.coordinates import Coordinates
from castx.contact.kinematics.gaps import Gaps
from castx.contact.method import ContactSystem
from castx.contact.methods.description import ContactMethod, UnknownKind
from castx.contact.methods.penalty import AUTOMATIC
from castx.contact.multipliers import MultiplierContact
from castx.contact.penalty import Multipliers, NoMultipliers, PenaltyContact
from castx.contact.penalty_stiffness import SofterSide


def contact_system(
    method: ContactMethod,
    contacts: Sequence[Contact],
    coordinates: Coordinates,
    body_names: Sequence[str],
    gaps: Gaps,
    stiffness: float,
) -> ContactSystem:
    """Return the contact of all interfaces.

    Args:
        method: the method of all of them.
        contacts: the interfaces in the order of the gaps.
        coordinates: coordinates of the bodies, as the method needs them.
        body_names: names of the bodies in the order of the layout.
        gaps: the pairs of all interfaces.
        stiffness: G/L of the bodies [Pa/m].
    """
    sliding = None
    if any(c.friction > 0 for c in contacts):
        sliding = SlidingRows(gaps, [c.friction for c in contacts])
    if method.unknowns is UnknownKind.GAPS:
        friction = None
        if sliding is not None:
            friction = CondensedFriction(coordinates.layout, gaps, sliding)
        return CondensedContact(coordinates, gaps, friction)
    if method.unknowns is UnknownKind.MULTIPLIERS:
        return MultiplierContact(coordinates, gaps, stiffness)
    rows, comm = len(gaps.local), coordinates.layout.comm
    multipliers: Multipliers = NoMultipliers(rows)
    if method.updates_multipliers:
        chosen = next(c for c in contacts if c.method == method.name)
        every_iteration = chosen.setting("augmentation") == "iteration"
        most = int(chosen.setting("augmentations"))
        multipliers = AugmentedMultipliers(comm, rows, every_iteration, most)
    softer = SofterSide(
        coordinates.layout, body_names, coordinates.dimension, gaps, _given(contacts, gaps)
    )
    tractions = None
    if sliding is not None:
        tractions = PenaltyFriction(coordinates, body_names, gaps, sliding)
    return PenaltyContact(coordinates, gaps, softer.evaluate, multipliers, tractions)


def _given(contacts: Sequence[Contact], gaps: Gaps) -> FloatArray:
    """Return the given penalties [Pa/m], not a number where there is none."""
    given = np.full(len(gaps.local), np.nan)
    for contact, part in zip(contacts, gaps.slices, strict=True):
        penalty = contact.setting("penalty")
        if penalty != AUTOMATIC:
            given[part] = penalty
    return given
