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
# # Which contact method, and what does it cost?
#
# Whether casting and mould touch decides how fast the casting cools. Two surfaces must not pass
# through each other, and there are several ways to see to it. Section 10.1 of M. Chiumenti,
# *Thermo-mechanical contact in casting analysis*, compares them by pressing a soft block onto a
# base that is ten times stiffer, as a hot casting is in its mould. Here are all methods, on that
# benchmark and then on a whole casting:
#
# | method | section | a closed pair of nodes | to be chosen |
# |---|---|---|---|
# | penalty | 7.1 | penetrates by $p/\varepsilon$ | $\varepsilon$ |
# | augmented Lagrangian | 7.2 | the same, then is corrected | $\varepsilon$, corrections |
# | block-iterative | 7.3 | as penalty, the bodies solved in turn | $\varepsilon$, sweeps |
# | multipliers | 8 | does not penetrate, its force is an unknown | nothing |
# | condensed | – | does not penetrate, its gap is an unknown | nothing |
#
# The advice is at the end. To open this text as a notebook:
# `jupytext --to ipynb contact_notebook.py -o contact.ipynb`.

# %%
import time
import tomllib
from itertools import pairwise
from pathlib import Path

from mpi4py import MPI

import matplotlib.pyplot as plt
import numpy as np

import castx

# %% [markdown]
# ## Two blocks
# The upper block is 30 mm high, E = 1 GPa, and yields at 7 MPa; the base is 20 mm high, twice as
# wide, E = 10 GPa. The top is pushed down by 0.2 mm, where all stays elastic, or by 1 mm, where the
# block yields. The mesh of the paper is fine or coarse, so is ours: 1.25 or 5 mm. Forces are
# balanced to 10⁻⁶, so that what differs is due to the methods; castx by default goes to the 0.1 %
# of the paper.

# %%
HIGH, BASE_HIGH, YOUNG, POISSON = 0.03, 0.02, 1e9, 0.3
COARSE, FINE, FINEST = 5e-3, 1.25e-3, 0.625e-3
ELASTIC, YIELDING = 2e-4, 1e-3
PENALTIES = np.geomspace(1e11, 1e16, 11)


def blocks(size, push, model, tolerance, linear, contact):
    """Return the mechanics of the soft block on its base."""
    depth = [0.01] if model == "3d" else []
    common = {"poisson_ratio": POISSON, "density": 1.0, "expansion": 0.0, "stress_free": 20.0}
    data = {
        "geometry": {
            "generator": "stacked_blocks", "model": model, "size": size, "symmetry": True,
            "upper": [0.02, HIGH, *depth], "base": [0.04, BASE_HIGH, *(2 * d for d in depth)],
        },
        "materials": {
            "soft": common | {"young_modulus": YOUNG, "yield_stress": 7e6, "hardening": 5e7},
            "stiff": common | {"young_modulus": 10 * YOUNG},
        },
        "bodies": [
            {
                "name": "upper", "material": "soft", "temperature": 20.0,
                "law": "thermo-elastic" if push == ELASTIC else "thermo-elasto-plastic",
            },
            {"name": "base", "material": "stiff", "temperature": 20.0},
        ],
        "interfaces": [{"bodies": ["upper", "base"], "contact": contact}],
        "boundaries": [
            {"on": "base/bottom", "displacement": {"normal": 0.0}},
            {"on": "upper/top", "displacement": {"normal": -push}},
        ],
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": linear, "mechanics_tolerance": tolerance},
        "time": {"end": 1.0, "fixed_step": 1.0},
    }  # fmt: skip
    simulation = castx.Simulation.from_case(castx.load_case(data), MPI.COMM_WORLD)
    return simulation.problem.mechanics


def solve(size, push=ELASTIC, model="plane-strain", tolerance=1e-6, linear="direct", **contact):
    """Return reaction [N/m], penetration [m], CPU seconds and the report of one solution."""
    mechanics = blocks(size, push, model, tolerance, linear, contact)
    begin = time.process_time()
    report = mechanics.equilibrium.solve(1.0)
    cpu = time.process_time() - begin
    state = mechanics.contact_states()[0]
    reaction = np.linalg.norm(state.force.sum(axis=0))
    penetration = np.maximum(-state.gap, 0.0).max()
    mechanics.destroy()
    return reaction, penetration, cpu, report


