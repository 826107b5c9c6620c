"""Models for the hydraulics tests: bore and annulus of 2000 m of drill pipe in an open hole, together or
alone; and the wall friction of a Herschel-Bulkley mud, written independently. SI."""

from __future__ import annotations

import numpy as np

from drillpetsc import Case
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.model.drilling_model import DrillingModel, build_model
from tests.helpers.motion import fixed, integrate

OUTER, INNER, HOLE, LENGTH = 0.127, 0.1086, 0.2159, 2000.0  # [m]
DENSITY, GRAVITY, NOZZLE, COEFFICIENT = 1200.0, 9.81, 380e-6, 0.95
YIELD, CONSISTENCY, INDEX = 3.0, 0.3, 0.75
BORE, SOLID, OPEN = (np.pi / 4 * a for a in (INNER**2, OUTER**2, HOLE**2 - OUTER**2))  # [m2]
MUD = {
    "density": DENSITY,
    "rheology": {
        "model": "herschel_bulkley",
        "law": "blend",  # whose formula is that of wall_stress
        "yield_stress": YIELD,
        "consistency": CONSISTENCY,
        "index": INDEX,
    },
}
INVISCID = {"density": DENSITY, "rheology": {"model": "newtonian", "viscosity": 0.0}}
RIGID = {"bulk_modulus": 1e14, "elastic_walls": False}


def wall_stress(speed: float, density: float, diameter: float, slot: bool) -> float:
    """Blend of the type of API RP 13D (manual: sec-mud-blend), written independently; shear rates are rounded
    below 1 1/s."""
    a, n = float(slot), INDEX
    rate = 8 * ((3 - a) * n + 1) / ((4 - a) * n) * (1 + a / 2) * speed / diameter
    smooth = np.sqrt(rate**2 + 1.0)
    laminar = (((4 - a) / (3 - a)) ** n * YIELD / smooth + CONSISTENCY * smooth ** (n - 1)) * rate
    reynolds = 8 * density * speed**2 / abs(laminar)
    f_lam, f_tr = 16 / reynolds, 16 * reynolds / (3470 - 1370 * n) ** 2
    f_tu = (np.log10(n) + 3.93) / 50 / reynolds ** ((1.75 - np.log10(n)) / 7)
    return float(laminar * (f_lam**12 + (f_tr**-8 + f_tu**-8) ** -1.5) ** (1 / 12) / f_lam)


def friction(flow: float, area: float, diameter: float, slot: bool, density: float = DENSITY) -> float:
    """Pressure loss per length [Pa/m] of a flow rate at zero pressure [m3/s] in mud of ``density``."""
    return 4 / diameter * wall_stress(flow * DENSITY / density / area, density, diameter, slot)


def string(length: float = LENGTH, elements: int = 100, **bit) -> list[dict]:
    """Drill pipe, optionally with a bit of half a metre below it."""
    pipe = {"kind": "pipe", "length": length, "od": OUTER, "id": INNER, "element_length": length / elements}
    return [pipe, {"kind": "bit", "length": 0.5, "od": HOLE, "mass": 60.0, **bit}] if bit else [pipe]


def hole(depth: float, **section) -> dict:
    survey = {"md": [0.0, depth], "inclination": [0.0, 0.0], "azimuth": [0.0, 0.0]}
    return {
        "survey": survey,
        "sections": [{"to": depth, "kind": "open_hole", "diameter": HOLE, "friction": 0.3, **section}],
    }


def loop(fluid: dict, elements: int = 100, length: float = LENGTH, **case) -> DrillingModel:
    """Fixed string with a bit half a metre above the bottom, bore and annulus, at rest."""
    model = {
        "well": hole(length + 0.5),
        "string": string(length, elements, nozzle_area=NOZZLE),
        "hold_string": True,
        "bottom": "bit",
        "gravity": GRAVITY,
        "fluid": {**MUD, **fluid},
    }
    return build_model(Case(**{**model, **case}))


def bore(fluid: dict, elements: int, length: float = LENGTH, plugged: bool = False, **case) -> DrillingModel:
    """Fixed string in free space without gravity: its bore alone, open or plugged at its lower end."""
    model = {
        "string": string(length, elements),
        "hold_string": True,
        "bottom": {"kind": "free", "plugged": plugged},
        "gravity": 0.0,
        "fluid": {**INVISCID, **fluid},
    }
    return build_model(Case(**{**model, **case}))


def annulus(fluid: dict, elements: int, length: float = LENGTH, **section) -> DrillingModel:
    """Fixed, plugged and empty string without gravity: the annulus alone, closed below the string."""
    model = {
        "well": hole(length, **section),
        "string": string(length, elements),
        "hold_string": True,
        "bottom": {"kind": "free", "plugged": True},
        "gravity": 0.0,
        "fluid": {**INVISCID, "bit_volume": 0.0, **fluid},
    }
    return build_model(Case(**model))


def started(model: DrillingModel) -> DrillingModel:
    """The model in its steady state, ready to run."""
    find_equilibrium(model)
    release(model)
    move_rigidly(model)
    return model


def pressures(model: DrillingModel, component: str) -> np.ndarray:
    """(n+1,) [Pa]."""
    return model.system.field(f"{component}.pressure")[:, 0].copy()


def flows(model: DrillingModel, component: str) -> np.ndarray:
    """(n,) [m3/s]."""
    return model.system.field(f"{component}.flow")[1:, 0].copy()


def history(
    model: DrillingModel, end: float, step: float, component: str = "bore", **options
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (k,), pressures (k, n+1) and flow rates (k, n) of a run in steps of one length from the steady
    state, that state included."""
    started(model)
    rows = [(0.0, pressures(model, component), flows(model, component))]
    integrate(
        model.system,
        end,
        fixed(step, q_snes_stol=1e-13, **options),
        breaks=model.breaks,
        call=lambda t, dt: rows.append((t, pressures(model, component), flows(model, component))),
    )
    t, p, q = zip(*rows, strict=True)
    return np.array(t), np.array(p), np.array(q)
