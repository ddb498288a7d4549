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
# # Which stresses does a casting keep?
#
# Hot metal is soft: where it cannot shrink, it yields. The stress of a cold casting is what is
# left of this history. Two examples: a slab whose stress is known exactly, and a ring that shrinks
# onto a steel core. To open this text as a notebook:
# `jupytext --to ipynb residual_stress_notebook.py -o residual_stress.ipynb`.

# %%
from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from scipy.optimize import brentq, fsolve
from scipy.special import erf, erfc

import castx

folder = Path(mkdtemp())

# %% [markdown]
# ## A slab that solidifies from a chilled wall
# Steel at 1550 °C meets a wall of 1362 °C and freezes at 1490 °C. The slab may contract along the
# wall, yet it does not bend. The solid is elastic and perfectly plastic, and its yield stress
# falls to zero at the melting point. J. H. Weiner and B. A. Boley solved this exactly
# (*Elasto-plastic thermal stresses in a solidifying body*, J. Mech. Phys. Solids 11, 1963): over
# $\xi = x/X$, with $X(t)$ the thickness of the shell, the lateral stress $\sigma$ is the same at
# all times.

# %%
# %%capture
castx.run("solidifying_slab.toml", output=folder / "slab")

# %% [markdown]
# ### The exact stress
# The temperature is Neumann's, and the shell contracts by $C \ln X$. The stress of a point that
# has yielded in tension down to $\xi = x_1$ changes from there on elastically,
#
# $$ \sigma = Y(x_1)
#    - \frac{E}{1-\nu}\left[C \ln\frac{\xi}{x_1} + \alpha\,(T(\xi) - T(x_1))\right], $$
#
# until it yields in compression, $\sigma = -Y$, at $x_2$. It leaves the yield stress at $x_1$
# along its tangent, which gives $C$; $x_1$ and $x_2$ follow from $\sigma(x_2) = -Y(x_2)$ and from
# the balance of forces $\int \sigma\,\mathrm{d}\xi = 0$.

# %%
metal = castx.load_case("solidifying_slab.toml").materials["steel"]
wall, melting, initial = 1362.0, metal.solidus, 1550.0
capacity = float(metal.heat_capacity.solid(wall))
diffusivity = float(metal.conductivity.solid(wall)) / (metal.density * capacity)
stiffness = float(metal.young_modulus(wall) / (1 - metal.poisson_ratio(wall)))
expansion, strength = float(metal.expansion(wall)), float(metal.yield_stress(wall))


def heat_balance(n):
    flow = (melting - wall) / erf(n) - (initial - melting) / erfc(n)
    return flow * np.exp(-n * n) - np.sqrt(np.pi) * n * metal.latent_heat / capacity


front_number = brentq(heat_balance, 0.01, 3.0)


def shell(time):
    return 2 * front_number * np.sqrt(diffusivity * time)


def temperature(xi):
    return wall + (melting - wall) * erf(front_number * xi) / erf(front_number)


def yield_stress(xi):
    return strength * (melting - temperature(xi)) / (melting - wall)


def contraction(x1):
    """Return C."""
    slope = np.exp(-((front_number * x1) ** 2)) * 2 * front_number / np.sqrt(np.pi)
    slope *= (melting - wall) / erf(front_number)
    return x1 * slope * (strength / (melting - wall) / stiffness - expansion)


def stress(xi, x1, x2):
    at = np.clip(xi, x2, x1)
    strain = contraction(x1) * np.log(at / x1) + expansion * (temperature(at) - temperature(x1))
    elastic = yield_stress(x1) - stiffness * strain
    solid = np.where(xi > x1, yield_stress(xi), np.where(xi < x2, -yield_stress(xi), elastic))
    return np.where(xi < 1, solid, 0.0)


def conditions(unknown):
    x1, x2 = unknown
    force = np.trapezoid(stress(grid, x1, x2), grid)
    return stress(x2, x1, x2) + yield_stress(x2), force


grid = np.linspace(0.0, 1.0, 20001)
x1, x2 = fsolve(conditions, (0.45, 0.2))

# %% [markdown]
# ### Computed and exact

# %%
slab = castx.Results(folder / "slab")