# %% [markdown]
# ## Reaction and penetration against the penalty
# As Fig. 11 and 12a of the paper. A penalty that is too soft lets the block sink into the base, and
# the reaction is too small. The augmented Lagrangian method, here with three corrections, makes up
# for it; below 10⁻⁵ µm its penetration is what the balance of forces leaves.

# %%
exact = {size: solve(size, method="condensed")[0] for size in (COARSE, FINE)}
SOFT = {
    "penalty": {"method": "penalty"},
    "augmented Lagrangian, 3 times": {"method": "augmented-lagrangian", "augmentations": 3},
}
curves = {
    (name, size): [solve(size, penalty=e, **settings) for e in PENALTIES]
    for name, settings in SOFT.items()
    for size in (COARSE, FINE)
}

figure, axes = plt.subplots(2, 2, sharex=True, sharey="row", figsize=(9, 6), layout="constrained")
for column, (size, title) in enumerate(((FINE, "fine mesh"), (COARSE, "coarse mesh"))):
    upper, lower = axes[:, column]
    upper.axhline(exact[size] / 1e3, color="k", lw=1.0, label="condensed (exact)")
    for k, name in enumerate(SOFT):
        results = curves[name, size]
        upper.semilogx(PENALTIES, [r[0] / 1e3 for r in results], f"C{k}o-", ms=4, label=name)
        lower.loglog(PENALTIES, [r[1] * 1e6 for r in results], f"C{k}o-", ms=4)
    lower.set_ylim(1e-5, 1e2)
    upper.set_title(title)
    lower.set_xlabel("penalty [Pa/m]")
axes[0, 0].set_ylabel("reaction [kN/m]")
axes[1, 0].set_ylabel("penetration [µm]")
axes[0, 1].legend(loc="lower right")
plt.show()

# %% [markdown]
# How large must the penalty be? The blocks are springs in series with it. Per area their stiffness
# is $k_i = E_i/(1-\nu^2)H_i$, together $1/k = 1/k_1 + 1/k_2$, and the reaction falls short by
# $k/(k+\varepsilon)$. The softer body decides: one per cent needs $\varepsilon = 100\,k$, whatever
# the mesh. In the paper a finer mesh makes do with less; there the penalty is a stiffness per node,
# here it is one per area, and both meshes give the same curve.

# %%
stiffnesses = [E / (1 - POISSON**2) / H for E, H in ((YOUNG, HIGH), (10 * YOUNG, BASE_HIGH))]
both = 1 / sum(1 / k for k in stiffnesses)
print(f"stiffness per area: blocks {stiffnesses[0]:.2e}, {stiffnesses[1]:.2e}, k {both:.2e} Pa/m")
print("penalty [Pa/m]   reaction short by   k/(k+ε)      coarse mesh")
for place in range(0, len(PENALTIES), 2):
    penalty = PENALTIES[place]
    short = [1 - curves["penalty", size][place][0] / exact[size] for size in (FINE, COARSE)]
    print(f"{penalty:12.0e} {short[0]:18.2e} {both / (both + penalty):13.2e} {short[1]:13.2e}")
multipliers, condensed = (
    solve(FINE, tolerance=1e-12, method=method)[0] for method in ("multipliers", "condensed")
)
print(f"multipliers and condensed differ by {abs(multipliers / condensed - 1):.1e}")

# %% [markdown]
# ## How Newton's method ends
# Table 1 of the paper: residuals over the first one times 1000, for the block that yields, with a
# penalty of 10¹² Pa/m. Each improved pressure (NEW AUGM) and each sweep
# over the bodies (BLOCK-ITER) upsets the balance, and Newton's method starts from there. Within a
# solution each residual is about the square of the one before. The block-iterative method is
# stopped after four sweeps; "both" is what is then left of the balance of the two bodies.

# %%
HISTORIES = {
    "Penalty": {"method": "penalty"},
    "Augmented Lagrangian": {"method": "augmented-lagrangian", "augmentations": 2},
    "Block-iterative": {"method": "block-iterative", "block_iterations": 4},
}


