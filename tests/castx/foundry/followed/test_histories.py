"""Several followed quantities behind one face."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.followed.histories import Histories
from castx.stateful import Saved

pytestmark = pytest.mark.serial


class Counted:
    """Counts the states that it has seen."""

    def __init__(self, name: str) -> None:
        self.name, self.seen = name, 0

    def update(self, state: object) -> None:
        self.seen += 1

    def field(self, body: str, name: str) -> np.ndarray | None:
        return np.full(2, float(self.seen)) if name == self.name else None

    def totals(self) -> dict[str, float]:
        return {f"{self.name}.seen": float(self.seen)}

    def described(self) -> int:
        return self.seen

    def saved(self) -> dict[str, Saved]:
        return {"seen": Saved(np.array(self.seen))}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        self.seen = int(arrays["seen"])


def test_each_part_answers_for_itself_and_goes_on():
    histories = Histories({"first": Counted("a"), "second": Counted("b")})
    histories.update(object())
    assert histories.totals() == {"a.seen": 1.0, "b.seen": 1.0}
    assert histories.field("casting", "b").tolist() == [1.0, 1.0]
    assert histories.field("casting", "c") is None
    saved = {name: saved.values for name, saved in histories.saved().items()}
    del saved["second/seen"]
    resumed = Histories({"first": Counted("a"), "second": Counted("b")})
    resumed.restore(saved)
    resumed.update(object())
    assert resumed.described() == {"first": 2, "second": 1}
