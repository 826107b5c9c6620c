"""Commands on the model about its steady state: modes, critical speeds, stability, response, linear models, top drive."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, Literal

from drillpetsc.errors import CaseError
from drillpetsc.operations.fields import (
    Count,
    Kind,
    Names,
    Numbers,
    Speeds,
    WithoutControl,
    at_least,
    holds,
    names,
    number,
    numbers,
    rotary_speeds,
)
from drillpetsc.operations.operation import CaseOperation, DrawnOperation, FolderOperation, Mark


class Modes(FolderOperation):
    """Eigenvalues about the static or steady state: frequencies, damping, stability, mode shapes.

    Writes modes.csv and the mode shapes.
    """

    count: Annotated[int, at_least(1, "modes"), "N", "oscillating modes, the lowest"] = 20
    shift: Annotated[float | None, "HZ", "the modes nearest to this frequency instead of the lowest [Hz]"] = (
        None
    )
    kind: Kind = None
    about: Annotated[
        Literal["steady", "rest"],
        "the state: moving as the top prescribes at time 0, or at rest without friction",
    ] = "steady"
    without_control: WithoutControl = False

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.linear.modal import run_modes

        return run_modes(job, self.count, self.shift, self.kind, self.about, self.without_control)


class Campbell(DrawnOperation):
    """Modes over rotary speeds, followed by shape, and critical speeds.

    Writes campbell.csv and critical.csv, with a stiffness critical_map.csv, too.
    """

    speeds: Annotated[Speeds, rotary_speeds()]
    count: Count = 20
    kind: Kind = None
    lines: Annotated[
        Any,
        "N1,N2",
        "excitation lines: cycles per turn, blades (of drag bit and reamer), motor (orbit of a pdm's rotor) (default: 1,2,3 and the "
        "blades of a drag bit)",
    ] = None
    frequency: Annotated[
        Literal["wd", "wn"], "critical speeds are where lines meet damped (wd) or natural frequencies (wn)"
    ] = "wd"
    stiffness: Annotated[
        Numbers,
        numbers("Pa", "1e6,1e7,1e8 Pa", "stiffnesses", above=0, at_most=1e15, kind="none"),
        "K1,K2",
        "critical speeds without damping at these stiffnesses of the wall, too: '1e6,1e7,1e8 Pa'",
    ] = ()
    without_control: WithoutControl = False

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.linear.frequency.campbell import Sought
        from drillpetsc.analysis.linear.frequency.campbell_command import run_campbell
        from drillpetsc.case.options.excitation import read_lines

        lines = () if self.lines is None else read_lines(self.lines)
        sought = Sought(self.speeds, self.count, self.kind, lines)
        return run_campbell(job, sought, self.without_control, self.frequency, self.stiffness)


class Stability(DrawnOperation):
    """Does steady drilling grow or decay: the fastest growing mode over rotary speed and weight on bit.

    The case has a bit on bottom. Writes stability_map.csv and stability_boundary.csv, with runs stability_runs.csv, too.
    """

    speeds: Annotated[Speeds, rotary_speeds(above_zero=True)]
    wob: Annotated[
        Numbers,
        numbers("N", "50,100,150 kN", "weights", above=0, at_most=1e8),
        "W1,W2",
        "weights on bit, such as '50,100,150 kN'",
    ]
    count: Count = 20
    method: Annotated[
        Literal["eigen", "time"], "eigen: growth of the modes; time: a run at each point, too"
    ] = "eigen"
    duration: Annotated[
        Numbers, number("s", "60 s", at_least=1, at_most=1e5), "TIME", "of each run of --method time"
    ] = "60 s"
    kind: Kind = None
    without_control: WithoutControl = False

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.linear.frequency.stability_map import run_stability

        duration = self.duration if self.method == "time" else None
        return run_stability(
            job, self.speeds, self.wob, self.count, self.kind, self.without_control, duration
        )


class Response(DrawnOperation):
    """Forced harmonic response to unbalance or to the bit, over rotary speeds.

    Writes response.csv.
    """

    excite: Annotated[
        str,
        "KIND",
        "unbalance: unbalances, eccentricities, bends and curvatures of the case; bit: a motion, force or torque of the "
        "lower end; motor: the orbit of a motor's rotor; the name of a string item, or a measured depth ('120 m'): a motion, force or torque there",
    ]
    speeds: Annotated[Speeds, rotary_speeds(above_zero=True)]
    amplitude: Annotated[
        str | None,
        "A",
        "of the bit or the place: a motion along the string ('3 mm'), a force ('5 kN') or a torque ('1 kN m')",
    ] = None
    order: Annotated[float | None, "N", "cycles per turn (default: 3 of the bit, 1 of a place)"] = None
    stress: Annotated[bool, "add the alternating stresses of the pipe, which turns, for its fatigue"] = False
    without_control: WithoutControl = False

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.linear.frequency.response import run_response
        from drillpetsc.case.options.excitation import read_excitation

        excitation = read_excitation(self.excite, self.amplitude, self.order, job.case)
        return run_response(job, excitation, self.speeds, self.without_control, self.stress)


class Linearise(FolderOperation):
    """State space x' = A x + B u, y = C x + D u about the steady state, in full and with fewer states.

    Writes linear.npz and linear.mat. The result has `system` and `reduced`, with the matrices A, B, C, D and F, and `to_control()` for
    python-control.
    """

    inputs: Annotated[
        Names, Mark.POSITIONAL, names, "A,B", "keys that may vary over time, such as top.torque,top.lowering"
    ]
    outputs: Annotated[
        Names, Mark.POSITIONAL, names, "A,B", "columns of history.csv, such as bit_speed,surface_torque"
    ]
    reduce: Annotated[
        Literal["balanced", "modal"] | None,
        "write a model with fewer states, too: by balanced truncation, or by the dominant modes",
    ] = None
    order: Annotated[
        int | None,
        at_least(1, "states"),
        "N",
        "states of the reduced model (default: 20); only with --reduce",
    ] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.linear.linearise import run_linearise

        if self.order is not None and self.reduce is None:
            raise CaseError(
                at="--order", got=self.order, want="only together with --reduce balanced or modal"
            )
        return run_linearise(job, self.inputs, self.outputs, self.reduce, self.order or 20)


class Fmu(CaseOperation):
    """The case as a co-simulation unit (FMI 2.0) for Simulink, OpenModelica and others; needs pythonfmu.

    One process. Returns the path of the file.
    """

    out: Annotated[
        Any,
        Mark.POSITIONAL,
        holds(lambda out: str(out).endswith(".fmu"), "a file name that ends with .fmu"),
        "FILE.fmu",
        "file to write",
    ]
    overwrite: Annotated[bool, "replace an existing file"] = False
    inputs: Annotated[
        Names | None, names, "A,B", "keys that the host sets, such as top.rotation (default: all)"
    ] = None
    outputs: Annotated[Names | None, names, "A,B", "columns of history.csv (default: all)"] = None
    interpolate: Annotated[
        Literal["held", "linear"],
        "an input that the host changes: held from then on, or on a straight line over the next step",
    ] = "held"
    name: Annotated[str | None, Mark.PYTHON, "of the model"] = None

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.linear.fmu import build_fmu

        name = self.name or job.name
        return build_fmu(
            job.case, self.out, self.inputs, self.outputs, self.overwrite, self.interpolate, name
        )

    def printed(self, result: Any) -> Iterable[Any]:
        return [f"written: {result}"]


class TopDrive(FolderOperation):
    """Gains of a top drive's controllers, and how much of a torsional wave the top reflects.

    The case has `top.motor` and `top.control`. Writes reflection.csv.
    """

    def compute(self, job: Any) -> Any:
        from drillpetsc.analysis.linear.top_drive import run_top_drive

        return run_top_drive(job)
