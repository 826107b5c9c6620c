"""Commands that compute without a run in time: statics, hydraulics, roadmap, limits and others."""

from __future__ import annotations

import argparse
from pathlib import Path

from drillpetsc.cli.command import (
    Command,
    case_argument,
    in_units,
    name_and_units,
    output_folder,
    print_once,
    print_warnings,
    read_case,
    report_option,
    show,
    units_argument,
)
from drillpetsc.parallel import start_job


def _statics_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    units_argument(command)
    command.add_argument(
        "--motion",
        choices=("hoist", "lower", "rotate"),
        help="motion that friction opposes (default: the top's)",
    )
    command.add_argument(
        "--operation",
        metavar="WORD",
        help="instead, trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; or slackoff, pickup, rob: "
        "whether the bit is on bottom belongs to it",
    )
    command.add_argument(
        "--path",
        choices=("sliding", "slack_off"),
        help="follow the history of a buckled string with friction: the whole string slides or turns (gives the band of states), "
        "or it is lowered onto a bit that stands",
    )


def _statics(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    case = in_units(read_case(arguments), arguments.units)
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.statics import run_statics

    name = Path(arguments.case).stem
    motion, path = arguments.motion, arguments.path
    result = run_statics(
        case,
        arguments.out,
        motion,
        arguments.overwrite,
        name,
        path=path,
        operation=arguments.operation,
    )
    print_once(result.lines)
    return 0


def _hydraulics_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--flow",
        metavar="Q1,Q2",
        help="flow rates, such as '400,500,600 gpm' or '20..60 l/s' (default: the case's)",
    )
    command.add_argument(
        "--spp", metavar="P", help="instead, the flow rate at this pump pressure, such as '3000 psi'"
    )
    units_argument(command)


def _hydraulics(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.flow_options import read_flows

    case = read_case(arguments)
    flows, pressure = read_flows(arguments.flow, arguments.spp, case.output.units or "SI")
    start_job(petsc_options)
    case = in_units(case, arguments.units)
    print_warnings(case)
    from drillpetsc.analysis.hydraulics.hydraulics import run_hydraulics

    name, units = name_and_units(arguments, case)
    result = run_hydraulics(case, flows, pressure, arguments.out, arguments.overwrite, name, units=units)
    return show(result.lines, result.folder, arguments)


def _surge_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--speed",
        metavar="V1,V2",
        required=True,
        help="trip speeds, such as '30,60,90 ft/min' or '20..200 ft/min'",
    )
    command.add_argument(
        "--operation", default="trip_in,trip_out", metavar="A,B", help="trip_in, trip_out (default: both)"
    )
    command.add_argument(
        "--pipe",
        default="closed,open",
        metavar="A,B",
        help="closed: no flow through the bit; open: open at the top, too; pumping: with --flow (default: closed,open)",
    )
    command.add_argument(
        "--bit-depth", metavar="D1,D2", help="measured depths of the bit (default: the case's)"
    )
    command.add_argument(
        "--window",
        metavar="PORE,FRAC",
        help="limits of the open hole, such as '11.2,13.8 ppg' (default: the case's window)",
    )
    command.add_argument("--flow", metavar="Q", help="flow rate of --pipe pumping (default: the case's)")
    command.add_argument(
        "--dynamic",
        action="store_true",
        help="for each speed also a run of string and mud from rest, with 0.3 m/s2 at the top (seconds to minutes each)",
    )
    units_argument(command)


