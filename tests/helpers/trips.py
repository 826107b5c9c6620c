"""The trips that the options of `surge` mean."""

from __future__ import annotations

from typing import Any

from drillpetsc.analysis.hydraulics.surge import Trips
from drillpetsc.operations import Surge


def trips_of(units: str = "SI", **options: Any) -> Trips:
    """Trips of some options of the command.  units: of bare numbers in text."""
    return Surge(case=None, **options).read(units).trips()
