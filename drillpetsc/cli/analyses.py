"""Commands that compute without a run in time: statics, hydraulics, limits, modes and others."""

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
    report_option,
    show,
    units_argument,
)
from drillpetsc.errors import CaseError
from drillpetsc.parallel import start_job, world_rank


def _statics_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    units_argument(command)
    command.add_argument(
        "--motion",
        choices=("hoist", "lower", "rotate"),
        help="motion that friction opposes (default: the top's)",
    )
    command.add_argument(
        "--path",
        choices=("sliding", "slack_off"),
        help="follow the history of a buckled string with friction: the whole string slides or turns (gives the band of states), "
        "or it is lowered onto a bit that stands",
    )


def _statics(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = in_units(load_case(arguments.case), arguments.units)
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.statics import run_statics

    name = Path(arguments.case).stem
    motion, path = arguments.motion, arguments.path
    print_once(run_statics(case, arguments.out, motion, arguments.overwrite, name, path=path).lines)
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
    from drillpetsc.case import load_case
    from drillpetsc.case.flow_options import read_flows

    case = load_case(arguments.case)
    flows, pressure = read_flows(arguments.flow, arguments.spp, case.output.units or "SI")
    start_job(petsc_options)
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
    from drillpetsc.case import load_case
    from drillpetsc.case.flow_options import read_trips

    case = load_case(arguments.case)
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
        help="soft: soft string; stiff: the beam in static equilibrium, a second or so a row (default: soft)",
    )
    units_argument(command)


def _roadmap(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.measured_option import measured_option

    case = load_case(arguments.case)
    measured = None if arguments.measured is None else measured_option(arguments.measured, case)
    start_job(petsc_options)
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
    from drillpetsc.case import load_case

    case = load_case(arguments.case)
    start_job(petsc_options)
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
    from drillpetsc.case import load_case
    from drillpetsc.case.free_point_options import read_pairs

    case, pairs = load_case(arguments.case), read_pairs(arguments.stretch, arguments.pull)
    from drillpetsc.analysis.limits.free_point import free_point_lines

    print_once(free_point_lines(case, pairs, arguments.units or case.output.units or "metric"))
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
    from drillpetsc.case import load_case
    from drillpetsc.case.measured_option import fit_option, measured_option

    case = load_case(arguments.case)
    fit = None if arguments.fit is None else fit_option(arguments.fit, case)
    measured = None if arguments.measured is None else measured_option(arguments.measured, case)
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.torque_drag.calibrate import run_calibrate

    name, units = name_and_units(arguments, case)
    result = run_calibrate(case, measured, fit, arguments.out, arguments.overwrite, name, units=units)
    return show(result.lines, result.folder, arguments)


def _modes_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--count", type=int, default=20, help="how many oscillating modes, the lowest (default: 20)"
    )
    command.add_argument(
        "--shift",
        type=float,
        metavar="HZ",
        help="the modes nearest to this frequency instead of the lowest [Hz]",
    )
    command.add_argument(
        "--kind",
        choices=("lateral", "axial", "torsional", "fluid"),
        help="modes of this kind alone (default: all)",
    )
    command.add_argument(
        "--about",
        choices=("steady", "rest"),
        default="steady",
        help="the state: moving as the top prescribes at time 0, or at rest without friction (default: steady)",
    )
    command.add_argument(
        "--without-control",
        action="store_true",
        help="leave out motor, hoist and their controllers, and hold the top",
    )
    units_argument(command)


def _modes(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = in_units(load_case(arguments.case), arguments.units)
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.modal import run_modes

    result = run_modes(
        case,
        arguments.out,
        arguments.count,
        arguments.shift,
        arguments.kind,
        arguments.about,
        arguments.overwrite,
        Path(arguments.case).stem,
        without_control=arguments.without_control,
    )
    print_once(result.lines)
    return 0


def _campbell_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--speeds",
        required=True,
        metavar="RANGE",
        help="rotary speeds: FIRST:LAST:STEP as '0:240:10 rpm', or '60,90,120 rpm'",
    )
    command.add_argument(
        "--count",
        type=int,
        default=20,
        metavar="N",
        help="oscillating modes at each speed, the lowest (default: 20)",
    )
    command.add_argument(
        "--kind", choices=("lateral", "axial", "torsional", "fluid"), help="only modes of this kind"
    )
    command.add_argument(
        "--lines",
        metavar="N1,N2",
        help="excitation lines in cycles per turn (default: 1,2,3 and the blades of a drag bit)",
    )
    command.add_argument(
        "--without-control",
        action="store_true",
        help="leave out the motor and controller of the top drive, and hold the top",
    )
    units_argument(command)


