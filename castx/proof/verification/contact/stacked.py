"""The case of an upper block that is pushed onto a base, elastic, as verifications of contact use.

The geometry is that of `stacked_blocks` in plane strain; the base rests on its bottom, the top of
the upper block moves down.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from castx.proof.verification.verification import Curve

Size = tuple[float, float]
"""Width and height of a block [m]."""


def stacked_case(
    size: float,
    blocks: Mapping[str, Size],
    young: Mapping[str, float],
    poisson: float,
    push: float,
    contact: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the case, to be solved to round-off.

    Args:
        size: of the cells [m].
        blocks: sizes of "upper" and "base".
        young: moduli of both [Pa].
        poisson: ratio of both.
        push: displacement of the top, downwards [m].
        contact: keys of the contact.
    """
    return {
        "geometry": {
            "generator": "stacked_blocks", "model": "plane-strain", "size": size, "symmetry": True,
            **{name: list(extent) for name, extent in blocks.items()},
        },
        "materials": {
            name: {"young_modulus": modulus, "poisson_ratio": poisson, "expansion": 0.0}
            for name, modulus in young.items()
        },
        "bodies": [{"name": name, "material": name, "temperature": 20.0} for name in young],
        "interfaces": [{"bodies": ["upper", "base"], "contact": dict(contact)}],
        "boundaries": [
            {"on": "base/bottom", "displacement": {"normal": 0.0}},
            {"on": "upper/top", "displacement": {"normal": -push}},
        ],
        "time": {"end": 1.0, "fixed_step": 1.0},
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-12},
    }  # fmt: skip


def over_penalties(
    name: str,
    penalties: Sequence[float],
    found: Sequence[float],
    exact: Callable[[float], float],
    scale: float,
) -> Curve:
    """Return the answers under penalties [Pa/m] and the exact line over their logarithms.

    Args:
        name: of the curve.
        penalties: rising, where something was found.
        found: one for each penalty.
        exact: answer of a penalty.
        scale: from the answers to the units of the picture.
    """
    line = np.logspace(np.log10(penalties[0]), np.log10(penalties[-1]), 200)
    return Curve(name, np.log10(penalties), scale * np.array(found), np.log10(line),
                 scale * np.array([exact(value) for value in line]))  # fmt: skip
