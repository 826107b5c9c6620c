"""Commands on the model about its steady state: modes, critical speeds, stability, response, linear models, top drive."""

from __future__ import annotations

import argparse
from pathlib import Path

from drillpetsc.cli.command import (
    Command,
    case_argument,
    in_units,
    output_folder,
    print_once,
    print_warnings,
    read_case,
    report_option,
    show,
    units_argument,
)
from drillpetsc.errors import CaseError
from drillpetsc.parallel import start_job, world_rank


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
    case = in_units(read_case(arguments), arguments.units)
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


def _kind(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--kind", choices=("lateral", "axial", "torsional", "fluid"), help="only modes of this kind"
    )


def _without_control(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--without-control",
        action="store_true",
        help="leave out the motor and controller of the top drive, and hold the top",
    )


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
    _kind(command)
    command.add_argument(
        "--lines",
        metavar="N1,N2",
        help="excitation lines: cycles per turn, blades (of drag bit and reamer), motor (orbit of a pdm's rotor) (default: 1,2,3 and the "
        "blades of a drag bit)",
    )
    command.add_argument(
        "--frequency",
        choices=("wd", "wn"),
        default="wd",
        help="critical speeds are where lines meet damped (wd) or natural frequencies (wn) (default: wd)",
    )
    command.add_argument(
        "--stiffness",
        metavar="K1,K2",
        help="critical speeds without damping at these stiffnesses of the wall, too: '1e6,1e7,1e8 Pa'",
    )
    _without_control(command)
    units_argument(command)


def _campbell(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.speed_options import read_lines, read_speeds, read_stiffnesses

    case = in_units(read_case(arguments), arguments.units)
    speeds = read_speeds(arguments.speeds, "--speeds")
    lines = None if arguments.lines is None else read_lines(arguments.lines)
    stiffness = read_stiffnesses(arguments.stiffness) if arguments.stiffness else ()
    start_job(petsc_options)
    print_warnings(case)
    from drillpetsc.analysis.frequency.campbell_command import run_campbell

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
        frequency=arguments.frequency,
        stiffness=stiffness,
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
        "--method",
        choices=("eigen", "time"),
        default="eigen",
        help="eigen: growth of the modes; time: a run at each point, too (default: eigen)",
    )
    command.add_argument(
        "--duration", default="60 s", metavar="TIME", help="of each run of --method time (default: 60 s)"
    )
    _kind(command)
    _without_control(command)
    units_argument(command)


def _stability(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.speed_options import read_duration, read_speeds, read_weights

    case = in_units(read_case(arguments), arguments.units)
    speeds = read_speeds(arguments.rpm, "--rpm", lowest_above_zero=True)
    weights = read_weights(arguments.wob, case.output.units or "SI")
    duration = read_duration(arguments.duration)
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
        method=arguments.method,
        duration=duration,
    )
    return show(result.lines, result.folder, arguments)


def _response_arguments(command: argparse.ArgumentParser) -> None:
    case_argument(command)
    command.add_argument(
        "--excite",
        required=True,
        metavar="KIND",
        help="unbalance: unbalances, eccentricities, bends and curvatures of the case; bit: a motion, force or torque of the "
        "lower end; motor: the orbit of a motor's rotor; the name of a string item, or a measured depth ('120 m'): a motion, force or torque there",
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
        help="of the bit or the place: a motion along the string ('3 mm'), a force ('5 kN') or a torque ('1 kN m')",
    )
    command.add_argument(
        "--order", type=float, metavar="N", help="cycles per turn (default: 3 of the bit, 1 of a place)"
    )
    command.add_argument(
        "--stress",
        action="store_true",
        help="add the alternating stresses of the pipe, which turns, for its fatigue",
    )
    _without_control(command)
    units_argument(command)


def _response(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    from drillpetsc.case.speed_options import read_excitation, read_speeds

    case = in_units(read_case(arguments), arguments.units)
    excitation = read_excitation(arguments.excite, arguments.amplitude, arguments.order, case)
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
        stress=arguments.stress,
    )
    return show(result.lines, result.folder, arguments)


def _top_drive(arguments: argparse.Namespace, petsc_options: list[str]) -> int:
    case = read_case(arguments)
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
    case = read_case(arguments)
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
    case = read_case(arguments)
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
