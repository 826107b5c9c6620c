"""Wells of one section and muds of one viscosity, for cases that tests build by hand."""

from __future__ import annotations

from typing import Any

import numpy as np


def simple_well(
    depth: Any,
    diameter: Any,
    inclination: Any = 0.0,
    azimuth: Any = 0.0,
    kind: str = "open_hole",
    **section: Any,
) -> dict[str, Any]:
    """A well with stations at the surface and at its end, or at several depths, and one section: the keys of `well` in a case.

    depth, diameter: of the hole [m], the depth of its end or a list of all stations; inclination, azimuth [rad]: a number, or one for each
    station.  section: further keys, such as friction.
    """
    md = list(depth) if np.ndim(depth) else [0, depth]

    def each(value: Any) -> list:
        return list(value) if np.ndim(value) else [value] * len(md)

    survey = {"md": md, "inclination": each(inclination), "azimuth": each(azimuth)}
    return {"survey": survey, "sections": [{"to": md[-1], "kind": kind, "diameter": diameter, **section}]}


def newtonian(density: Any, viscosity: Any, **keys: Any) -> dict[str, Any]:
    """Newtonian mud: the keys of `fluid` in a case.

    density [kg/m3]; viscosity [Pa s]; keys: further ones, such as flow_rate.
    """
    return {"density": density, "rheology": {"model": "newtonian", "viscosity": viscosity}, **keys}
