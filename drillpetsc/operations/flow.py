"""Commands on the flow of the mud: hydraulics and surge."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from drillpetsc.errors import CaseError
from drillpetsc.operations.fields import Names, Numbers, number, numbers, words
from drillpetsc.operations.operation import AtBitDepth, DrawnOperation

if TYPE_CHECKING:
    from drillpetsc.analysis.hydraulics.surge import Trips

FLOW = {"above": 0, "at_most": 1}
DENSITY = {"above": 0, "at_most": 5e3, "kind": "mud_weight"}


class Hydraulics(AtBitDepth, DrawnOperation):
    """Steady flow of the mud: pressures, losses, equivalent densities, power at the bit, for one or more flow rates.

    Writes hydraulics.csv, pressure_profile.csv and flow_curve.csv.
    """

    flow: Annotated[
        Numbers | None,
        numbers("m^3/s", "400,500 gpm", **FLOW),
        "Q1,Q2",
        "flow rates, such as '400,500,600 gpm' or '20..60 l/s' (default: the case's)",
    ] = None
    spp: Annotated[
        Numbers | None,
        number("Pa", "3000 psi", above=0, at_most=1e9, kind="pressure"),
        "P",
        "instead, the flow rate at this pump pressure, such as '3000 psi'",
    ] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.hydraulics.hydraulics import run_hydraulics

        if self.flow is not None and self.spp is not None:
            raise CaseError(at="--spp", want="--flow or --spp, not both")
        return run_hydraulics(job, self.flow, self.spp)


class Surge(DrawnOperation):
    """Pressures of running in and pulling out, and the largest trip speed within the window of the open hole.

    Writes surge.csv and max_trip_speed.csv.
    """

    speeds: Annotated[
        Numbers,
        numbers("m/s", "30,60 ft/min", above=0, at_most=10, kind="trip_speed"),
        "V1,V2",
        "trip speeds, such as '30,60,90 ft/min' or '20..200 ft/min'",
    ]
    operation: Annotated[Names, words("trip_in", "trip_out"), "A,B", "trip_in, trip_out"] = "trip_in,trip_out"
    pipe: Annotated[
        Names,
        words("closed", "open", "pumping"),
        "A,B",
        "closed: no flow through the bit; open: open at the top, too; pumping: with --flow",
    ] = "closed,open"
    bit_depth: Annotated[
        Numbers | None,
        numbers("m", "1000,2000 m", above=0, at_most=50e3),
        "D1,D2",
        "measured depths of the bit (default: the case's)",
    ] = None
    window: Annotated[
        Numbers | None,
        numbers("kg/m^3", "11.2,13.8 ppg", **DENSITY),
        "PORE,FRAC",
        "limits of the open hole, such as '11.2,13.8 ppg' (default: the case's window)",
    ] = None
    flow: Annotated[
        Numbers | None,
        number("m^3/s", "400 gpm", **FLOW),
        "Q",
        "flow rate of --pipe pumping (default: the case's)",
    ] = None
    dynamic: Annotated[
        bool,
        "for each speed also a run of string and mud from rest, with 0.3 m/s2 at the top (seconds to minutes each)",
    ] = False

    def read(self, units: Any) -> Any:
        """As of ``Operation``; options that do not fit together are refused as they were written."""
        read = super().read(units)
        if self.flow is not None and "pumping" not in read.pipe:
            raise CaseError(at="--flow", got=self.flow, want="--flow together with --pipe pumping")
        if self.window is not None and (len(read.window) != 2 or read.window[1] <= read.window[0]):
            want = "two densities, PORE,FRAC, with frac above pore, such as 11.2,13.8 ppg"
            raise CaseError(at="--window", got=str(self.window), want=want)
        return read

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.hydraulics.surge import run_surge

        return run_surge(job, self.trips())

    def trips(self) -> Trips:
        """What is computed."""
        from drillpetsc.analysis.hydraulics.surge import Trips
        from drillpetsc.case.blocks.well import Window

        window = None if self.window is None else Window(pore=self.window[:1], frac=self.window[1:])
        return Trips(self.speeds, self.operation, self.pipe, self.bit_depth, window, self.flow, self.dynamic)