def _campbell(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.speed_options import read_lines, read_speeds

    case = in_units(load_case(arguments.case), arguments.units)
    speeds = read_speeds(arguments.speeds, "--speeds")
    lines = None if arguments.lines is None else read_lines(arguments.lines)
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.frequency.campbell import run_campbell

    result = run_campbell(
        case,
        speeds,
        arguments.out,
        arguments.count,
        arguments.kind,
        lines,
        arguments.overwrite,
        Path(arguments.case).stem,
        without_control=arguments.without_control,
    )
    return show(result.lines, result.folder, arguments)


def _stability_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--rpm",
        required=True,
        metavar="RANGE",
        help="rotary speeds: FIRST:LAST:STEP as '60:180:10 rpm', or '60,90,120 rpm'",
    )
    command.add_argument(
        "--wob", required=True, metavar="W1,W2", help="weights on bit, such as '50,100,150 kN'"
    )
    command.add_argument(
        "--count",
        type=int,
        default=20,
        metavar="N",
        help="oscillating modes at each point, the lowest (default: 20)",
    )
    command.add_argument(
        "--kind", choices=("lateral", "axial", "torsional", "fluid"), help="only modes of this kind"
    )
    command.add_argument(
        "--without-control",
        action="store_true",
        help="leave out the motor and controller of the top drive, and hold the top",
    )
    units_argument(command)


def _stability(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.speed_options import read_speeds, read_weights

    case = in_units(load_case(arguments.case), arguments.units)
    speeds = read_speeds(arguments.rpm, "--rpm", lowest_above_zero=True)
    weights = read_weights(arguments.wob, case.output.units or "SI")
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.frequency.stability_map import run_stability

    result = run_stability(
        case,
        speeds,
        weights,
        arguments.out,
        arguments.count,
        arguments.kind,
        arguments.overwrite,
        Path(arguments.case).stem,
        without_control=arguments.without_control,
    )
    return show(result.lines, result.folder, arguments)


def _response_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--excite",
        required=True,
        metavar="KIND",
        help="unbalance: unbalances, eccentricities, bends and curvatures of the case; bit: a motion, force or torque of the "
        "lower end",
    )
    command.add_argument(
        "--speeds",
        required=True,
        metavar="RANGE",
        help="rotary speeds: FIRST:LAST:STEP as '20:200:2 rpm', or '60,90,120 rpm'",
    )
    command.add_argument(
        "--amplitude",
        metavar="A",
        help="of the bit: a motion along the string ('3 mm'), a force ('5 kN') or a torque ('1 kN m')",
    )
    command.add_argument("--order", type=float, metavar="N", help="cycles per turn of the bit (default: 3)")
    command.add_argument(
        "--without-control",
        action="store_true",
        help="leave out the motor and controller of the top drive, and hold the top",
    )
    units_argument(command)


