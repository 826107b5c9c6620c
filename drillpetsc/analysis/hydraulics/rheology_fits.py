"""Dial readings of a case's mud and the flow curves that fit them, for the page of the mud.

All models that the readings allow are fitted, by the rules of API RP 13D and by least squares in stress
(`case/files/mud_report.py`); the one that the case computes with is marked.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from pydantic_core import PydanticCustomError

from drillpetsc.analysis.hydraulics import trade_formulas as trade
from drillpetsc.case.blocks.fluid import Rheology, flow_constants, stress_at
from drillpetsc.case.files.mud_report import DEGREE, FITTED, RPM, api_annulus, misfit, standard

FITS = ("api", "least_squares")
SAME = 1e-9  # relative difference of constants below which two fits are one


@dataclass(frozen=True)
class Fit:
    """One flow curve: stress = yield_stress [Pa] + consistency [Pa s^n] * rate^index [-].

    misfit: root mean square difference to the readings [Pa]; used: the case computes with it.
    """

    model: str
    fit: str
    yield_stress: float
    consistency: float
    index: float
    misfit: float
    used: bool = False

    def stress(self, rate: float) -> float:
        """Compute the shear stress [Pa] at a shear rate [1/s]."""
        return self.yield_stress + self.consistency * rate**self.index


@dataclass(frozen=True)
class Readings:
    """Dial readings: speed [rpm], shear rate [1/s], reading [deg], stress [Pa], one each, fastest first."""

    speed: list[float]
    rate: list[float]
    reading: list[float]
    stress: list[float]


def readings(rheology: Rheology) -> Readings | None:
    """The readings of a rheology; None if the case has none."""
    if not rheology.dial:
        return None
    speed = [float(q) for q in rheology.dial]
    reading = list(rheology.dial.values())
    return Readings(speed, [q * RPM for q in speed], reading, [q * DEGREE for q in reading])


def fits(rheology: Rheology) -> list[Fit]:
    """Fit every model that the readings allow; the one in use comes first.  Empty without readings."""
    dial = rheology.dial
    if not dial:
        return []
    consistency, index, stress = flow_constants(rheology)
    rms = misfit(dial, lambda rate: stress_at(rheology, rate))
    found = [
        Fit(rheology.model, rheology.fit or "given", stress, consistency, index, rms, True)  # type: ignore[attr-defined]
    ]
    for model in FITTED:
        for fit in FITS:
            if fit == "api" and (model == "newtonian" or not {"600", "300"} <= dial.keys()):
                continue  # there is no such rule
            try:
                keys = standard({"dial": dict(dial), "model": model, "fit": fit})
            except PydanticCustomError:
                continue  # the readings do not allow it
            k = float(keys.get("consistency", keys.get("plastic_viscosity", keys.get("viscosity", 0.0))))
            n, y = float(keys.get("index", 1.0)), float(keys.get("yield_stress", 0.0))
            curve = Fit(model, fit, y, k, n, 0.0)
            new = replace(curve, misfit=misfit(dial, curve.stress))
            if not any(q.model == model and _same(q, new) for q in found):
                found.append(new)
    return found


def _same(a: Fit, b: Fit) -> bool:
    pairs = ((a.yield_stress, b.yield_stress), (a.consistency, b.consistency), (a.index, b.index))
    return all(abs(x - y) <= SAME * max(abs(x), abs(y)) for x, y in pairs)


def figures(rheology: Rheology) -> dict[str, float]:
    """Numbers of the trade from the readings: PV [Pa s], YP [Pa], n and K by API in pipe and annulus [-, Pa s^n]."""
    dial, out = rheology.dial or {}, {}
    if {"600", "300"} <= dial.keys() and dial["600"] > dial["300"]:
        r600, r300 = dial["600"], dial["300"]
        out["plastic_viscosity"], out["yield_point"] = (
            trade.plastic_viscosity(r600, r300),
            trade.yield_point(r600, r300),
        )
        n = trade.power_law_index(r600, r300)
        out["pipe_index"], out["pipe_consistency"] = n, 0.511 * r600 / 1022**n
    around = api_annulus(dial) if dial else None
    if around is not None:
        out["annulus_consistency"], out["annulus_index"] = around
    return out
