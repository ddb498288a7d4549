"""Residual stress and distortion in the summary of the report."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from castx.results.quantities import parts


def solid_rows(ends: Sequence[Mapping[str, Any]], model: str) -> Iterator[tuple[str, str]]:
    """Yield stress and distortion of the bodies where they were last there, as name and text.

    Args:
        ends: those of the stages in run.json.
        model: geometric model.
    """
    latest = {body: (end["time"], found) for end in ends for body, found in end["bodies"].items()}
    for body, (time, found) in latest.items():
        stress, distortion = found["stress"], found.get("distortion")
        pull, mises = stress["largest_principal"], stress["von_mises"]
        yield (
            f"stress {body}",
            f"at {time:g} s largest principal {_mega(pull['value'])} at {_place(pull)}, von Mises "
            f"{_mega(mises['value'])} at {_place(mises)} and {_mega(stress['mean_von_mises'])} in "
            "the mean",
        )
        if distortion is None:
            continue
        out, into = distortion["outward"], distortion["inward"]
        shares = zip(parts("displacement", model), distortion["allowance"], strict=True)
        yield (
            f"distortion {body}",
            f"at {time:g} s from {1e3 * into['value']:.3g} mm at {_place(into)} to "
            f"{1e3 * out['value']:.3g} mm at {_place(out)}, positive outward; allowance "
            + ", ".join(f"{axis} {100.0 * share:.3g} %" for axis, share in shares),
        )


def _mega(stress: float) -> str:
    return f"{1e-6 * stress:.3g} MPa"


def _place(extreme: Mapping[str, Any]) -> str:
    return "(" + ", ".join(f"{1e3 * x:.1f}" for x in extreme["place"]) + ") mm"