figure, (left, right) = plt.subplots(1, 2, sharey=True, figsize=(11, 4.8), layout="constrained")
states = {"yields in compression": (0, x2), "elastic": (x2, x1), "yields in tension": (x1, 1)}
for (state, (low, high)), colour in zip(states.items(), ("C0", "w", "C3"), strict=True):
    left.axvspan(low, high, color=colour, alpha=0.12, linewidth=0)
    left.text(0.5 * (low + high), -47, state.replace(" in ", "\nin "), ha="center", va="center")
left.plot(grid, 1e-6 * yield_stress(grid), "k:", linewidth=1, label="±Y")
left.plot(grid, -1e-6 * yield_stress(grid), "k:", linewidth=1)
for index, marker in ((1, "s"), (2, "^"), (4, "o")):
    time = slab.times[index]
    lateral = slab.field("stress", "casting", time)
    xi = lateral.points[lateral.cells].mean(axis=1)[:, 0] / shell(time)
    solid = xi < 1
    found = lateral.values[solid, 1]
    left.plot(xi[solid], 1e-6 * found, marker, fillstyle="none", markersize=5, label=f"{time:g} s")
deviation = np.abs(found - stress(xi[solid], x1, x2)).max() / strength
left.plot(grid, 1e-6 * stress(grid, x1, x2), "k", linewidth=1, label="exact")
left.set(xlim=(0, 1), ylim=(-53, 45), ylabel="lateral stress [MPa]", title="across the shell")
left.set_xlabel("distance from the wall over thickness of the shell, ξ = x/X")
left.legend(loc="upper right")

depth, time = 1.05e-3, slab.probes["time"]
passed = (depth / (2 * front_number * np.array([1, x1, x2]))) ** 2 / diffusivity
right.axvspan(passed[0], passed[1], color="C3", alpha=0.12, linewidth=0)
right.axvspan(passed[2], 10, color="C0", alpha=0.12, linewidth=0)
right.plot(time, 1e-6 * slab.probes["point.stress.yy"], "o", fillstyle="none", markersize=5)
fine = np.linspace(0.01, 10, 500)
right.plot(fine, 1e-6 * stress(depth / shell(fine), x1, x2), "k", linewidth=1)
right.set(xlim=(0, 10), xlabel="time [s]", title=f"over time, {1e3 * depth:g} mm from the wall")
plt.show()

strain = np.interp([1.0, 10.0], time, slab.probes["top.displacement.y"]) / 1e-4
print(f"largest deviation of the stress: {100 * deviation:.1f} % of the yield stress at the wall")
print(f"contraction from 1 to 10 s: {strain[0] - strain[1]:.6f}")
print(f"                     exact: {-contraction(x1) * np.log(10) / 2:.6f}")

# %% [markdown]
# Every layer freezes free of stress onto a shell that is colder. At first it cools, and so
# shrinks, faster than the shell as a whole: it is pulled and yields in tension, easily, being hot
# and soft. The front moves on, the layer cools ever more slowly, but younger ones go on drawing
# the shell together: tension falls, turns into compression, and in the end the layer yields again.
# The skin, which no longer cools at all, is there from the start. So there is compression at the
# chill and tension behind it, and both balance at all times. (A solid plate that is quenched
# begins the other way round, with its skin in tension; here the skin is there before the rest.)
# And just behind the front the metal is pulled where it has next to no strength: that is where hot
# tears begin.
#
# ## A ring that shrinks onto a core
# A ring of AlSi7Mg, 15 mm thick, freezes round a hollow core of hot-work steel and cools with it
# to room temperature. From its solidus at 557 °C on aluminium shrinks by 1.4 %, the core, which is
# at some 400 °C then, by 0.5 %. The rest is strain of the ring. Three laws for the ring:
#
# - `thermo-elasto-viscoplastic` yields, hardens and creeps, all over temperature;
# - `thermo-elasto-plastic` yields and hardens, however slowly or fast;
# - `thermo-elastic` bears everything.

# %%
# %%capture
laws = ("thermo-elasto-viscoplastic", "thermo-elasto-plastic", "thermo-elastic")
for law in laws:
    castx.run("ring_on_core.toml", [f'bodies.0.law="{law}"'], output=folder / law)

