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
# # How much longer does the air gap keep a casting liquid?
#
# An aluminium cylinder, 60 mm thick and 100 mm high, solidifies in a steel mould. The mould warms
# and grows, the shell of the casting cools and shrinks, and an air gap opens between them. Touching
# surfaces pass $h_0 = 2300$ W/m²/K; through a gap $g$ the air lets no more than $k/g$ pass,
#
# $$ h(g) = \min(h_0,\ k/g), \qquad k = 0.05\ \mathrm{W/m/K}, $$
#
# so that a gap of 0.1 mm cuts the heat flow to about a fifth. Whoever computes solidification with
# a constant coefficient misses this. Here the same case is run both ways: with the gap law, where
# temperature, shrinkage, gap and heat transfer act on each other, and with $h = h_0$ throughout.
#
# The case is `cylinder.toml`, after section 10.2 of M. Chiumenti, *Thermo-mechanical contact in
# casting analysis*, on a coarser mesh. To open this text as a notebook:
# `jupytext --to ipynb cylinder_notebook.py -o cylinder.ipynb`.

# %%
from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np

import castx

folder = Path(mkdtemp())
coarse = ["geometry.size=5e-3", "time.end=70", "time.temperature_change=40"]

# %% [markdown]
# ## Two runs
# What a case file says can be replaced without touching it, here and on the command line (`--set`).

# %%
# %%capture
castx.run("cylinder.toml", coarse, output=folder / "gap")
constant = 'interfaces.0.heat={ law = "constant", closed = 2300 }'
castx.run("cylinder.toml", [*coarse, constant], output=folder / "constant")

# %% [markdown]
# ## Cooling curves
# `probes.csv` has one row per step, `history.csv` the totals of bodies and interfaces.

# %%
results = {name: castx.Results(folder / name) for name in ("gap", "constant")}

figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(8, 6), layout="constrained")
for name, style in (("gap", "-"), ("constant", "--")):
    probes = results[name].probes
    time = probes["time"]
    upper.plot(time, probes["centre.temperature"], f"C0{style}", label=f"centre, {name}")
    upper.plot(time, probes["surface.temperature"], f"C1{style}", label=f"surface, {name}")
    lower.plot(time, 1e6 * probes["gap_mid.gap"], f"C2{style}", label=f"half height, {name}")
upper.set_ylabel("temperature [°C]")
lower.set_ylabel("gap [µm]")
lower.set_xlabel("time [s]")
upper.legend()
lower.legend()
plt.show()

# %% [markdown]
# The gap opens in both runs, but only in one of them does the heat flow notice.


# %%
def solidification_time(series):
    """Return the time at which 99 % of the casting are solid, interpolated between steps."""
    return float(np.interp(0.99, series["casting.solid_fraction"], series["time"]))


times = {name: solidification_time(found.history) for name, found in results.items()}
delay = times["gap"] / times["constant"]
print(f"99 % solid after {times['constant']:.1f} s with h = h0,")
print(f"after {times['gap']:.1f} s with the gap")
print(f"delay: {delay:.2f}")

# %% [markdown]
# ## The cold casting
# Displacements are drawn larger than they are; colours are the temperature.

# %%
gap = results["gap"]
drawing = castx.draw(gap.grids(), "temperature", gap.model)
plt.figure(figsize=(6, 6))
plt.imshow(drawing.pixels)
plt.axis("off")
plt.title(f"{gap.times[-1]:g} s, displacements × {drawing.exaggeration:g}")
plt.show()