def history(report):
    """Return a column of the table."""
    ratios = [1e3 * residual / report.residuals[0] for residual in report.residuals]
    lines, block = [], 0
    for place, ratio in enumerate(ratios):
        if place in report.augmentations:
            lines.append("NEW AUGM")
        if place in report.sweeps:
            lines.extend(["BLOCK-ITER"] if place else [])
            block = 0
        elif place and report.sweeps and ratio > ratios[place - 1]:
            block += 1  # the next body begins with what the last one has left to it
        what = ("upper", "base", "both")[block] if report.sweeps else ""
        lines.append(f"{'IT.=' + str(place + 1):7s} {ratio:.6E} {what}")
    return lines


reports = {
    name: solve(COARSE, YIELDING, penalty=1e12, **settings)[3]
    for name, settings in HISTORIES.items()
}
columns = [history(report) for report in reports.values()]
print("".join(f"{name:30s}" for name in reports))
for row in range(max(len(column) for column in columns)):
    cells = [column[row] if row < len(column) else "" for column in columns]
    print("".join(f"{cell:30s}" for cell in cells).rstrip())
falls = [np.log(b / a) for a, b in pairwise(reports["Penalty"].residuals)]
print(f"\norder of convergence before the end: {falls[2] / falls[1]:.2f}")

# %% [markdown]
# ## Sweeps of the block-iterative method
# Each sweep over the bodies leaves the share
# $\frac{\varepsilon}{\varepsilon+k_1}\,\frac{\varepsilon}{\varepsilon+k_2}$ of the error: a sweep
# hands forces over only as far as the penalty gives way. So the better the penalty, the worse the
# method, which is the drawback that the paper names. The dashed lines are this formula; it is for
# blocks of one width, and the base is wider, so a little stiffer.

# %%
def as_power(penalty):
    """Return a power of ten for a legend."""
    return f"$10^{{{np.log10(penalty):.0f}}}$ Pa/m"


figure, axis = plt.subplots(figsize=(7, 4), layout="constrained")
contractions = {}
for k, penalty in enumerate((1e11, 1e12, 1e13)):
    report = solve(
        FINE, method="block-iterative", penalty=penalty, block_iterations=25
    )[3]
    ends = [report.residuals[start - 1] for start in (*report.sweeps[1:], 0)]
    contractions[penalty] = ends[-1] / ends[-2]
    theory = np.prod([penalty / (penalty + stiffness) for stiffness in stiffnesses])
    sweeps = np.arange(1, len(ends) + 1)
    axis.semilogy(sweeps, np.array(ends) / ends[0], f"C{k}o-", ms=4, label=as_power(penalty))
    axis.semilogy(sweeps, theory ** (sweeps - 1.0), f"C{k}--", lw=1.0)
    measured = contractions[penalty]
    print(f"{penalty:.0e} Pa/m: each sweep leaves {measured:.3f}, by the formula {theory:.3f}")
axis.set_ylim(1e-6, 2)
axis.set_xlabel("sweep over both bodies")
axis.set_ylabel("residual over that of the first sweep")
axis.legend(title="penalty")
plt.show()

# %% [markdown]
# The paper writes the system with the nodes of the interface as a third block. Read literally, the
# errors travel through the interface node by node: sweeps hardly depend on the penalty, but they
# double with each refinement. castx offers both, `blocks = "bodies"` and `"interface"`.

# %%
print("sweeps to 0.1 %            bodies in turn    interface as third block")
counts = {}
for size in (COARSE, COARSE / 2, COARSE / 4):
    for penalty in (1e11, 1e13):
        for form in ("bodies", "interface"):
            report = solve(
                size, tolerance=1e-3, method="block-iterative", penalty=penalty, blocks=form,
                block_iterations=400,
            )[3]  # fmt: skip
            counts[size, penalty, form] = len(report.sweeps)
        row = [counts[size, penalty, form] for form in ("bodies", "interface")]
        print(f"{size * 1e3:5.2f} mm  {penalty:.0e} Pa/m {row[0]:16d} {row[1]:20d}")

# %% [markdown]
# ## CPU time
# As Fig. 12b, for the block that yields on a mesh of 0.6 mm, with a direct solver. The augmented
# Lagrangian method, corrected until nothing penetrates, solves once more for each correction and is
# the dearer the softer the penalty; the block-iterative method is the dearer the harder. Hollow:
# stopped after 50 sweeps, before the forces balance. The exact methods cost what the penalty costs.

