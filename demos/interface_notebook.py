# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # What controls the heat between casting and mould?
#
# One interface, all laws. A slice of an aluminium cylinder, 60 mm thick, freezes in a steel mould
# of 25 mm. Through their common surface passes
#
# $$ q = h\,(T_\mathrm{casting} - T_\mathrm{mould})
#      + \frac{\sigma\,(T_\mathrm{casting}^4 - T_\mathrm{mould}^4)}
#             {1/\varepsilon_\mathrm{c} + 1/\varepsilon_\mathrm{m} - 1}, $$
#
# where $h$ depends on the gap $g$ that opens as the casting shrinks, or on a stand-in for it. The
# laws are those of section 9 of M. Chiumenti, *Thermo-mechanical contact in casting analysis*. To
# open this text as a notebook: `jupytext --to ipynb interface_notebook.py -o interface.ipynb`.

# %%
from mpi4py import MPI

import matplotlib.pyplot as plt
import numpy as np

import castx

# %% [markdown]
# ## The laws
# All that castx has, each drawn over the gap in its simplest form; $F_S$ is 0.5.

# %%
gas = 0.05
numbers = {"closed": 2300, "open": 500, "gas_conductivity": gas}
gaps = np.linspace(0.0, 150e-6, 301)
plt.figure(figsize=(8, 4), layout="constrained")
for name, law in castx.gap_heat_laws().items():
    print(f"{name:15s} {law.formula}")
    if law.exchange == "law":
        heat = {key: numbers.get(key, value) for key, value in law.example().items()}
        h = castx.heat_transfer_coefficient(heat, gaps, solid_fraction=0.5)
        plt.plot(1e6 * gaps, h, label=name)
plt.xlabel("gap [µm]")
plt.ylabel("h [W/m²/K]")
plt.legend()
plt.show()

# %% [markdown]
# `limited` lets a narrow gap pass unnoticed, up to $k/h_0 = 22$ µm; `series` feels it at once. Both
# end at $k/g$.
#
# ## The runs
# Heat and mechanics together; only the law differs. Each entry is the `heat` of an interface as a
# case file has it. All touch with 2300 W/m²/K except the last, an interface of the database, where
# roughness and a coating decide: with 0.3 mm in place of its 0.1 mm it is worse than the gap.

# %%
for name in castx.interface_names():
    print(f"{name:30s} {castx.heat_transfer_coefficient({'from': name}):6.0f} W/m²/K closed")
grey = {"emissivities": [0.3, 0.8]}
laws = {
    "constant": {"law": "constant", "closed": 2300},
    "limited": {"law": "limited", "closed": 2300, "gas_conductivity": gas},
    "limited, radiating": {
        "law": "limited", "closed": 2300, "gas_conductivity": gas, "radiation": grey
    },
    "series": {"law": "series", "closed": 2300, "gas_conductivity": gas},
    "only radiation": {"law": "none", "radiation": grey},
    "coated": {"from": "aluminium-steel-coating-layer", "coating": {"thickness": "0.3 mm"}},
}


# %%
def case(heat, **changes):
    """Return the slice between planes that do not move."""
    level = [f"{body}/{end}" for body in ("casting", "mould") for end in ("base", "top")]
    return {
        "geometry": {
            "generator": "cylinder_in_mould", "model": "axisymmetric", "size": "2 mm",
            "radius": "30 mm", "wall": "25 mm", "height": "4 mm",
        },
        "bodies": [
            {"name": "casting", "material": "Al-pure", "temperature": 670},
            {"name": "mould", "material": "steel-H13", "temperature": 200,
             "formulation": "displacement"},
        ],
        "interfaces": [{"bodies": ["casting", "mould"], "heat": heat}],
        "boundaries": [{"on": surface, "displacement": {"normal": 0}} for surface in level],
        "time": {"end": 140, "first_step": 0.05, "largest_step": 2, "temperature_change": 40},
        **changes,
    }


def run(heat, **changes):
    """Return the history of a run: columns over time."""
    rows = []
    simulation = castx.Simulation.from_case(castx.load_case(case(heat, **changes)), MPI.COMM_SELF)
    for state in simulation:
        at_face = {
            body: state.nodal(body, "temperature")[state.mesh.bodies[body].surface_nodes(other)]
            for body, other in (("casting", "mould"), ("mould", "casting"))
        }
        row = {name: values.mean() for name, values in at_face.items()}
        rows.append({"time": state.time, **row, **state.totals})
    simulation.destroy()
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


runs = {name: run(heat) for name, heat in laws.items()}