# %%
rings = {law: castx.Results(folder / law) for law in laws}
alloy = castx.find_material("AlSi7Mg")

figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.8), layout="constrained")
for law, style in zip(laws, ("C3-", "C0--", "k:"), strict=True):
    found = rings[law].probes
    left.plot(found["time"], 1e-6 * found["seat.contact_pressure"], style, label=law)
    right.plot(found["ring.temperature"], 1e-6 * found["ring.von_mises"], style)
left.set(xlim=(0, 600), ylim=(0, 220), xlabel="time [s]", ylabel="contact pressure [MPa]")
left.set_title("the ring on the core, at half height")
left.legend(loc="center right")
right.set(xlim=(600, 20), ylim=(0, 220), xlabel="temperature [°C]", ylabel="stress [MPa]")
cooling = np.linspace(557, 20, 200)
right.fill_between(cooling, 1e-6 * alloy.description.yield_stress(cooling), color="0.85", zorder=0)
right.text(60, 40, "below the yield stress", ha="right")
right.axvline(alloy.solidus, color="0.5", linewidth=1)
right.text(alloy.solidus - 8, 150, "solidus", rotation=90)
right.set_title("von Mises stress in the middle of the wall")
plt.show()

pressures = {law: 1e-6 * rings[law].probes["seat.contact_pressure"][-1] for law in laws}
for law, pressure in pressures.items():
    print(f"contact pressure at room temperature, {law}: {pressure:.0f} MPa")

# %% [markdown]
# The stress follows the yield stress as the ring cools: the *strength* at each temperature
# decides, hardly the stiffness. While it is hot, a ring that creeps presses harder than one that
# yields at any rate, for it needs time to give way; at room temperature the two are the same.
# Elastic aluminium would press four times as hard, at stresses that the alloy cannot bear: it
# hardens to 180 MPa at most, yield stress and saturation of its table.
#
# ## Hoop stress and plastic strain
# Above in the cold ring and its core, displacements drawn larger than they are. Below across the
# wall at half height: pressing out the core takes off the elastic stress of its pressure (Lamé),
# and the difference is what the free ring would keep.

# %%
law = "thermo-elasto-viscoplastic"
bodies = rings[law].grids()
for grid in bodies.values():
    grid["hoop"] = 1e-6 * grid["stress"][:, 2]  # rr, zz, θθ, rz
    grid["percent"] = 100 * grid["plastic_strain"]
shown = {
    "hoop": ("hoop stress [MPa]", (-130.0, 130.0), "RdBu_r", list(bodies)),
    "percent": ("plastic strain [%]", (0.3, 0.8), "viridis", ["casting"]),
}
figure, axes = plt.subplots(2, 1, figsize=(9, 6), sharex=True, layout="constrained")
for field, panel in zip(shown, axes, strict=True):
    label, limits, colours, coloured = shown[field]
    drawing = castx.draw(
        bodies, field, "axisymmetric", limits=limits, colours=colours, coloured=coloured
    )
    panel.imshow(drawing.pixels, extent=[1e3 * end for end in drawing.extent])
    panel.set_ylabel("z [mm]")
    figure.colorbar(ScalarMappable(Normalize(*limits), colours), ax=panel, label=label)
axes[0].set_title(f"ring and core at room temperature, displacements × {drawing.exaggeration:g}")
axes[1].set_xlabel("r [mm]")
plt.show()

# %%
ring = bodies["casting"]
r, z = ring.cell_centers().points[:, :2].T
inner, outer = 30.0, 45.0
row = z < 1.01 * z.min()
lame = pressures[law] * inner**2 / (outer**2 - inner**2) * (1 + (outer / (1e3 * r)) ** 2)
plt.figure(figsize=(6.5, 4), layout="constrained")
plt.plot(1e3 * r[row], ring["hoop"][row], "C3o-", label="on the core")
plt.plot(1e3 * r[row], lame[row], "k:", label="elastic, of the pressure alone")
plt.plot(1e3 * r[row], (ring["hoop"] - lame)[row], "C2o--", label="left without core")
plt.axhline(0, color="0.5", linewidth=1)
plt.xlabel("r [mm]")
plt.ylabel("hoop stress [MPa]")
plt.legend()
plt.show()