# %%
COSTS = {
    "penalty": {"method": "penalty"},
    "augmented Lagrangian": {"method": "augmented-lagrangian"},
    "block-iterative": {"method": "block-iterative", "block_iterations": 50},
}
figure, axis = plt.subplots(figsize=(7, 4.5), layout="constrained")
unit = min(solve(FINEST, YIELDING, method="condensed")[2] for _ in range(3))
ratios = {}
for k, (name, settings) in enumerate(COSTS.items()):
    found = [solve(FINEST, YIELDING, penalty=e, **settings)[2:] for e in PENALTIES[::2]]
    ratios[name] = [cpu / unit for cpu, _ in found]
    axis.loglog(PENALTIES[::2], ratios[name], f"C{k}-", label=name)
    for penalty, ratio, (_, report) in zip(PENALTIES[::2], ratios[name], found, strict=True):
        axis.plot(penalty, ratio, f"C{k}o", mfc=f"C{k}" if report.balanced else "w")
ratios["multipliers"] = [solve(FINEST, YIELDING, method="multipliers")[2] / unit]
axis.axhline(ratios["multipliers"][0], color="C3", ls="--", zorder=3, label="multipliers")
axis.axhline(1.0, color="C4", label="condensed")
axis.set_yticks(ticks := (0.5, 1, 2, 5, 10, 20), ticks)
axis.minorticks_off()
axis.set_xlabel("penalty [Pa/m]")
axis.set_ylabel("CPU time over that of condensed")
axis.legend()
plt.show()
print(f"condensed costs {unit:.2f} s")
for name, values in ratios.items():
    print(f"{name} costs {min(values):.1f} to {max(values):.1f} times that")

# %% [markdown]
# ## Large meshes: the iterative solver
# Meshes in space are too large for a direct solver. castx then takes multigrid by bodies, and a
# penalty spoils the condition of the matrix: the iterations of a linear solve rise with it. That is
# the locking of the paper. From 10¹⁵ Pa/m on the nodes of the pairs are so much stiffer than the
# rest of their body that castx factorises them apart, as it does a thin skin on a melt; while they
# are few, that costs little. The gaps of the condensed method leave the matrix as it is; on ever
# finer meshes of a casting with a liquid core, half of whose pairs are open, `bench/contact.py`
# counts 22, 24 and 31 iterations at most, for 13 000, 38 000 and 124 000 tetrahedra.

# %%

def worst(**contact):
    """Return the iterations of the worst linear solve in space."""
    report = solve(2.5e-3, model="3d", tolerance=1e-3, linear="iterative", **contact)[3]
    return max(report.linear_solves)


most = {e: worst(method="penalty", penalty=e) for e in PENALTIES[::2]}
flat = {method: worst(method=method) for method in ("multipliers", "condensed")}
figure, axis = plt.subplots(figsize=(7, 4), layout="constrained")
axis.semilogx(list(most), list(most.values()), "C0o-", label="penalty")
for k, (method, count) in enumerate(flat.items()):
    axis.axhline(count, color=f"C{k + 3}", ls=("--", "-")[k], label=method)
axis.set_ylim(0, 50)
axis.set_xlabel("penalty [Pa/m]")
axis.set_ylabel("iterations of a linear solve")
axis.legend(loc="upper left")
plt.show()
print(f"iterations with a penalty: {list(most.values())}")
print(f"iterations of multipliers and condensed: {list(flat.values())}")

# %% [markdown]
# ## A whole casting
# The cylinder of `cylinder.toml`, here in a mould with a floor on which it stands: 90 s of
# solidification and cooling on a mesh of 5 mm. After half a second the casting touches its mould
# only at the floor, by its weight of 7.5 N; yet how deep it sinks is in all gaps of the floor, and
# the gaps are in the temperatures.
#
# Multipliers give the temperatures of the condensed method to the last digits, the others do so as
# closely as they keep the bodies apart. A penalty of 10¹¹ Pa/m is less than the stiffness of the
# casting: it sinks into the floor, the hot wall into the melt, and the temperatures are wrong by
# some kelvins. Nine of ten gaps are wrong by no more than it sinks, and single ones, which open a
# step earlier or later, by more. A wall that pulls stretches its pairs too, by as much as the same
# pressure sinks them. The block-iterative method is left out: it creeps towards the
# balance of the penalty, to the same numbers in fifty times as many iterations.

