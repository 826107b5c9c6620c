"""Results of the commands on the steady flow of the mud."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from drillpetsc.output.summaries.summary import Summary


@dataclass(frozen=True, kw_only=True)
class HydraulicsSummary(Summary):
    """summary.json of hydraulics."""

    title: Annotated[str, "", "Title of the case."]
    bit_depth: Annotated[float, "m", "Measured depth of the string's lower end."]
    hole_depth: Annotated[float | None, "m", "Measured depth of the end of the hole; null without a well."]
    shoe_depth: Annotated[float | None, "m", "Measured depth of the last casing shoe; null without casing."]
    shoe_tvd: Annotated[float | None, "m", "Vertical depth of the last casing shoe; null without casing."]
    window: Annotated[
        dict[str, Any] | None,
        "",
        "Window of the case: tvd [m] (null: one pair), pore and frac [kg/m3]; null without one.",
    ]
    outlet_pressure: Annotated[float, "Pa", "Gauge pressure at the outlet."]
    flows: Annotated[
        list[dict[str, Any]],
        "",
        "List: for each flow rate the quantities of this page (null if absent), `limited_by` and `warnings`; `nozzles`, the rows of nozzles.csv, if there are nozzles above the bit.",
    ]
    rheology: Annotated[
        dict[str, Any] | None,
        "",
        "From dial readings: plastic_viscosity [Pa s], yield_point [Pa], index [-] and consistency [Pa s^n] by API in pipe and annulus; null without.",
    ]
    warnings: Annotated[
        list[str], "", "Warnings on the string and its hole; warnings of a flow rate are in `flows`."
    ]
    notes: Annotated[list[str], "", "Omissions of the results, and choices made."]
    units: Annotated[str, "", "Units of printed and plotted figures; files are in SI."]


@dataclass(frozen=True, kw_only=True)
class SurgeSummary(Summary):
    """summary.json of surge."""

    title: Annotated[str, "", "Title of the case."]
    units: Annotated[str, "", "Units of printed and plotted figures; files are in SI."]
    window: Annotated[
        dict[str, Any] | None,
        "",
        "Window: tvd [m] (null: one pair), pore and frac [kg/m3]; null without one.",
    ]
    window_from: Annotated[str | None, "", "Source of the window: `case`, `--window`, or null."]
    surge: Annotated[
        list[dict[str, Any]], "", "List: the rows of surge.csv by name, each with its `warnings`."
    ]
    max_trip_speed: Annotated[list[dict[str, Any]], "", "List: the rows of max_trip_speed.csv by name."]
    open_pipe_by_area: Annotated[
        list[dict[str, Any]],
        "",
        "List: for the largest speed with an open pipe, the pressure with the handbook's split of the flow by areas, and the solver's pressure [Pa].",
    ]
    notes: Annotated[list[str], "", "Omissions of the results, and choices made."]
