"""The fields that are shown: their names in plain words, units and colours."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from castx.results.states.quantities import MARGINS, PASSING, UNITS


@dataclass(frozen=True)
class Topic:
    """A field as it is shown.

    Args:
        field: its name.
        title: heading.
        caption: what is seen; {front} is where gradients are taken.
        unit: in which it is shown.
        colours: name of the colour map.
        factor: from SI to the unit.
        melting: whether only the bodies that freeze show it; else the others have colours of
            their own, `beside`.
        beside: name of the colour map of bodies that do not freeze.
        final: whether it is shown at the end only.
        front: whether the line f_s = 0.5 is drawn.
        share: of the values inside the colours.
    """

    field: str
    title: str
    caption: str
    unit: str
    colours: str
    factor: float = 1.0
    melting: bool = False
    beside: str = "cividis"
    final: bool = False
    front: bool = False
    share: float = 1.0

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title


TOPICS = (
    Topic("temperature", "Temperature", "The blue line is f_s = 0.5.", "°C", "inferno", front=True,
          beside="viridis"),
    Topic("solid_fraction", "Solid fraction", "", "", "Blues", melting=True, front=True),
    Topic("largest_principal_stress", "Largest principal stress", "Positive in tension.", "MPa",
          "viridis", 1e-6, share=0.99),
    Topic("smallest_principal_stress", "Smallest principal stress", "Positive in tension.", "MPa",
          "viridis", 1e-6, share=0.99),
    Topic("von_mises", "Von Mises stress", "", "MPa", "viridis", 1e-6, share=0.99),
    Topic("pressure", "Pressure", "Mean stress, positive in tension.", "MPa", "viridis", 1e-6,
          share=0.99),
    Topic("deviation", "Deviation from the nominal surface",
          "After the best-fit motion; positive outward. In plane pictures one cell wide.", "mm",
          "RdBu_r", 1e3),
    Topic("first_opening", "First opening of the gap",
          "On the surface of the casting, in plane pictures one cell wide.", "s", "cividis",
          melting=True, final=True),
    Topic("heat_flux", "Heat flux", "Size of -k ∇T; the files of the fields have its direction.",
          "kW/m²", "inferno", 1e-3, beside="viridis", share=0.99),
    Topic("gap", "Gap", "On the surface of the casting.", "µm", "YlGnBu", 1e6, melting=True),
    Topic("contact_pressure", "Contact pressure", "On the surface of the casting.", "MPa", "YlOrRd",
          1e-6, melting=True, share=0.99),
    Topic("heat_transfer_coefficient", "Heat transfer coefficient",
          "On the surface of the casting.", "W/m²/K", "YlOrRd", melting=True),
    Topic("plastic_strain", "Plastic strain", "", "%", "viridis", 100.0, share=0.99),
    Topic("solidification_time", "Local solidification time",
          "Time between liquidus and solidus.", "s", "cividis", melting=True, final=True),
    Topic("niyama", "Niyama criterion",
          "G/√Ṫ at {front}. Shrinkage porosity is likely where it is low; the limit depends on "
          "the alloy, for steel castings it is near 1 K^½ s^½/mm.",
          "K^½ s^½/mm", "RdYlGn", 1e-3, melting=True, final=True, share=0.9),
    Topic("dimensionless_niyama", "Dimensionless Niyama criterion",
          "λ2 G √(Δp_c/(μ β ΔT_f Ṫ)) at {front}. Pores open where it is low.",
          "", "RdYlGn", melting=True, final=True, share=0.9),
    Topic("pore_fraction", "Shrinkage porosity",
          "Pores where the suction of the mush reaches its limit, from the history at {front}: arm "
          "spacing, viscosity and the limit are uncertain by tens of percent, gas is left out, and "
          "so is feeding over a distance.",
          "%", "YlOrRd", 100.0, melting=True, final=True, share=0.99),
    Topic("clyne_davies", "Hot-tearing ratio of Clyne and Davies",
          "Time from f_s = 0.9 to 0.99 over that from 0.4 to 0.9: it compares places, without a "
          "limit, and has no stress in it.",
          "", "YlOrRd", melting=True, final=True, share=0.9),
    Topic("brittle_strain", "Strain in the brittle range",
          "Largest principal strain across the gradient, elastic and inelastic, gained from f_s = "
          "0.9 to 0.99: what the alloy bears is another matter.",
          "%", "YlOrRd", 100.0, melting=True, final=True, share=0.99),
    Topic("brittle_strain_index", "Strain in the brittle range over what the alloy bears",
          "Strain gained from f_s = 0.9 to 0.99 over critical_strain; above 1 it tears.",
          "", "YlOrRd", melting=True, final=True, share=0.99),
    Topic("brittle_time", "Time in the brittle range", "From f_s = 0.9 to 0.99.", "s", "cividis",
          melting=True, final=True, share=0.99),
    Topic("cold_crack_index", "Cold-crack index",
          "Largest σ_1/R_m(T) since the metal was solid; above 1 it cracks.",
          "", "YlOrRd", final=True, share=0.99),
    Topic("modulus", "Thermal modulus",
          "√(t_s/C) of the time from pouring until all is solid; C holds for sand, not for dies.",
          "mm", "cividis", 1e3, melting=True, final=True),
    Topic("front_speed", "Speed of the front", "At {front}.", "mm/s", "viridis", 1e3,
          melting=True, final=True, share=0.9),
    Topic("gradient", "Temperature gradient", "At {front}.", "K/mm", "viridis", 1e-3, melting=True,
          final=True, share=0.9),
    Topic("cooling_rate", "Cooling rate", "At {front}.", "K/s", "viridis", melting=True,
          final=True, share=0.9),
    Topic("arm_spacing", "Secondary arm spacing", "From the cooling rate at {front}.",
          "µm", "viridis", 1e6, melting=True, final=True),
    Topic("yield_strength", "Yield strength by arm spacing",
          "A regression, valid for the heat treatment of its samples alone.",
          "MPa", "viridis", 1e-6, melting=True, final=True),
    Topic("emptied", "Emptied by feeding", "The pipe: share that has flowed out.", "%", "Blues",
          100.0, melting=True),
    Topic("feeding_path", "Path to the nearest feeder", "Inside the casting.", "mm", "cividis",
          1e3, melting=True, final=True),
    Topic("strain_range", "Strain range of a cycle", "Of the last whole cycle, or so far.", "%",
          "YlOrRd", 100.0, beside="YlOrRd", final=True, share=0.99),
    Topic("life", "Life, powers of ten",
          "log10 of the number of cycles: 4 is 10,000. Isothermal coefficients, without oxidation "
          "and soldering.", "", "RdYlGn", beside="RdYlGn", final=True, share=0.9),
)  # fmt: skip
LEFT_OUT = ("body", "displacement", "stress")
"""Arrays that are not shown as colours: the number of a body, and what has several parts."""


def topics_of(names: Iterable[str]) -> Iterator[Topic]:
    """Yield the topics of fields in the order of `TOPICS`, then those of other fields.

    Args:
        names: of the arrays of scalars that were written.
    """
    written = set(names)
    yield from (topic for topic in TOPICS if topic.field in written)
    for name in sorted(written - {topic.field for topic in TOPICS} - set(LEFT_OUT)):
        if name.startswith(PASSING):
            fraction = float(name.removeprefix(PASSING))
            yield Topic(name, f"Time of solid fraction {fraction:g}",
                        "From when the casting was poured.", "s", "cividis", melting=True,
                        final=True)  # fmt: skip
        elif name.startswith(MARGINS):
            cut_off = float(name.removeprefix(MARGINS))
            yield Topic(name, f"Tearing margin, cut off at g_c = {cut_off:g}",
                        "Strain rate across the gradient over the critical one of Rappaz, Drezet "
                        "and Gremaud; above 1 it tears. The answer hangs on g_c: judge the band of "
                        "all cut-offs.", "", "YlOrRd", melting=True, final=True,
                        share=0.9)  # fmt: skip
        else:
            title = name.replace("_", " ").capitalize()
            unit = UNITS.get(name, "")
            yield Topic(name, title, "", "" if unit == "1" else unit, "viridis", share=0.99)
