"""Doubts about linear analyses: modes, critical speeds, stability and response."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.doubts.doubt import CaseMoment, Values, doubt, remark, written
from drillpetsc.doubts.moments import Moment
from drillpetsc.model.drilling_model import DrillingModel

ELEMENTS_PER_WAVE = 4.0  # with fewer, the growth of a mode may come from the mesh
NO_LOSS = 1e-9  # dissipated over exchanged power below which a resonance has no bound
FEW = 5  # that are reported one by one
RPM = 30 / np.pi
REPORTED_IMBALANCE = 1.0  # unbalanced force above which a note is shown [N]


# ---------------------------------------------------------------------- moments
@dataclass(frozen=True, kw_only=True)
class Modal(Moment):
    """Modes have been found (modes).

    frequency: (k,) [Hz]; kind: of each; grows: (k,).  kept: number of modes with the mud's force at the reference frequency.
    imbalance: largest unbalanced force on a node [N].
    """

    frequency: np.ndarray
    kind: Sequence[str]
    grows: np.ndarray
    kept: int
    imbalance: float

    @property
    def lateral(self) -> np.ndarray:
        """(k,) whether a mode is lateral."""
        return np.array([kind == "lateral" for kind in self.kind], dtype=bool)


@dataclass(frozen=True)
class Followed(CaseMoment):
    """Modes have been followed over rotary speeds (campbell).

    case_speed: of the case [rpm], 0 for a string that does not turn; mac: least MAC by which modes are followed.
    lost: (branch, rotary speed [rpm]); near: critical speeds near that of the case, within ``margin`` [%].
    speeds: modes at each rotary speed.
    """

    case_speed: float
    margin: float
    mac: float
    lost: Sequence[tuple[int, float]]
    near: Sequence[Any]
    speeds: Sequence[Any]


@dataclass(frozen=True)
class Mapped(CaseMoment):
    """Stability has been computed over rotary speed and weight on bit (stability).

    points: at each; rough: unbalanced force over weight on bit beyond which a state is not steady.
    behaviours: of the runs, empty without runs; differ: (point, behaviour) at which runs and eigenvalues differ.
    """

    points: Sequence[Any]
    rough: float
    behaviours: Sequence[str]
    differ: Sequence[tuple[Any, str]]


@dataclass(frozen=True, kw_only=True)
class Responded(Moment):
    """The string has been shaken (response).

    speeds: [rad/s]; validity: (word, measured depth) at each; losses: dissipated over exchanged power; closed: number of contacts.
    """

    excitation: Any
    speeds: Sequence[float]
    validity: Sequence[tuple[str, float]]
    losses: Sequence[float]
    closed: int


@dataclass(frozen=True, kw_only=True)
class Linear(Moment):
    """The model has been linearised about its steady state (linearise).

    imbalance: largest unbalanced force on a node [N].  varying: (key, value at time 0) of inputs that vary.
    closed: number of closed contacts, None without a wall.  moves, turns: the string, in the steady state.
    on_bottom: whether the bit has weight, None without a bit whose weight is an output.
    """

    imbalance: float
    varying: Sequence[tuple[str, float]]
    closed: int | None
    moves: bool
    turns: bool
    on_bottom: bool | None


@dataclass(frozen=True, kw_only=True)
class Reduction(Moment):
    """The state space has been formed, and reduced if that was asked for (linearise).

    rigid: kinds of unrestrained motions.  rising: kind, frequency [Hz] and growth [1/s] of motions that grow; constant: number of those
    that neither grow nor decay.  apart: outputs that do not depend on the inputs; follows: (output, input) whose rate it follows.
    order: number of states asked for, None without a reduction; states: of the whole model.
    """

    rigid: Sequence[str]
    rising: Sequence[Mapping[str, Any]]
    constant: int
    apart: Sequence[str]
    follows: Sequence[tuple[str, str]]
    order: int | None
    states: int


# ---------------------------------------------------------------------- modes
@doubt(
    "{kept} modes use the mud's force at the reference frequency, because their own frequency was not found",
    "Read the damping of these modes as an estimate.",
)
def reference_frequency(at: Modal) -> Values:
    """The force of the mud on some modes is taken at a reference frequency, because their own was not found."""
    return at.kept and {"kept": at.kept}


@doubt(
    "{count} of the growing modes, from {frequency:.4g} Hz, have {waves} waves shorter than {few:g} elements of {length:length 3}: "
    "their growth may come from the mesh. It is real if it remains with element_length below {enough:length 2}",
    "Repeat with the shorter `element_length` of the message.",
)
def growth_of_mesh(at: Modal) -> Values:
    """Modes grow whose waves are shorter than a few elements, so that the mesh may be the cause.

    The exchange of work between string and mud is balanced up to the error of the mesh only. Waves are those of pressure in the mud, or
    of bending, at the frequency w of the pipe's own mass m per length: (m w^2/EI)^(1/4).
    """
    if at.model.fluid is None or not at.model.beam.moves:
        return
    mud, mesh = at.model.fluid.constants, at.model.mesh
    pipe = ~mesh.is_joint & (mesh.mass > 0)
    length = float(mesh.length[~mesh.is_joint].max())
    slowest = np.sqrt(mesh.bending_stiffness[pipe] / mesh.mass[pipe]) * (2 * np.pi / mesh.length[pipe]) ** 2
    sound = np.sqrt(mud.bulk_modulus / mud.density)
    bending = float(slowest.min()) / (2 * np.pi * ELEMENTS_PER_WAVE**2)
    for waves, limit, power, of_kind in (
        ("pressure", sound / (ELEMENTS_PER_WAVE * length), 1.0, ~at.lateral),
        ("bending", bending, 0.5, at.lateral),
    ):
        coarse = at.grows & (at.frequency > limit) & of_kind
        if coarse.any():
            yield {
                "count": int(coarse.sum()),
                "frequency": at.frequency[coarse].min(),
                "waves": waves,
                "few": ELEMENTS_PER_WAVE,
                "length": length,
                "enough": length * (limit / at.frequency[coarse].max()) ** power,
            }


@doubt(
    "{count} forward whirls grow: the mud swirls with the string at up to {fastest:.3g} Hz and feeds slower whirls. campbell finds the "
    "rotary speed at which this begins; --set fluid.swirl=NUMBER shows how it depends on the swirl (0.26 of the spin by default about "
    "5 in pipe in 8 1/2 in hole; rough walls and turbulence halve it)",
    "Compare with a smaller `fluid.swirl`.",
)
def fed_by_swirl(at: Modal) -> Values:
    """Forward whirls grow because the mud swirls faster about the string than they go round."""
    annulus = at.model.annulus
    if annulus is None or not at.model.beam.moves:
        return None
    own = float(np.abs(annulus.parameter("swirl")).max(initial=0.0))
    fastest = max(at.model.system.comm.tompi4py().allgather(own)) / (2 * np.pi)
    fed = at.grows & at.lateral & (at.frequency > 0) & (at.frequency < fastest)
    return fed.any() and {"count": int(fed.sum()), "fastest": fastest}


# ---------------------------------------------------------------------- campbell
@doubt(
    "branches lost, because no mode at the next speed has a MAC of {mac:g}: {branches}; a finer step may help",
    "Use a finer step of `--speeds`.",
)
def lost_branches(at: Followed) -> Values:
    """Modes at neighbouring speeds are too different to be followed, so critical speeds beyond may be missing."""
    if at.lost:
        more = f" and {len(at.lost) - 6} more" if len(at.lost) > 6 else ""
        listed = ", ".join(f"{branch} at {speed:g} rpm" for branch, speed in at.lost[:6])
        yield {"mac": at.mac, "branches": listed + more}


@doubt(
    "critical speed {speed:.4g} rpm ({motor}{line:.4g} per turn, {kind} {frequency:.4g} Hz, {damping}) is within {margin:g} % of "
    "the case's {case_speed:g} rpm",
    "Rotate at another speed, or move stabilizers and drill collars.",
)
def near_critical(at: Followed) -> Values:
    """The rotary speed of the case is close to a critical speed with little damping."""
    for c in at.near[:FEW]:
        undamped = np.isinf(c.amplification)
        yield {
            "speed": c.speed * RPM,
            "motor": "motor, " if c.excitation == "motor" else "",
            "line": c.line,
            "kind": c.kind,
            "frequency": c.frequency,
            "damping": "undamped" if undamped else f"damping ratio {c.damping_ratio:.2g}",
            "margin": at.margin,
            "case_speed": at.case_speed,
        }


@doubt(
    "{count} more critical speeds are within {margin:g} % of the case's speed",
    "Read them in critical.csv.",
)
def more_near_critical(at: Followed) -> Values:
    """More critical speeds are close to the rotary speed of the case than are listed."""
    return len(at.near) > FEW and {"count": len(at.near) - FEW, "margin": at.margin}


@doubt(
    "at 0 rpm the string is at rest without friction; modes there need not continue those above",
    "Begin `--speeds` above zero.",
)
def stuck_at_rest(at: Followed) -> Values:
    """The modes at rest are those of a string without friction, which sticks, and need not continue those of a turning string."""
    return at.speeds[0].stuck


@doubt(
    "modes beside excitation lines lie too close for the search at {cut} of {count} speeds: at {speed:.6g} rpm they are known within "
    "{radius:.2g} Hz of {middle:.3g} Hz, where the speeds ask for {width:.2g} Hz: critical speeds may be missing; a smaller step of "
    "the speeds, or a larger --count",
    "Use a smaller step of `--speeds`, or a larger `--count`.",
)
def narrow_search(at: Followed) -> Values:
    """The search beside an excitation line is narrower than the line moves to the next speed, so critical speeds may be missing."""
    cut = [(band, m.speed) for m in at.speeds for band in m.bands if band.radius < band.width]
    if cut:
        band, speed = min(cut, key=lambda q: q[0].radius / q[0].width)
        radius, middle, width = (q / (2 * np.pi) for q in (band.radius, band.middle, band.width))
        yield {
            "cut": len({s for _, s in cut}),
            "count": len(at.speeds),
            "speed": speed * RPM,
            "radius": radius,
            "middle": middle,
            "width": width,
        }


@doubt(
    "a mode grows at {grows} of {count} speeds, first at {first:g} rpm",
    "Simulate that speed with `run` to see what the motion becomes.",
)
def grows_at_speeds(at: Followed) -> Values:
    """A mode grows at some rotary speeds: the steady motion is unstable there."""
    grows = [m.speed * RPM for m in at.speeds if m.grows.any()]
    return grows and {"grows": len(grows), "count": len(at.speeds), "first": grows[0]}


# ---------------------------------------------------------------------- stability
@doubt(
    "no steady state or no mode at {missing} of {count} points: nan in the table",
    "Use less weight on bit there, or a finer mesh.",
)
def no_mode(at: Mapped) -> Values:
    """At some points there is no steady state or no mode, so that stability is not known there."""
    missing = sum(not np.isfinite(p.growth) for p in at.points)
    return missing and {"missing": missing, "count": len(at.points)}


@doubt(
    "the state is not steady at {rough} of {count} points: unbalanced force up to {force:force} at {speed:g} rpm and {weight:force}",
    "Read the growth at these points as an estimate.",
)
def not_steady(at: Mapped) -> Values:
    """Unbalanced forces remain in the state about which stability is judged."""
    rough = [p for p in at.points if p.imbalance > at.rough * p.weight]
    if rough:
        worst = max(rough, key=lambda p: p.imbalance / p.weight)
        yield {
            "rough": len(rough),
            "count": len(at.points),
            "force": worst.imbalance,
            "speed": worst.speed * RPM,
            "weight": worst.weight,
        }


@doubt(
    "{failed} of {count} runs failed: nan in the table",
    "Repeat them one by one with `run` to see why.",
)
def failed_runs(at: Mapped) -> Values:
    """Some runs that should confirm the eigenvalues have failed."""
    failed = sum(word == "failed" for word in at.behaviours)
    return failed and {"failed": failed, "count": len(at.behaviours)}


@doubt(
    "at {speed:g} rpm and {weight:force} the run {does}, and the largest growth is {growth:.3g} 1/s ({kind}, {frequency:.3g} Hz)",
    "Believe the run if it is long enough; the eigenvalues hold for small motions.",
)
def run_differs(at: Mapped) -> Values:
    """A run behaves in another way than the largest growth lets expect: amplitudes are then large, or growth is slow."""
    for p, does in at.differ[:FEW]:
        yield {
            "speed": p.speed * RPM,
            "weight": p.weight,
            "does": does,
            "growth": p.growth,
            "kind": p.kind,
            "frequency": p.frequency,
        }


@doubt(
    "runs and eigenvalues differ at {count} more points",
    "Read them in stability_runs.csv.",
)
def more_runs_differ(at: Mapped) -> Values:
    """Runs and eigenvalues differ at more points than are listed."""
    return len(at.differ) > FEW and {"count": len(at.differ) - FEW}


# ---------------------------------------------------------------------- response
@doubt(
    "at {speeds} rpm {what}{first}",
    "Reduce the excitation, or simulate these speeds with `run`.",
)
def not_linear(at: Responded) -> Values:
    """The amplitude leaves the range in which the linear response holds, or has no bound."""
    for word, what in (
        (
            "infinite",
            "an undamped natural frequency is met: the amplitude is infinite, and grows with time until something limits it",
        ),
        (
            "touches",
            "the amplitude closes an open gap to the wall: the linear result does not hold there",
        ),
        (
            "lifts",
            "the amplitude opens a closed contact, at the wall or at the bit: the linear result does not hold there",
        ),
    ):
        found = [(s, md) for s, (w, md) in zip(at.speeds, at.validity, strict=True) if w == word]
        if found:
            md = found[0][1]
            first = written(" (first at MD {md:length})", {"md": md}, at.units) if np.isfinite(md) else ""
            yield {"speeds": _rpm_list([s for s, _ in found]), "what": what, "first": first}


def _rpm_list(speeds: Sequence[float]) -> str:
    shown = ", ".join(f"{s * RPM:g}" for s in speeds[:6])
    return shown + (f" and {len(speeds) - 6} more" if len(speeds) > 6 else "")


@doubt(
    "nothing dissipates energy: resonances between these speeds have infinite amplitudes",
    "Give `material.damping`, mud or friction.",
)
def no_damping(at: Responded) -> Values:
    """Nothing dissipates energy, so that resonances between the computed speeds have infinite amplitudes."""
    return at.losses and max(at.losses) < NO_LOSS


def _bit(model: DrillingModel) -> bool:
    return model.bit is not None


remark(
    Responded,
    "closed contacts ({closed}) are springs at the stiffness of the state; friction has its slope at the sliding speed",
    lambda at: at.closed and {"closed": at.closed},
)


@doubt("{place}: the excitation acts on the node at MD {md:length 6}")
def place(at: Responded) -> Values:
    if at.excitation.kind != "place":
        return None
    depth = at.model.mesh.node_depth
    nearest = float(depth[np.argmin(np.abs(depth - at.excitation.md))])
    return {"place": at.excitation.place, "md": nearest}


remark(
    Responded,
    "the bottom of the hole moves; the bit follows it through its contact",
    lambda at: at.excitation.kind == "bit" and at.excitation.what == "displacement" and _bit(at.model),
)
remark(
    Responded,
    "the lower end is off bottom: the excitation acts on a hanging string",
    lambda at: at.excitation.kind == "bit" and not _bit(at.model),
)


# ---------------------------------------------------------------------- linearise
@doubt(
    "unbalanced forces up to {force:force 3} remain: the state is not exactly steady",
    "Read slow motions of the linear model as estimates.",
)
def not_balanced(at: Linear | Modal) -> Values:
    """Unbalanced forces remain in the state about which the model is linearised."""
    return at.imbalance > REPORTED_IMBALANCE and {"force": at.imbalance}


@doubt(
    "unrestrained rigid-body motions: {kinds}",
    "Hold the string along its axis and in rotation, or leave these motions out of the outputs.",
)
def free_motions(at: Reduction) -> Values:
    """Parts of the model move without resistance, so that constant inputs have no steady response."""
    return at.rigid and {"kinds": ", ".join(sorted(set(at.rigid)))}


@doubt(
    "the steady state is unstable: motions that grow: {count}, the fastest ({kind}, {frequency:.4g} Hz) by {growth:.4g} 1/s",
    "Control the drive, or change rotary speed or weight on bit.",
)
def unstable_state(at: Reduction) -> Values:
    """The steady state is unstable: small motions grow."""
    if at.rising:
        worst = max(at.rising, key=lambda q: q["growth"])
        yield {"count": len(at.rising), **{k: worst[k] for k in ("kind", "frequency", "growth")}}


@doubt(
    "undamped motions of constant amplitude: {count}",
    "Give `material.damping`, mud or friction.",
)
def undamped(at: Reduction) -> Values:
    """Some motions neither grow nor decay."""
    return at.constant and {"count": at.constant}


@doubt(
    "{output} does not depend on the inputs: its rows of C and D are zero",
    "Leave the output out, or add the input that moves it.",
)
def constant_output(at: Reduction) -> Values:
    """An output does not depend on any of the inputs."""
    for output in at.apart:
        yield {"output": output}


@doubt(
    "{output} also follows the rate of {input}: y = C x + D u + F u'",
    "Use F beside C and D.",
    weight="remark",
)
def follows_rate(at: Reduction) -> Values:
    """An output follows the rate of an input, which the matrix F contains."""
    for output, given in at.follows:
        yield {"output": output, "input": given}


@doubt(
    "{key} varies over time: the state uses its value at time 0, {value:g}",
    "Give the value about which the model is to be linearised as a constant.",
    weight="remark",
)
def varying_input(at: Linear) -> Values:
    """An input of the case varies over time, and the linear model holds for its value at time 0."""
    for key, value in at.varying:
        yield {"key": key, "value": value}


remark(
    Linear,
    "the controller in Python is left out: its torque stays constant",
    lambda at: any(getattr(q, "kind", "") == "python" for q in getattr(at.case.top, "control", ())),
)


@doubt("{closed} contacts with the wall are closed and act as springs; open contacts stay open; {friction}")
def closed(at: Linear) -> Values:
    friction = (
        "friction is linearised at the present sliding speed" if at.moves else "without friction at rest"
    )
    return {"closed": at.closed, "friction": friction} if at.closed else None


remark(Linear, "all contacts with the wall are open and stay open", lambda at: at.closed == 0)
remark(
    Linear,
    "the bit stays on the bottom, and its law is linearised at the present speed",
    lambda at: at.on_bottom is True,
)
remark(
    Linear,
    "the bit is off the bottom and stays there, without rock or bit law",
    lambda at: at.on_bottom is False,
)
remark(
    Linear,
    "a bent or eccentric string that rotates is linearised at one angle of rotation",
    lambda at: at.turns and at.case.string and at.model.contact is not None,
)
remark(
    Reduction,
    "--order {order}: the whole model has {states} states, and all are kept",
    lambda at: at.order is not None and at.states <= at.order and {"order": at.order, "states": at.states},
)
