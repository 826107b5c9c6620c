"""Computations without a run in time: statics, hydraulics, and the figures of operations."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from drillpetsc.api.loading import loaded
from drillpetsc.case import Case
from drillpetsc.parallel import initialise_petsc

if TYPE_CHECKING:
    from drillpetsc.results import Result


def statics(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    motion: str | None = None,
    operation: str | None = None,
    path: Literal["sliding", "slack_off"] | None = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Solve for the static equilibrium of a case and write statics.csv, string.pvd and summary.json
    (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    motion: hoist, lower or rotate, which friction opposes; by default the motion of the top at time 0
    operation: instead of a motion, trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming, or slackoff, pickup, rob
    path: follow the history of a buckled string with friction: sliding, the whole string slides along the hole or turns in
    it, or slack_off, it is lowered onto a bit that stands
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    case, name = loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.statics import run_statics
    from drillpetsc.results.result import result_of

    return result_of(run_statics(case, out, motion, overwrite, name, comm, path, operation))


def hydraulics(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    flow: str | float | Sequence[str | float] | None = None,
    spp: str | float | None = None,
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Solve for the steady flow of the mud and write hydraulics.csv, pressure_profile.csv and flow_curve.csv
    (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    flow: flow rates, as text ("400,500 gpm") or in m3/s; by default that of the case
    spp: pump pressure instead, as text ("3000 psi") or in Pa: the flow rate that it gives is found
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    from drillpetsc.case.flow_options import read_flows

    flows, pressure = read_flows(flow, spp)
    case, name = loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.hydraulics.hydraulics import run_hydraulics
    from drillpetsc.results.result import result_of

    return result_of(run_hydraulics(case, flows, pressure, out, overwrite, name, comm, units))


def surge(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    speed: str | float | Sequence[str | float],
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    **options: Any,
) -> Result:
    """Solve for the pressures of tripping and write surge.csv and max_trip_speed.csv (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    speed: trip speeds, as text ("20..200 ft/min") or in m/s
    operation: trip_in, trip_out; by default both
    pipe: closed, open, pumping; by default closed and open
    bit_depth: measured depths of the bit, as text or in m; by default that of the case
    window: limits of the open hole, as text ("11.2,13.8 ppg") or in kg/m3; by default the window of the case
    flow: flow rate of a pumping pipe, as text or in m3/s; by default that of the case
    dynamic: True for a run of string and mud from rest for each speed, too
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    from drillpetsc.case.flow_options import read_trips

    trips = read_trips(speed, **options)
    case, name = loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.hydraulics.surge import run_surge
    from drillpetsc.results.result import result_of

    return result_of(run_surge(case, trips, out, overwrite, name, comm, units))


def roadmap(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    measured: str | None = None,
    model: Literal["soft", "stiff"] = "soft",
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
    **block: Any,
) -> Result:
    """Compute hook load and torque over the bit depth and write roadmap.csv and roadmap.json (collective).

    case: a Case, or the path of a case file; its `roadmap` has operations, depths and friction factors
    out: run folder; by default results/<case>-NNN
    model: soft, the soft string, or stiff, the static equilibrium of the beam
    measured: file of measured points to plot; by default those of the case
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    block: keys of the case's block `roadmap` in the place of those of the case, such as
    friction_factor={"cased": [0.2, 0.25], "open_hole": [0.3, 0.35]}
    """
    from drillpetsc.case.measured_option import measured_option

    case, name = loaded(case, name)
    if block:
        case = case.replace({f"roadmap.{key}": value for key, value in block.items()})
    points = None if measured is None else measured_option(measured, case)
    initialise_petsc()
    from drillpetsc.analysis.torque_drag.roadmap import run_roadmap
    from drillpetsc.results.result import result_of

    return result_of(run_roadmap(case, out, overwrite, name, comm, units, points, model))


def calibrate(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    measured: str | None = None,
    fit: str | None = None,
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Fit friction factors to measured hook loads and torques and write calibration.csv (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    measured: file of measured points; by default those of the case
    fit: what is fitted, such as "cased,open_hole,block_weight", or a group of sections; by default all friction factors
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    from drillpetsc.case.measured_option import fit_option, measured_option

    case, name = loaded(case, name)
    parameters = None if fit is None else fit_option(fit, case)
    points = None if measured is None else measured_option(measured, case)
    initialise_petsc()
    from drillpetsc.analysis.torque_drag.calibrate import run_calibrate
    from drillpetsc.results.result import result_of

    return result_of(run_calibrate(case, points, parameters, out, overwrite, name, comm, units))


def limits(
    case: Case | str | Path,
    out: str | Path | None = None,
    *,
    operation: str | None = None,
    helical: Literal["chen", "wu"] = "chen",
    design_factor: float = 1.25,
    tension_fraction: float = 0.9,
    corrosive: bool = False,
    sn: str | None = None,
    units: Any = None,
    overwrite: bool = False,
    name: str | None = None,
    comm: Any = None,
) -> Result:
    """Solve for the static equilibrium in an operation and write limits.csv and contacts.csv (collective).

    case: a Case, or the path of a case file
    out: run folder; by default results/<case>-NNN
    operation: trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; by default the case as it is
    helical: law of the helical limit
    design_factor: least yield strength over von Mises stress, below which a warning is given
    tension_fraction: share of the pull at yield that tension_limit allows
    corrosive: the mud is corrosive: 0.6 of the permissible doglegs
    sn: S-N curve for Miner's damage: "15.0,4.0" for a and b of log10 N = a - b log10(S/MPa), or a CSV file
    units: field, metric or SI, of `lines` of the result and of plots; by default metric
    overwrite: True to replace the results in an existing folder
    name: name of the case in the default folder
    comm: PETSc communicator; by default all ranks
    """
    case, name = loaded(case, name)
    initialise_petsc()
    from drillpetsc.analysis.limits.limits import run_limits
    from drillpetsc.analysis.limits.sn_curve import read_sn
    from drillpetsc.analysis.limits.table import Choices
    from drillpetsc.results.result import result_of

    curve = None if sn is None else read_sn(sn)
    choices = Choices(
        helical=helical,
        design_factor=design_factor,
        tension_fraction=tension_fraction,
        corrosive=corrosive,
        sn=curve,
    )
    return result_of(run_limits(case, operation, choices, out, overwrite, name, comm, units))


def freepoint(
    case: Case | str | Path,
    *,
    stretch: str | float | Sequence[str | float],
    pull: str | float | Sequence[str | float],
) -> dict[str, Any]:
    """Find how much of a stuck string is free, from its stretch under pulls.

    case: a Case, or the path of a case file
    stretch: of the string at the surface, as text ("10,24 in") or in m
    pull: beyond the weight of the free string, one for each stretch, as text ("12,30 klb") or in N
    Returns `pairs`, a FreePoint for each pair, and `slope`, that of the line through them (None for one pull).
    """
    from drillpetsc.case.free_point_options import read_pairs

    pairs = read_pairs(stretch, pull)
    from drillpetsc.analysis.limits.free_point import free_points

    return free_points(loaded(case, None)[0], pairs)