# %% [markdown]
# A run without mechanics knows no gap. `solid-fraction` goes from h_closed to h_open as the whole
# casting freezes; the gap at the end of the coupled run gives the latter, $k/g$.

# %%
end_gap = float(np.interp(0.98, runs["limited"]["casting.solid_fraction"],
                          runs["limited"]["casting/mould.mean_gap"]))
stand_in = {"law": "solid-fraction", "closed": 2300, "open": gas / end_gap}
runs["solid-fraction, thermal"] = run(stand_in, coupling={"scheme": "thermal"})

# %% [markdown]
# ## Temperatures and power
# `history.csv` has the same columns: `casting/mould.power` [W], and by mechanism
# `casting/mould.power.contact`, `.gas`, `.radiation`; energies [J] with `heat` in place of `power`.

# %%
figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(9, 7), layout="constrained")
area = 2 * np.pi * 0.03 * 0.004
for k, (name, history) in enumerate(runs.items()):
    style = "--" if name.startswith("solid-fraction") else "-"
    upper.plot(history["time"], history["casting"], f"C{k}{style}", label=name)
    upper.plot(history["time"], history["mould"], f"C{k}{style}", linewidth=0.8)
    power = history["casting/mould.power"][1:] / area / 1e3
    lower.plot(history["time"][1:], power, f"C{k}{style}")
upper.set_ylabel("faces: casting, mould (thin) [°C]")
lower.set_ylabel("heat flux [kW/m²]")
lower.set_yscale("log")
lower.set_xlabel("time [s]")
figure.legend(loc="outside upper center", ncols=4, fontsize=9)
plt.show()

# %% [markdown]
# While the surfaces are close nearly all goes through gas and contact; as the gap widens, radiation
# stays what it was and gains in share.

# %%
history = runs["limited, radiating"]
plt.figure(figsize=(8, 3.5), layout="constrained")
power = {way: history[f"casting/mould.power.{way}"] for way in ("contact", "gas", "radiation")}
plt.semilogy(history["time"], (power["contact"] + power["gas"]) / area / 1e3, label="conducted")
plt.semilogy(history["time"], power["radiation"] / area / 1e3, label="radiated")
plt.xlabel("time [s]")
plt.ylabel("heat flux [kW/m²]")
plt.legend(title="limited, radiating")
plt.show()


# %%
def solid(history):
    """Return the time at which 98 % are solid; nan: never."""
    fraction = history["casting.solid_fraction"]
    return float(np.interp(0.98, fraction, history["time"])) if fraction[-1] > 0.98 else np.nan


times = {name: solid(history) for name, history in runs.items()}
for name, time in times.items():
    share = runs[name]["casting/mould.heat.radiation"][-1] / runs[name]["casting/mould.heat"][-1]
    print(f"{name:24s} 98 % solid after {time:5.1f} s, {100 * share:4.1f} % of the heat radiated")
print(f"without the gap: {times['constant'] / times['limited']:.2f} of the time with it")
print(f"stand-in: {times['solid-fraction, thermal'] / times['limited']:.2f}")

# %% [markdown]
# ## Advice
# - **The gap rules from the first seconds on.** $h_0$ decides on the skin and on castings of a few
#   millimetres; in anything thicker the time of solidification follows $k/g$, and a constant
#   coefficient that fits the thermocouples of one casting will not fit the next.
# - **Take `series` where the contact itself resists** (coated or rough dies: give `roughness` and
#   `coating`, they also give `closed`), `limited` where $h_0$ was measured with the gap in it.
#   The two differ most while the gap is near $k/h_0$.
# - **Mind the gas.** $k$ of air grows from 0.026 at 20 °C to 0.078 W/m/K at 1000 °C, and hydrogen
#   from burning binders conducts several times better: a table over temperature costs nothing.
# - **Radiation** works in parallel with the gas. Across 0.1 mm it carries some percent for
#   aluminium, a quarter or more for steel, everything under vacuum; the wider the gap, the more.
# - **Without mechanics** use `solid-fraction`, with `open` = $k/g$ for the gap you expect: the free
#   shrinkage of the radius, $\alpha\,\Delta T\,R$, plus what the mould gives way. Here it is
#   a fifth short of the time of solidification, since the gap opens as soon as the skin bears and
#   not in proportion to the solid fraction; nor does it know where the mould is gripped.
# - **Contact pressure** matters where the casting shrinks onto a core: give `pressure`.
# - Everything has its account in `history.csv`: look there first for what took the heat.
