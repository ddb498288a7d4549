"""Content of a case file that is right, for tests to spoil."""

import tomllib
from copy import deepcopy
from typing import Any

CYLINDER = """
name = "aluminium cylinder in a steel mould"

[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
radius = "30 mm"
height = "100 mm"
wall = "25 mm"
size = "1.5 mm"

[materials.aluminium]
density = 2700
heat_capacity = { solid = 1080, liquid = 1050 }
conductivity = { solid = [[20, 237], [660, 210]], liquid = 95 }
latent_heat = 397e3
solidus = 660
liquidus = 660
solid_fraction = "linear"
young_modulus = [[20, 70e9], [660, 10e9]]
poisson_ratio = 0.33
expansion = 2.4e-5
stress_free = 660
solidification_shrinkage = 0.0
hardening = 0
liquid = { model = "viscous", viscosity = 1e6, coherency = 0.7 }

[materials.steel]
density = "7.8 g/cm^3"
heat_capacity = 460
conductivity = 25
young_modulus = "210 GPa"
poisson_ratio = 0.3
expansion = "12 um/m/K"

[[bodies]]
name = "casting"
material = "aluminium"
temperature = 670
law = "thermo-elastic"
formulation = "mixed"
stabilisation = "osgs"
[[bodies]]
name = "mould"
material = "steel"
temperature = "473.15 K"
formulation = "displacement"

[[interfaces]]
bodies = ["casting", "mould"]
contact = { method = "condensed" }
heat = { closed = 2300, gas_conductivity = 0.05, law = "limited" }

[[boundaries]]
on = "mould/outside"
heat = { type = "insulated" }
[[boundaries]]
on = "mould/base"
displacement = { normal = 0 }

[loads]
gravity = [0, 0, -9.81]
[support]
in_gate = []
mode = "automatic"

[time]
end = "90 s"
first_step = "0.05 s"
largest_step = "2 s"
smallest_step = "1e-4 s"
temperature_change = 20

[coupling]
scheme = "iterated"
tolerance = 1e-3
[solver]
linear = "automatic"
heat = {}
mechanics = {}
contact = {}

[output]
folder = "results/cylinder"
every = "5 s"
fields = ["temperature", "solid_fraction", "displacement", "stress", "von_mises", "gap"]
[[probes]]
name = "centre"
body = "casting"
at = [0, "50 mm"]
quantities = ["temperature", "displacement"]
[[probes]]
name = "gap_mid"
interface = "casting/mould"
at = ["30 mm", "50 mm"]
quantities = ["gap", "contact_pressure", "heat_transfer_coefficient"]
"""

REMOVED = object()


def cylinder(**changes: Any) -> dict[str, Any]:
    """Return the case of the cylinder with some values replaced or `REMOVED`.

    Args:
        changes: by path, with double underscores between keys and indices.
    """
    data: Any = deepcopy(tomllib.loads(CYLINDER))
    for path, value in changes.items():
        *above, last = (int(key) if key.isdecimal() else key for key in path.split("__"))
        place = data
        for key in above:
            place = place.setdefault(key, {}) if isinstance(place, dict) else place[key]
        if value is REMOVED:
            del place[last]
        else:
            place[last] = value
    return data
