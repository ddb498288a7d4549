"""Solid fraction over temperature after Scheil and Gulliver, from a thermodynamic database.

The calculation is that of the packages pycalphad and scheil: local equilibrium at the front, liquid
of one composition, no diffusion in the solid. G. H. Gulliver, J. Inst. Met. 9 (1913) 120-157;
E. Scheil, Z. Metallkunde 34 (1942) 70-72.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from castx.errors import CaseError
from castx.input.problems import among, show

PACKAGES = ("pycalphad", "scheil")
CURE = "pip install pycalphad scheil, or the extra: pip install '.[calphad]'"
LIQUID, GAS = "LIQUID", "GAS"
COLDEST, HOTTEST, SETTLED = 300.0, 4000.0, 1e-3
"""Where the liquidus is sought, and to what it is found [K]."""
PRESSURE = 101325.0
KELVIN = 273.15


@dataclass(frozen=True)
class Composition:
    """An alloy by its composition.

    Attributes:
        base: symbol of the element that is the rest.
        parts: shares of mass of the others by symbol, between 0 and 1.
    """

    base: str
    parts: Mapping[str, float]

    @classmethod
    def of(cls, words: list[str]) -> Composition:
        """Return the alloy of words such as AL SI=7 MG=0.3, in percent of mass.

        Raises:
            CaseError: they cannot be read so.
        """
        parts = {}
        for word in words[1:]:
            symbol, _, number = word.partition("=")
            try:
                parts[symbol.upper()] = float(number) / 100.0
            except ValueError:
                raise CaseError(f"{show(word)}: write SYMBOL=PERCENT, such as SI=7") from None
        positive = all(share > 0.0 for share in parts.values())
        if not parts or len(parts) + 1 < len(words) or not positive or sum(parts.values()) >= 1.0:
            raise CaseError(
                f"{show(' '.join(words))}: name the base and then each other element once with its "
                "percent of mass, above 0 and together below 100, such as: AL SI=7 MG=0.3"
            )
        return cls(words[0].upper(), parts)


def scheil_table(
    file: Path, alloy: Composition, step: float = 1.0, rest: float = 0.01
) -> tuple[tuple[float, float], ...]:
    """Return rows of temperature [°C] and solid fraction, from solidus to liquidus.

    The first row is that of the liquid that is left at the solidus and freezes there.

    Args:
        file: thermodynamic database (TDB).
        alloy: what freezes.
        step: of temperature, its largest value [K].
        rest: share of liquid that is taken to freeze at one temperature.

    Raises:
        CaseError: the packages are missing, the file cannot be read, it lacks elements, or no
            liquidus or no end of freezing is found.
    """
    if not (step > 0.0 and 0.0 < rest < 1.0):
        raise CaseError(f"step {step:g}, rest {rest:g}: the step must be above 0, the rest in 0…1")
    missing = [name for name in PACKAGES if not find_spec(name)]
    if missing:
        raise CaseError(f"Scheil curves need {' and '.join(missing)}, not installed here: {CURE}")
    from pycalphad import variables as v
    from scheil import simulate_scheil_solidification

    database = _read(file, alloy)
    elements = [alloy.base, *alloy.parts, "VA"]
    phases = [name for name in database.phases if name != GAS]
    shares = {v.W(symbol): share for symbol, share in alloy.parts.items()}
    moles = v.get_mole_fractions(shares, alloy.base, database)
    liquidus = _liquidus(database, elements, phases, moles)
    found = simulate_scheil_solidification(
        database, elements, phases, moles, liquidus + SETTLED, step_temperature=step, stop=rest
    )
    if not found.converged and found.fraction_liquid[-2] > rest:
        raise CaseError(f"{file}: freezing does not end; {found.fraction_liquid[-2]:.3g} is left")
    rows = [(liquidus - KELVIN, 0.0)]
    for temperature, fraction in zip(found.temperatures, found.fraction_solid, strict=True):
        warmest, most = rows[-1]
        if temperature - KELVIN < warmest and most < fraction < 1.0:
            rows.append((temperature - KELVIN, float(fraction)))
    return tuple(reversed(rows))


def case_text(rows: tuple[tuple[float, float], ...], file: Path, alloy: Composition) -> str:
    """Return the rows as a material of a case file, with a line that says what they are."""
    parts = ", ".join(f"{symbol} {100.0 * share:g}" for symbol, share in alloy.parts.items())
    table = ",\n".join(f"    [{temperature:.3f}, {fraction:.6f}]" for temperature, fraction in rows)
    title = f"# Scheil: {alloy.base} with {parts} % of mass, after {file.name}"
    return f"{title}\n[materials.alloy]\nsolid_fraction = [\n{table},\n]\n"


def _read(file: Path, alloy: Composition) -> Any:
    """Return the database in a file, if it has the elements of the alloy and a liquid."""
    from pycalphad import Database

    try:
        database = Database(str(file))
    except Exception as error:  # of the parser, which has many
        raise CaseError(f"{file}: cannot be read as a thermodynamic database: {error}") from None
    known = sorted(database.elements - {"VA", "/-"})
    for symbol in (alloy.base, *alloy.parts):
        if symbol not in known:
            raise CaseError(f"{file}: no element {symbol!r}; {among(symbol, known)}")
    if LIQUID not in database.phases:
        raise CaseError(f"{file}: no phase {LIQUID!r}; {among(LIQUID, sorted(database.phases))}")
    return database


def _liquidus(
    database: Any, elements: list[str], phases: list[str], moles: Mapping[Any, float]
) -> float:
    """Return the lowest temperature at which all is liquid [K], by bisection."""
    from pycalphad import Workspace
    from pycalphad import variables as v

    def is_liquid(temperature: float) -> bool:
        state = {v.T: temperature, v.P: PRESSURE, v.N: 1.0, **moles}
        share = Workspace(database, elements, phases, state).get(f"NP({LIQUID})")
        return bool(share > 1.0 - 1e-9)

    low, high = COLDEST, HOTTEST
    if is_liquid(low) or not is_liquid(high):
        raise CaseError(f"no liquidus between {low - KELVIN:g} and {high - KELVIN:g} °C")
    while high - low > SETTLED:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if is_liquid(middle) else (middle, high)
    return high