def _surge(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.flow_options import read_trips

    case = read_case(arguments)
    trips = read_trips(
        arguments.speed,
        arguments.operation,
        arguments.pipe,
        arguments.bit_depth,
        arguments.window,
        arguments.flow,
        arguments.dynamic,
        units=case.output.units or "SI",
    )
    start_job(petsc_options)
    case = in_units(case, arguments.units)
    print_warnings(case)
    from drillpetsc.analysis.hydraulics.surge import run_surge

    name, units = name_and_units(arguments, case)
    result = run_surge(case, trips, arguments.out, arguments.overwrite, name, units=units)
    return show(result.lines, result.folder, arguments)


def _roadmap_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--measured", metavar="FILE", help="measured points to plot: CSV, xlsx or LAS (default: the case's)"
    )
    command.add_argument(
        "--model",
        choices=("soft", "stiff"),
        default="soft",
        help="soft: soft string; stiff: the beam in static equilibrium, about 0.1 s a row (default: soft)",
    )
    units_argument(command)


def _roadmap(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.measured_option import measured_option

    case = read_case(arguments)
    measured = None if arguments.measured is None else measured_option(arguments.measured, case)
    start_job(petsc_options)
    case = in_units(case, arguments.units)
    print_warnings(case)
    from drillpetsc.analysis.torque_drag.roadmap import run_roadmap

    name, units = name_and_units(arguments, case)
    result = run_roadmap(
        case,
        arguments.out,
        arguments.overwrite,
        name,
        units=units,
        measured=measured,
        model=arguments.model,
    )
    return show(result.lines, result.folder, arguments)


def _limits_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--operation",
        metavar="WORD",
        help="trip_in, trip_out, rotate_off_bottom, drilling, sliding, backreaming; or slackoff, pickup, rob "
        "(default: the case as it is, moving as its top prescribes)",
    )
    command.add_argument(
        "--helical", choices=("chen", "wu"), default="chen", help="law of the helical limit (default: chen)"
    )
    command.add_argument(
        "--design-factor",
        type=float,
        default=1.25,
        help="least yield strength over von Mises stress, below which a warning is given (default: 1.25)",
    )
    command.add_argument(
        "--tension-fraction",
        type=float,
        default=0.9,
        help="share of the pull at yield that tension_limit allows (default: 0.9)",
    )
    command.add_argument(
        "--corrosive", action="store_true", help="corrosive mud: 0.6 of the permissible doglegs (API RP 7G)"
    )
    command.add_argument(
        "--sn",
        metavar="A,B|FILE",
        help="S-N curve for Miner's damage per hour: a,b of log10 N = a - b log10(S/MPa), or a CSV file with the columns "
        "stress [MPa], cycles",
    )
    units_argument(command)


def _limits(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    case = read_case(arguments)
    start_job(petsc_options)
    case = in_units(case, arguments.units)
    print_warnings(case)
    from drillpetsc.analysis.limits.limits import run_limits
    from drillpetsc.analysis.limits.sn_curve import read_sn
    from drillpetsc.analysis.limits.table import Choices

    choices = Choices(
        helical=arguments.helical,
        design_factor=arguments.design_factor,
        tension_fraction=arguments.tension_fraction,
        corrosive=arguments.corrosive,
        sn=None if arguments.sn is None else read_sn(arguments.sn),
    )
    name, units = name_and_units(arguments, case)
    out, overwrite = arguments.out, arguments.overwrite
    result = run_limits(case, arguments.operation, choices, out, overwrite, name, units=units)
    return show(result.lines, result.folder, arguments)


def _freepoint_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--stretch",
        metavar="E1,E2",
        required=True,
        help="stretch at the surface under each pull, such as '24 in' or '10,24 in'",
    )
    command.add_argument(
        "--pull",
        metavar="F1,F2",
        required=True,
        help="pulls beyond the weight of the free string, such as '30 klb' or '12,30 klb'",
    )
    units_argument(command)


def _freepoint(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.free_point_options import read_pairs

    case, pairs = read_case(arguments), read_pairs(arguments.stretch, arguments.pull)
    case = in_units(case, arguments.units)
    print_warnings(case)
    from drillpetsc.analysis.limits.free_point import free_point_lines

    print_once(free_point_lines(case, pairs, arguments.units or case.shown_units))
    return 0


def _calibrate_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--measured", metavar="FILE", help="measured points: CSV, xlsx or LAS (default: the case's)"
    )
    command.add_argument(
        "--fit",
        metavar="A,B",
        help="what is fitted: cased, open_hole, groups of sections by their ff_group, block_weight, weight_factor (default: all "
        "friction factors)",
    )
    units_argument(command)


def _calibrate(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.measured_option import fit_option, measured_option

    case = read_case(arguments)
    fit = None if arguments.fit is None else fit_option(arguments.fit, case)
    measured = None if arguments.measured is None else measured_option(arguments.measured, case)
    start_job(petsc_options)
    case = in_units(case, arguments.units)
    print_warnings(case)
    from drillpetsc.analysis.torque_drag.calibrate import run_calibrate

    name, units = name_and_units(arguments, case)
    result = run_calibrate(case, measured, fit, arguments.out, arguments.overwrite, name, units=units)
    return show(result.lines, result.folder, arguments)


COMMANDS = (
    Command(
        "statics",
        "static equilibrium: torque and drag, contact forces, buckling state",
        _statics_arguments,
        _statics,
        parents=(output_folder(),),
    ),
    Command(
        "hydraulics",
        "steady flow of the mud: pressures, losses, equivalent densities, power at the bit, for one or more flow rates",
        _hydraulics_arguments,
        _hydraulics,
        parents=(output_folder(), report_option()),
    ),
    Command(
        "surge",
        "pressures of running in and pulling out, and the largest trip speed within the window of the open hole",
        _surge_arguments,
        _surge,
        parents=(output_folder(), report_option()),
    ),
    Command(
        "roadmap",
        "torque and drag over the bit depth: hook load and torque for six operations and several friction factors",
        _roadmap_arguments,
        _roadmap,
        parents=(output_folder(), report_option()),
    ),
    Command(
        "limits",
        "stresses, safety factors, buckling and fatigue limits along the string, margin of overpull, largest weight on bit",
        _limits_arguments,
        _limits,
        parents=(output_folder(), report_option()),
    ),
    Command(
        "freepoint",
        "how much of a stuck string is free, from its stretch under a pull",
        _freepoint_arguments,
        _freepoint,
        takes_petsc_options=False,
    ),
    Command(
        "calibrate",
        "friction factors from measured hook loads and torques, with intervals",
        _calibrate_arguments,
        _calibrate,
        parents=(output_folder(), report_option()),
    ),
)
