"""Rows of all ranks on the first one by their numbers, and back with ghosts."""

from __future__ import annotations

import numpy as np
import pytest

from castx.checkpoint import gathering
from castx.checkpoint.gathering import Gathering
from castx.stateful import Numbering

ENTITIES = 23
FAR = 10**12
"""Numbers need not be consecutive."""


def numbering(comm, empty: bool = False) -> Numbering:
    """Return entities dealt out to the ranks, with ghosts from all of them behind the owned ones.

    Args:
        comm: ranks.
        empty: whether the last rank owns nothing.
    """
    dealers = comm.size - (empty and comm.size > 1)
    order = np.random.default_rng(5).permutation(ENTITIES)
    own = order[comm.rank :: dealers] if comm.rank < dealers else order[:0]
    ghosts = np.setdiff1d(order, own)[:4]
    numbers = FAR + 3 * np.concatenate((own, ghosts))
    return Numbering("entities", numbers, len(own), ("casting",))


def values_of(numbers: np.ndarray, kind: str) -> np.ndarray:
    """Return rows that tell their numbers."""
    match kind:
        case "scalar":
            return np.sqrt(numbers.astype(np.float64))
        case "tensor":
            return numbers[:, None, None] * np.array([[1.0, 2.0], [3.0, 4.0]])
        case _:
            return (numbers // 3) % 2 == 0


@pytest.mark.parametrize("chunk", [gathering.CHUNK, 32])
@pytest.mark.parametrize("empty", [False, True])
@pytest.mark.parametrize("kind", ["scalar", "tensor", "flag"])
def test_rows_go_to_the_first_rank_by_number_and_back_with_ghosts(
    comm, monkeypatch, kind, empty, chunk
):
    """Also in many small messages, and where a rank has nothing."""
    monkeypatch.setattr(gathering, "CHUNK", chunk)
    moving, own = Gathering(comm), numbering(comm, empty)
    local = values_of(own.numbers, kind)
    spoilt = local.copy()
    spoilt[own.owned :] = 0  # rows of ghosts are not sent
    gathered = moving.to_first(spoilt, own)
    if comm.rank == 0:
        expected = values_of(FAR + 3 * np.arange(ENTITIES), kind)
        np.testing.assert_array_equal(gathered, expected)
        assert gathered.dtype == local.dtype
    else:
        assert gathered is None
    back = moving.from_first(gathered, np.zeros_like(local), own)
    assert back.dtype == local.dtype
    np.testing.assert_array_equal(back, local)