# %%
METHODS = {
    name: {"method": name}
    for name, method in castx.contact_methods().items()
    if method.fallback and name != "block-iterative"
} | {
    "penalty, 1e13 Pa/m": {"method": "penalty", "penalty": 1e13},
    "penalty, 1e11 Pa/m": {"method": "penalty", "penalty": 1e11},
    "blocks as preconditioner": {"method": "block-iterative", "block_solver": "preconditioner"},
}


def run(contact):
    """Return temperatures and gaps every 5 s, deepest penetration, CPU seconds, iterations."""
    data = tomllib.loads(Path("cylinder.toml").read_text())
    data["geometry"] |= {"floor": 0.02, "size": 5e-3}
    data["loads"] = {"gravity": [0, -9.81]}
    data["boundaries"] = [{"on": "mould/base", "displacement": {"normal": 0}}]
    data["interfaces"][0]["contact"] = contact
    data["time"] = {"end": 90.0, "fixed_step": 1.0}  # the same steps for all
    del data["probes"]
    data["bodies"][0]["law"] = "thermo-elastic"  # what differs is the contact alone
    begin, iterations, deepest = time.process_time(), 0, 0.0
    temperatures, gaps = [], []
    simulation = castx.Simulation.from_case(castx.load_case(data), MPI.COMM_WORLD)
    for state in simulation:
        iterations += state.counters.mechanics_iterations
        gap = state.paired("casting/mould", "gap")
        deepest = max(deepest, -gap.min())
        if round(state.time / 5.0, 9).is_integer():
            nodal = [state.nodal(body, "temperature") for body in ("casting", "mould")]
            temperatures.append(np.concatenate(nodal))
            gaps.append(gap.copy())
    cpu = time.process_time() - begin
    return np.array(temperatures), np.array(gaps), deepest, cpu, state.step, iterations


runs = {name: run(contact) for name, contact in METHODS.items()}
temperature, gap = runs["condensed"][:2]
print("                               differs by at most   9 of 10  penetrates   CPU steps Newton")
print("method                           [K]        [µm]      [µm]        [µm]    [s]         its")
for name, (other, gaps, deepest, *cost) in runs.items():
    kelvin, microns = np.abs(other - temperature).max(), 1e6 * np.abs(gaps - gap)
    print(
        f"{name:26s} {kelvin:11.3f} {microns.max():10.3f} {np.quantile(microns, 0.9):9.3f} "
        f"{1e6 * deepest:11.4f} {cost[0]:6.1f} {cost[1]:5d} {cost[2]:6d}"
    )

# %% [markdown]
# ## Advice
# - **Leave `contact.method` at `"condensed"`.** It is exact, has nothing to tune, costs no more
#   than a penalty, and its linear solver does not feel the contact, on any mesh. `"multipliers"`
#   give the same numbers: a check.
# - **A penalty** is for comparing with codes that have nothing else. Leave it at `"auto"`, which
#   follows the stiffness of the freezing casting. If you must give a number, take a hundred to a
#   thousand times $E/H$ of the softer body, its Young's modulus over its thickness, and look at the
#   deepest penetration: it must be small beside the gaps that control the heat, a micrometre or so.
# - **More is not better.** With a direct solver a penalty may be very large, with the iterative one
#   the iterations tell: at some thousand times $E/H$ they are three times as many.
# - **The augmented Lagrangian method** repairs a penalty that is too soft, at the price of more
#   solutions. Take it where the penalty that you need costs the iterative solver more. Its
#   forces are as good as the balance, so lower `solver.mechanics_tolerance` if they matter.
# - **The block-iterative method** moves all bodies closer to their balance even when it is stopped,
#   so a run goes on where others fail; as `fallback` it may take over for a step. Do not trust its
#   forces then: `history.csv` and the log show that it was stopped. As `block_solver =
#   "preconditioner"` one sweep stands for the inverse of the matrix, and it converges.
