"""Wells of one section, for cases that tests build by hand."""

from __future__ import annotations

from typing import Any


def simple_well(
    depth: Any,
    diameter: Any,
    inclination: Any = 0.0,
    azimuth: Any = 0.0,
    kind: str = "open_hole",
    **section: Any,
) -> dict[str, Any]:
    """A well with stations at the surface and at its end, and one section: the keys of `well` in a case.

    depth, diameter: of the hole [m]; inclination, azimuth [rad]: a number, or a pair for the two stations.
    section: further keys, such as friction.
    """

    def pair(value: Any) -> list:
        return list(value) if isinstance(value, tuple) else [value, value]

    survey = {"md": [0, depth], "inclination": pair(inclination), "azimuth": pair(azimuth)}
    return {"survey": survey, "sections": [{"to": depth, "kind": kind, "diameter": diameter, **section}]}
