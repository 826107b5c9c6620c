"""Rheology as in the mud report: dial readings, plastic viscosity and yield point, n and K.

The result is the constants of a model; the readings are kept for reports. A reading refers to a rotational
viscometer with the usual bob (R1-B1-F1): 1 degree is 0.5107 Pa, 1 rpm is 1.7023 1/s.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from drillpetsc.case.key_paths import refuse
from drillpetsc.case.quantities import InSI, Quantity
from drillpetsc.unit_tables import FIELD

DEGREE, RPM = 0.5107, 1.7023  # stress of a dial degree [Pa]; shear rate of a turn per minute [1/s]
POUND_PER_100_FT2 = FIELD["Pa"]["lbf/100ft^2"]  # [Pa]
LARGEST_READING, LARGEST_SPEED = 1000.0, 1000.0  # [deg], [rpm]
INDICES = (0.05, 1.5)  # flow indices that a fit may find
SHORT = {"pv", "yp", "n", "k", "ty"}
FITTED = {
    "newtonian": ("viscosity",),
    "bingham": ("yield_stress", "plastic_viscosity"),
    "power_law": ("consistency", "index"),
    "herschel_bulkley": ("yield_stress", "consistency", "index"),
}
_FORMS = "{pv, yp} (or {plastic_viscosity, yield_point}), {n, k} or {ty, n, k}"


def standard(value: Any) -> Any:
    """A rheology in the keys of its model; anything that is not written as in a mud report is returned unchanged."""
    if not isinstance(value, Mapping):
        return value
    value = dict(value)
    if "yield_point" in value:  # the long words of pv and yp
        for long, short in (("plastic_viscosity", "pv"), ("yield_point", "yp")):
            if long in value and short in value:
                raise refuse(short, got=value[short], want=f"{long} or {short}, not both")
        value = {
            {"plastic_viscosity": "pv", "yield_point": "yp"}.get(key, key): part
            for key, part in value.items()
        }
    if SHORT & value.keys():
        return _from_short(value)
    constants = {key for keys in FITTED.values() for key in keys}
    if "dial" not in value:
        return value
    return value | {"dial": readings_of(value["dial"])} if constants & value.keys() else _from_dial(value)


def _from_short(value: Mapping[str, Any]) -> dict[str, Any]:
    """{pv, yp}, {n, k} or {ty, n, k} as bingham, power_law or herschel_bulkley."""
    given = SHORT & value.keys()
    models = {
        frozenset({"pv", "yp"}): "bingham",
        frozenset({"n", "k"}): "power_law",
        frozenset({"ty", "n", "k"}): "herschel_bulkley",
    }
    model = models.get(frozenset(given))
    if model is None:
        raise refuse(sorted(given)[0], got=", ".join(sorted(given)), want=f"together: {_FORMS}")
    if value.get("model", model) != model:
        raise refuse("model", got=value["model"], want=f"{model}, which {', '.join(sorted(given))} describe")
    quantities = {
        "pv": ("plastic_viscosity", Quantity("Pa s", above=0, at_most=1e3)),
        "yp": ("yield_stress", Quantity("Pa", at_least=0, at_most=1e4, kind="yield_point")),
        "ty": ("yield_stress", Quantity("Pa", at_least=0, at_most=1e4, kind="yield_point")),
        "k": ("consistency", Quantity("Pa s^n", above=0, at_most=1e3)),
        "n": ("index", Quantity("", above=0, at_most=2)),
    }
    out = {key: part for key, part in value.items() if key not in SHORT} | {"model": model}
    for key in given:
        name, quantity = quantities[key]
        out[name] = InSI(quantity.read(value[key], key))
    return out


# ---------------------------------------------------------------------- dial readings
def readings_of(value: Any) -> dict[str, float]:
    """Readings [deg] by speed [rpm, as text], fastest first; refuses what no viscometer shows."""
    if not isinstance(value, Mapping) or len(value) < 2:
        raise refuse("dial", got=value, want="two readings or more by rpm: {600: 64, 300: 41}")
    found: dict[float, float] = {}
    for key, reading in value.items():
        try:
            speed = float(str(key))
        except ValueError:
            speed = math.nan
        if not 0 < speed <= LARGEST_SPEED or speed in found:
            raise refuse(
                "dial", key, got=key, want=f"each speed once, in rpm, above 0 and at most {LARGEST_SPEED:g}"
            )
        found[speed] = Quantity("", above=0, at_most=LARGEST_READING).read(reading, "dial", key)
    speeds = sorted(found, reverse=True)
    for fast, slow in zip(speeds, speeds[1:], strict=False):
        if found[fast] < found[slow]:
            got = f"{found[fast]:g} at {fast:g} rpm, {found[slow]:g} at {slow:g} rpm"
            raise refuse("dial", got=got, want="readings that do not fall as the speed rises", hint=got)
    return {f"{speed:g}": found[speed] for speed in speeds}


def _from_dial(value: Mapping[str, Any]) -> dict[str, Any]:
    dial = readings_of(value["dial"])
    fit = value.get("fit", "api" if len(dial) == 2 or value.get("law") == "api" else "least_squares")
    if fit not in ("api", "least_squares"):
        raise refuse("fit", got=fit, want="one of api, least_squares")
    yields = fit == "least_squares" or {"6", "3"} <= dial.keys()
    usual = "power_law" if len(dial) == 2 or value.get("law") == "api" or not yields else "herschel_bulkley"
    model = value.get("model", usual)
    if model not in FITTED:
        raise refuse("model", got=model, want=f"one of {', '.join(FITTED)} with dial readings")
    if model == "herschel_bulkley" and len(dial) < 3:
        raise refuse("dial", got=f"{len(dial)} readings", want="at least 3 readings for herschel_bulkley")
    constants = by_rules(model, dial) if fit == "api" else least_squares(model, dial)
    out = {key: part for key, part in value.items() if key not in ("dial", "fit")}
    numbers = dict(zip(FITTED[model], map(InSI, constants), strict=True))
    return out | {"model": model, "dial": dial, "fit": fit} | numbers


def _needed(dial: Mapping[str, float], *speeds: str) -> list[float]:
    missing = [speed for speed in speeds if speed not in dial]
    if missing:
        want = f"readings at {', '.join(speeds)} rpm for fit: api"
        raise refuse("dial", got=", ".join(dial), want=want, hint="or fit: least_squares")
    return [dial[speed] for speed in speeds]


def by_rules(model: str, dial: Mapping[str, float]) -> tuple[float, ...]:
    """Constants by the rules of API RP 13D (third edition 1995, fifth edition 2006 for the yield stress).

    power_law: n = 3.32 log10(R600/R300), K = 5.11 R600/1022^n [dyn s^n/cm2].
    bingham: PV = R600 - R300 [cP], YP = R300 - PV [lbf/100 ft2].
    herschel_bulkley: tau_y = 2 R3 - R6, n = 3.32 log10((R600 - tau_y)/(R300 - tau_y)), K = (R300 - tau_y)/511^n
    [lbf s^n/100 ft2].
    """
    if len(dial) == 2 and set(dial) != {"600", "300"}:
        return least_squares(model, dial)
    if model == "newtonian":
        return least_squares(model, dial)
    r600, r300 = _needed(dial, "600", "300")
    if model == "bingham":
        plastic = r600 - r300
        if not 0 < plastic <= r300:
            raise refuse("dial", got=f"{r600:g} and {r300:g}", want="R300 < R600 <= 2 R300 for bingham")
        return (r300 - plastic) * POUND_PER_100_FT2, plastic * 1e-3
    stress = 0.0
    if model == "herschel_bulkley":
        r6, r3 = _needed(dial, "6", "3")
        stress = 2 * r3 - r6
        if not 0 <= stress < r300:
            got = f"2 x {r3:g} - {r6:g} = {stress:g}"
            raise refuse("dial", got=got, want="2 R3 - R6 from 0 to below R300", hint="or fit: least_squares")
    index = 3.32 * math.log10((r600 - stress) / (r300 - stress))
    if not INDICES[0] <= index <= INDICES[1]:
        raise refuse(
            "dial",
            got=f"{r600:g} and {r300:g}",
            want=f"readings that give a flow index of {INDICES[0]} to {INDICES[1]}",
        )
    if model == "power_law":
        return 0.511 * r600 / 1022**index, index
    return stress * POUND_PER_100_FT2, (r300 - stress) / 511**index * POUND_PER_100_FT2, index


def api_annulus(dial: Mapping[str, float]) -> tuple[float, float] | None:
    """(K [Pa s^n], n) of a power law in the annulus from the readings at 100 and 3 rpm; None without them.

    API RP 13D (third edition, 1995): n = 0.657 log10(R100/R3), K = 5.11 R100/170.2^n [dyn s^n/cm2].
    """
    if not {"100", "3"} <= dial.keys():
        return None
    index = 0.657 * math.log10(dial["100"] / dial["3"])
    return (0.511 * dial["100"] / 170.2**index, index) if index >= INDICES[0] else None


def _steep(dial: Mapping[str, float]) -> str:
    """The first two readings that rise more than their speeds, which is impossible for drilling mud; empty if there are none."""
    rows = sorted((float(speed), speed, reading) for speed, reading in dial.items())
    for (slow, low, first), (fast, high, second) in zip(rows, rows[1:], strict=False):
        if first > 0 and second / first > fast / slow:
            return (
                f"{second:g} at {high} rpm against {first:g} at {low} rpm is steeper than a newtonian fluid"
            )
    return ""


def least_squares(model: str, dial: Mapping[str, float]) -> tuple[float, ...]:
    """Constants with the least sum of squared differences in stress; 0 <= tau_y <= 1.2 times the slowest stress."""
    rates = [float(speed) * RPM for speed in dial]
    stresses = [reading * DEGREE for reading in dial.values()]
    top = 1.2 * stresses[-1] if model in ("bingham", "herschel_bulkley") else 0.0

    def at(index: float) -> tuple[float, float, float]:
        """(sum of squares, tau_y, K) of the best fluid with this flow index."""
        powers = [rate**index for rate in rates]
        stress = min(max(_intercept(powers, stresses), 0.0), top)
        slope = sum(x * (y - stress) for x, y in zip(powers, stresses, strict=True)) / sum(
            x * x for x in powers
        )
        return (
            sum((stress + slope * x - y) ** 2 for x, y in zip(powers, stresses, strict=True)),
            stress,
            slope,
        )

    index = 1.0 if model in ("newtonian", "bingham") else _least(lambda n: at(n)[0], *INDICES)
    _, stress, slope = at(index)
    if slope <= 0 or index <= INDICES[0] * 1.001 or index >= INDICES[1] * 0.999:
        readings = ", ".join(f"{speed}: {reading:g}" for speed, reading in dial.items())
        raise refuse(
            "dial",
            got=readings,
            want=f"readings that rise with the speed like a {model} fluid",
            hint=_steep(dial),
        )
    return {
        "newtonian": (slope,),
        "bingham": (stress, slope),
        "power_law": (slope, index),
        "herschel_bulkley": (stress, slope, index),
    }[model]


def _intercept(x: Sequence[float], y: Sequence[float]) -> float:
    """Of the straight line through points, by least squares."""
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    spread = sum((a - mean_x) ** 2 for a in x)
    if spread <= 1e-12 * mean_x**2:
        return 0.0
    return mean_y - mean_x * sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True)) / spread


def _least(function: Callable[[float], float], low: float, high: float) -> float:
    """Place of the least value: the best of 60 places, refined by golden section."""
    step = (high - low) / 60
    best = min((low + k * step for k in range(61)), key=function)
    low, high = max(low, best - step), min(high, best + step)
    ratio = (math.sqrt(5) - 1) / 2
    for _ in range(60):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, b) if function(a) <= function(b) else (a, high)
    return (low + high) / 2


def misfit(dial: Mapping[str, float], stress: Callable[[float], float]) -> float:
    """Root mean square difference [Pa] between the readings and a flow curve.

    stress: [Pa] at a shear rate [1/s]
    """
    differences = [stress(float(speed) * RPM) - reading * DEGREE for speed, reading in dial.items()]
    return math.sqrt(sum(d * d for d in differences) / len(differences))
