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
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.transform import ConstraintTransform
from castx.contact.methods.description import ContactMethod, PairLaw, UnknownKind
from castx.contact.methods.penalty import AUTOMATIC
from castx.contact.methods.registry import METHODS
from castx.contact.multipliers import MultiplierContact, MultiplierUnknowns
from castx.contact.penalty_stiffness import PenaltyStiffness
from castx.contact.soft import SoftContact
from castx.contact.system import ContactSystem


def contact_system(
    method: ContactMethod,
    contacts: Sequence[Contact],
    transform: ConstraintTransform,
    body_names: Sequence[str],
    gaps: Gaps,
    moduli: Sequence[float],
) -> ContactSystem:
    """Return the contact of all interfaces.

    Args:
        method: the method of all of them.
        contacts: the interfaces in the order of the gaps.
        transform: change of unknowns of the bodies, as the method needs it.
        body_names: names of the bodies in the order of the layout.
        gaps: the pairs of all interfaces.
        moduli: G/L of the bodies, G the largest of each and L the size of the whole [Pa/m].
    """
    sliding = []
    if any(c.friction > 0 for c in contacts):
        sliding = [SlidingRows(gaps, [c.friction for c in contacts])]
    if method.unknowns is UnknownKind.MULTIPLIERS:
        unknowns = MultiplierUnknowns(transform, gaps, max(moduli))
        return ContactSystem(MultiplierContact(unknowns, gaps))
    if method.unknowns is UnknownKind.DISPLACEMENTS:
        return _soft(method, contacts, transform, body_names, gaps, moduli, sliding)
    friction = [CondensedFriction(transform.layout, gaps, rows) for rows in sliding]
    return ContactSystem(CondensedContact(transform, gaps), friction)


def _soft(
    method: ContactMethod,
    contacts: Sequence[Contact],
    transform: ConstraintTransform,
    body_names: Sequence[str],
    gaps: Gaps,
    moduli: Sequence[float],
    sliding: Sequence[SlidingRows],
) -> ContactSystem:
    comm = transform.layout.comm
    multipliers = []
    if method.updates_multipliers:
        chosen = next(c for c in contacts if c.method == method.name)
        every_iteration = chosen.setting("augmentation") == "iteration"
        most = int(chosen.setting("augmentations"))
        multipliers = [AugmentedMultipliers(comm, gaps, every_iteration, most)]
    penalty = PenaltyStiffness(
        transform.layout, body_names, transform.dimension, gaps, _given(contacts, gaps), moduli
    )
    none = np.zeros(len(gaps.local))
    pairs = SoftContact(
        transform, gaps, [_pair_law(method, contact) for contact in contacts],
        lambda: penalty.springs, multipliers[0].forces if multipliers else lambda: none,
    )  # fmt: skip
    friction = [
        PenaltyFriction(
            transform, body_names, gaps, rows, pairs.gap_matrix, lambda: penalty.springs
        )
        for rows in sliding
    ]
    return ContactSystem(pairs, friction, multipliers, penalty)


def _pair_law(method: ContactMethod, contact: Contact) -> PairLaw:
    """Return the law of an interface; rows of tied interfaces have no force by any law."""
    own = METHODS[contact.method]
    make = own.pair_law or method.pair_law
    assert make is not None
    return make({key.name: contact.setting(key.name) for key in own.keys})


def _given(contacts: Sequence[Contact], gaps: Gaps) -> FloatArray:
    """Return the given penalties [Pa/m], not a number where there is none."""
    given = np.full(len(gaps.local), np.nan)
    for contact, part in zip(contacts, gaps.slices, strict=True):
        penalty = contact.setting("penalty")
        if penalty != AUTOMATIC:
            given[part] = penalty
    return given