def _response(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case
    from drillpetsc.case.speed_options import read_excitation, read_speeds

    case = in_units(load_case(arguments.case), arguments.units)
    excitation = read_excitation(arguments.excite, arguments.amplitude, arguments.order)
    speeds = read_speeds(arguments.speeds, "--speeds", lowest_above_zero=True)
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.frequency.response import run_response

    result = run_response(
        case,
        excitation,
        speeds,
        arguments.out,
        arguments.overwrite,
        Path(arguments.case).stem,
        without_control=arguments.without_control,
    )
    return show(result.lines, result.folder, arguments)


def _top_drive(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = load_case(arguments.case)
    start_job(petsc_options)
    from drillpetsc.analysis.top_drive import run_top_drive

    name = Path(arguments.case).stem
    print_once(run_top_drive(case, arguments.out, arguments.overwrite, name).lines)
    return 0


def _names(text: str) -> list[str]:
    """Names of a list with commas."""
    return [word.strip() for word in text.split(",") if word.strip()]


def _linearise_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--inputs",
        metavar="A,B",
        required=True,
        help="keys that may vary over time, such as top.torque,top.lowering",
    )
    command.add_argument(
        "--outputs",
        metavar="A,B",
        required=True,
        help="columns of history.csv, such as bit_speed,surface_torque",
    )
    command.add_argument(
        "--reduce",
        choices=("balanced", "modal"),
        help="write a model with fewer states, too: by balanced truncation, or by the dominant modes",
    )
    command.add_argument(
        "--order", type=int, metavar="N", help="states of the reduced model (default: 20); only with --reduce"
    )


def _linearise(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = load_case(arguments.case)
    if arguments.order is not None and arguments.reduce is None:
        raise CaseError(
            at="--order", got=arguments.order, want="only together with --reduce balanced or modal"
        )
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.linearise import run_linearise

    result = run_linearise(
        case,
        _names(arguments.inputs),
        _names(arguments.outputs),
        arguments.out,
        arguments.reduce,
        20 if arguments.order is None else arguments.order,
        arguments.overwrite,
        Path(arguments.case).stem,
    )
    print_once(result.lines)
    return 0


def _fmu_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument("-o", "--out", metavar="FILE.fmu", required=True, help="file to write")
    command.add_argument("--overwrite", action="store_true", help="replace an existing file")
    command.add_argument(
        "--inputs", metavar="A,B", help="keys that the host sets, such as top.rotation (default: all)"
    )
    command.add_argument("--outputs", metavar="A,B", help="columns of history.csv (default: all)")
    command.add_argument(
        "--interpolate",
        choices=("held", "linear"),
        default="held",
        help="an input that the host changes: held from then on, or on a straight line over the next step (default: held)",
    )


def _fmu(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case import load_case

    case = load_case(arguments.case)
    inputs, outputs = (None if q is None else _names(q) for q in (arguments.inputs, arguments.outputs))
    start_job(petsc_options)
    print_warnings(case)
    if world_rank() != 0:
        return 0
    from drillpetsc.analysis.fmu import build_fmu

    path = build_fmu(
        case,
        arguments.out,
        inputs,
        outputs,
        arguments.overwrite,
        arguments.interpolate,
        Path(arguments.case).stem,
    )
    print(f"written: {path}")
    return 0


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
    Command(
        "modes",
        "eigenvalues about the static or steady state: frequencies, damping, stability, mode shapes",
        _modes_arguments,
        _modes,
        parents=(output_folder(),),
    ),
    Command(
        "campbell",
        "modes over rotary speeds, followed by shape, and critical speeds",
        _campbell_arguments,
        _campbell,
        parents=(output_folder(), report_option()),
    ),
    Command(
        "stability",
        "does steady drilling grow or decay: the fastest growing mode over rotary speed and weight on bit",
        _stability_arguments,
        _stability,
        parents=(output_folder(), report_option()),
    ),
    Command(
        "response",
        "forced harmonic response to unbalance or to the bit, over rotary speeds",
        _response_arguments,
        _response,
        parents=(output_folder(), report_option()),
    ),
    Command(
        "linearise",
        "state space x' = A x + B u, y = C x + D u about the steady state, in full and with fewer states",
        _linearise_arguments,
        _linearise,
        parents=(output_folder(),),
    ),
    Command(
        "fmu",
        "the case as a co-simulation unit (FMI 2.0) for Simulink, OpenModelica and others; needs pythonfmu",
        _fmu_arguments,
        _fmu,
    ),
    Command(
        "top-drive",
        "gains of a top drive's controllers, and how much of a torsional wave the top reflects",
        case_argument,
        _top_drive,
        parents=(output_folder(),),
    ),
)