areas = ring.compute_cell_sizes()["Area"]
pull = 1e6 * ring["hoop"] @ areas
push = rings[law].history["casting/core.force.r"][-1] / (2 * np.pi)
print(f"hoop stress, mean: {ring['hoop'] @ areas / areas.sum():.0f} MPa")
print(f"force of hoop stress over that of contact: {pull / push:.3f}")
print(f"plastic strain: {ring['percent'].min():.2f} to {ring['percent'].max():.2f} %")

# %% [markdown]
# ## Which data matter?
# The same ring on a coarse mesh, each time with one property of the alloy 20 % higher: how much
# does the contact pressure change, hot (when the middle of the wall has 400 °C) and cold?


# %%
def seat(name="", least=-273.0, factor=1.2):
    """Return the contact pressure, hot and cold, with a property changed above a temperature."""
    changes = ["geometry.size=5e-3", "time.temperature_change=50"]
    if name:
        table = getattr(alloy.description, name)
        at = np.union1d(table.arguments, [least, least + 1])
        values = np.where(at > least, factor, 1) * table(at)
        rows = np.column_stack([at, values]).tolist()
        changes.append(f'materials.changed={{ extends = "AlSi7Mg", {name} = {rows} }}')
        changes.append('bodies.0.material="changed"')
    ring = castx.Results(castx.run("ring_on_core.toml", changes, output=folder / "data"))
    found = ring.probes
    temperature, pressure = found["ring.temperature"], found["seat.contact_pressure"]
    return np.array([np.interp(-400, -temperature, pressure), pressure[-1]])


# %%
# %%capture
cases = {
    "yield stress": ("yield_stress",),
    "yield stress above 300 °C": ("yield_stress", 300.0),
    "viscosity": ("viscosity",),
    "expansion": ("expansion",),
    "Young's modulus": ("young_modulus",),
}
reference = seat()
effects = {name: 100 * (seat(*change) / reference - 1) for name, change in cases.items()}

# %%
print(f"{'20 % more':26}  at 400 °C    cold")
for name, (hot, cold) in effects.items():
    print(f"{name:26} {hot:+8.1f} % {cold:+7.1f} %")

# %% [markdown]
# ## Flow rules
# How fast the metal flows at an overstress is the `law` of its material. All laws that castx has,
# each with an example of an aluminium alloy at 500 °C: those without a yield stress creep under
# every stress, the others need a yield stress and flow under what exceeds it.

# %%
rates = np.logspace(-8, 0, 81)
fig, ax = plt.subplots(figsize=(7, 4))
for name, rule in castx.flow_rules().items():
    ax.loglog(rates, 1e-6 * rule.example_overstress(rates), label=name)
    print(f"{name:10} {rule.formula:24} {'above a yield stress' if rule.threshold else 'creep'}")
ax.set(xlabel="strain rate [1/s]", ylabel="overstress [MPa]")
ax.legend()
plt.show()

# %% [markdown]
# ## Which law, then?
# **The casting.** For the residual stress of the cold part `thermo-elasto-plastic` is often
# enough: in this ring the cold metal has forgotten what the hot one bore, and the stress is what
# the strength of the last few hundred kelvin allows. Take `thermo-elasto-viscoplastic` where the
# time counts: forces on cores and moulds while the casting is hot (when can it be ejected?), hot
# tears, sand castings that cool for hours, stress relief. It costs no more. The material says how
# it flows: `perzyna` or `bingham` above a yield stress, `norton` (creep) without one.
# `thermo-elastic` is for temperatures, gaps and shrinkage of the free casting only; wherever
# something holds the casting back, its stress means nothing.
#
# **Moulds and cores** may be `thermo-elastic` as long as they stay below their yield stress. Here
# the core bears 130 MPa in compression, its steel yields at 1000 MPa.
#
# **The data.** Yield stress over temperature, first of all, from room temperature to the solidus,
# and for pressures of hot castings also its rate. Then expansion and hardening. Young's modulus
# hardly matters once the metal yields. Mind `castx materials AlSi7Mg`: many tables are
# representative values without established source. A conclusion that hangs on 10 % of a stress
# needs tests of one's own alloy, as it is cast.
