"""Doubts about linear analyses: modes, critical speeds, stability and response."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.doubts.doubt import CaseMoment, Doubt, remark, written
from drillpetsc.doubts.moments import Moment
from drillpetsc.model.drilling_model import DrillingModel

Values = Iterable[dict[str, Any]]

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
class ReferenceFrequency(Doubt):
    """The force of the mud on some modes is taken at a reference frequency, because their own was not found."""

    about = (Modal,)
    sentence = "{kept} modes use the mud's force at the reference frequency, because their own frequency was not found"
    remedy = "Read the damping of these modes as an estimate."

    def look(self, at: Modal) -> Values:
        if at.kept:
            yield {"kept": at.kept}


class GrowthOfMesh(Doubt):
    """Modes grow whose waves are shorter than a few elements, so that the mesh may be the cause.

    The exchange of work between string and mud is balanced up to the error of the mesh only. Waves are those of pressure in the mud, or
    of bending, at the frequency w of the pipe's own mass m per length: (m w^2/EI)^(1/4).
    """

    about = (Modal,)
    sentence = (
        "{count} of the growing modes, from {frequency:.4g} Hz, have {waves} waves shorter than {few:g} elements of {length:length 3}: "
        "their growth may come from the mesh. It is real if it remains with element_length below {enough:length 2}"
    )
    remedy = "Repeat with the shorter `element_length` of the message."

    def look(self, at: Modal) -> Values:
        if at.model.fluid is None or not at.model.beam.moves:
            return
        mud, mesh = at.model.fluid.constants, at.model.mesh
        pipe = ~mesh.is_joint & (mesh.mass > 0)
        length = float(mesh.length[~mesh.is_joint].max())
        slowest = (
            np.sqrt(mesh.bending_stiffness[pipe] / mesh.mass[pipe]) * (2 * np.pi / mesh.length[pipe]) ** 2
        )
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


class FedBySwirl(Doubt):
    """Forward whirls grow because the mud swirls faster about the string than they go round."""

    about = (Modal,)
    sentence = (
        "{count} forward whirls grow: the mud swirls with the string at up to {fastest:.3g} Hz and feeds slower whirls. campbell finds the "
        "rotary speed at which this begins; --set fluid.swirl=NUMBER shows how it depends on the swirl (0.26 of the spin by default about "
        "5 in pipe in 8 1/2 in hole; rough walls and turbulence halve it)"
    )
    remedy = "Compare with a smaller `fluid.swirl`."

    def look(self, at: Modal) -> Values:
        annulus = at.model.annulus
        if annulus is None or not at.model.beam.moves:
            return
        own = float(np.abs(annulus.parameter("swirl")).max(initial=0.0))
        fastest = max(at.model.system.comm.tompi4py().allgather(own)) / (2 * np.pi)
        fed = at.grows & at.lateral & (at.frequency > 0) & (at.frequency < fastest)
        if fed.any():
            yield {"count": int(fed.sum()), "fastest": fastest}


# ---------------------------------------------------------------------- campbell
class LostBranches(Doubt):
    """Modes at neighbouring speeds are too different to be followed, so critical speeds beyond may be missing."""

    about = (Followed,)
    sentence = "branches lost, because no mode at the next speed has a MAC of {mac:g}: {branches}; a finer step may help"
    remedy = "Use a finer step of `--speeds`."

    def look(self, at: Followed) -> Values:
        if at.lost:
            more = f" and {len(at.lost) - 6} more" if len(at.lost) > 6 else ""
            listed = ", ".join(f"{branch} at {speed:g} rpm" for branch, speed in at.lost[:6])
            yield {"mac": at.mac, "branches": listed + more}


class NearCritical(Doubt):
    """The rotary speed of the case is close to a critical speed with little damping."""

    about = (Followed,)
    sentence = (
        "critical speed {speed:.4g} rpm ({motor}{line:.4g} per turn, {kind} {frequency:.4g} Hz, {damping}) is within {margin:g} % of "
        "the case's {case_speed:g} rpm"
    )
    remedy = "Rotate at another speed, or move stabilizers and drill collars."

    def look(self, at: Followed) -> Values:
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


class MoreNearCritical(Doubt):
    """More critical speeds are close to the rotary speed of the case than are listed."""

    about = (Followed,)
    sentence = "{count} more critical speeds are within {margin:g} % of the case's speed"
    remedy = "Read them in critical.csv."

    def look(self, at: Followed) -> Values:
        if len(at.near) > FEW:
            yield {"count": len(at.near) - FEW, "margin": at.margin}


class StuckAtRest(Doubt):
    """The modes at rest are those of a string without friction, which sticks, and need not continue those of a turning string."""

    about = (Followed,)
    sentence = "at 0 rpm the string is at rest without friction; modes there need not continue those above"
    remedy = "Begin `--speeds` above zero."

    def look(self, at: Followed) -> Values:
        if at.speeds[0].stuck:
            yield {}


class NarrowSearch(Doubt):
    """The search beside an excitation line is narrower than the line moves to the next speed, so critical speeds may be missing."""

    about = (Followed,)
    sentence = (
        "modes beside excitation lines lie too close for the search at {cut} of {count} speeds: at {speed:.6g} rpm they are known within "
        "{radius:.2g} Hz of {middle:.3g} Hz, where the speeds ask for {width:.2g} Hz: critical speeds may be missing; a smaller step of "
        "the speeds, or a larger --count"
    )
    remedy = "Use a smaller step of `--speeds`, or a larger `--count`."

    def look(self, at: Followed) -> Values:
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


class GrowsAtSpeeds(Doubt):
    """A mode grows at some rotary speeds: the steady motion is unstable there."""

    about = (Followed,)
    sentence = "a mode grows at {grows} of {count} speeds, first at {first:g} rpm"
    remedy = "Simulate that speed with `run` to see what the motion becomes."

    def look(self, at: Followed) -> Values:
        grows = [m.speed * RPM for m in at.speeds if m.grows.any()]
        if grows:
            yield {"grows": len(grows), "count": len(at.speeds), "first": grows[0]}


# ---------------------------------------------------------------------- stability
class NoMode(Doubt):
    """At some points there is no steady state or no mode, so that stability is not known there."""

    about = (Mapped,)
    sentence = "no steady state or no mode at {missing} of {count} points: nan in the table"
    remedy = "Use less weight on bit there, or a finer mesh."

    def look(self, at: Mapped) -> Values:
        missing = sum(not np.isfinite(p.growth) for p in at.points)
        if missing:
            yield {"missing": missing, "count": len(at.points)}


class NotSteady(Doubt):
    """Unbalanced forces remain in the state about which stability is judged."""

    about = (Mapped,)
    sentence = "the state is not steady at {rough} of {count} points: unbalanced force up to {force:force} at {speed:g} rpm and {weight:force}"
    remedy = "Read the growth at these points as an estimate."

    def look(self, at: Mapped) -> Values:
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


class FailedRuns(Doubt):
    """Some runs that should confirm the eigenvalues have failed."""

    about = (Mapped,)
    sentence = "{failed} of {count} runs failed: nan in the table"
    remedy = "Repeat them one by one with `run` to see why."

    def look(self, at: Mapped) -> Values:
        failed = sum(word == "failed" for word in at.behaviours)
        if failed:
            yield {"failed": failed, "count": len(at.behaviours)}


class RunDiffers(Doubt):
    """A run behaves in another way than the largest growth lets expect: amplitudes are then large, or growth is slow."""

    about = (Mapped,)
    sentence = "at {speed:g} rpm and {weight:force} the run {does}, and the largest growth is {growth:.3g} 1/s ({kind}, {frequency:.3g} Hz)"
    remedy = "Believe the run if it is long enough; the eigenvalues hold for small motions."

    def look(self, at: Mapped) -> Values:
        for p, does in at.differ[:FEW]:
            yield {
                "speed": p.speed * RPM,
                "weight": p.weight,
                "does": does,
                "growth": p.growth,
                "kind": p.kind,
                "frequency": p.frequency,
            }


class MoreRunsDiffer(Doubt):
    """Runs and eigenvalues differ at more points than are listed."""

    about = (Mapped,)
    sentence = "runs and eigenvalues differ at {count} more points"
    remedy = "Read them in stability_runs.csv."

    def look(self, at: Mapped) -> Values:
        if len(at.differ) > FEW:
            yield {"count": len(at.differ) - FEW}


# ---------------------------------------------------------------------- response
class NotLinear(Doubt):
    """The amplitude leaves the range in which the linear response holds, or has no bound."""

    about = (Responded,)
    sentence = "at {speeds} rpm {what}{first}"
    remedy = "Reduce the excitation, or simulate these speeds with `run`."

    def look(self, at: Responded) -> Values:
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


class NoDamping(Doubt):
    """Nothing dissipates energy, so that resonances between the computed speeds have infinite amplitudes."""

    about = (Responded,)
    sentence = "nothing dissipates energy: resonances between these speeds have infinite amplitudes"
    remedy = "Give `material.damping`, mud or friction."

    def look(self, at: Responded) -> Values:
        if at.losses and max(at.losses) < NO_LOSS:
            yield {}


def _place(at: Responded) -> dict[str, Any] | None:
    if at.excitation.kind != "place":
        return None
    depth = at.model.mesh.node_depth
    nearest = float(depth[np.argmin(np.abs(depth - at.excitation.md))])
    return {"place": at.excitation.place, "md": nearest}


def _bit(model: DrillingModel) -> bool:
    return model.bit is not None


remark(
    Responded,
    "closed contacts ({closed}) are springs at the stiffness of the state; friction has its slope at the sliding speed",
    lambda at: at.closed and {"closed": at.closed},
)
remark(Responded, "{place}: the excitation acts on the node at MD {md:length 6}", _place)
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
class NotBalanced(Doubt):
    """Unbalanced forces remain in the state about which the model is linearised."""

    about = (Linear, Modal)
    sentence = "unbalanced forces up to {force:force 3} remain: the state is not exactly steady"
    remedy = "Read slow motions of the linear model as estimates."

    def look(self, at: Any) -> Values:
        if at.imbalance > REPORTED_IMBALANCE:
            yield {"force": at.imbalance}


class FreeMotions(Doubt):
    """Parts of the model move without resistance, so that constant inputs have no steady response."""

    about = (Reduction,)
    sentence = "unrestrained rigid-body motions: {kinds}"
    remedy = "Hold the string along its axis and in rotation, or leave these motions out of the outputs."

    def look(self, at: Reduction) -> Values:
        if at.rigid:
            yield {"kinds": ", ".join(sorted(set(at.rigid)))}


class UnstableState(Doubt):
    """The steady state is unstable: small motions grow."""

    about = (Reduction,)
    sentence = "the steady state is unstable: motions that grow: {count}, the fastest ({kind}, {frequency:.4g} Hz) by {growth:.4g} 1/s"
    remedy = "Control the drive, or change rotary speed or weight on bit."

    def look(self, at: Reduction) -> Values:
        if at.rising:
            worst = max(at.rising, key=lambda q: q["growth"])
            yield {"count": len(at.rising), **{k: worst[k] for k in ("kind", "frequency", "growth")}}


class Undamped(Doubt):
    """Some motions neither grow nor decay."""

    about = (Reduction,)
    sentence = "undamped motions of constant amplitude: {count}"
    remedy = "Give `material.damping`, mud or friction."

    def look(self, at: Reduction) -> Values:
        if at.constant:
            yield {"count": at.constant}


class ConstantOutput(Doubt):
    """An output does not depend on any of the inputs."""

    about = (Reduction,)
    sentence = "{output} does not depend on the inputs: its rows of C and D are zero"
    remedy = "Leave the output out, or add the input that moves it."

    def look(self, at: Reduction) -> Values:
        for output in at.apart:
            yield {"output": output}


class FollowsRate(Doubt):
    """An output follows the rate of an input, which the matrix F contains."""

    about = (Reduction,)
    weight = "remark"
    sentence = "{output} also follows the rate of {input}: y = C x + D u + F u'"
    remedy = "Use F beside C and D."

    def look(self, at: Reduction) -> Values:
        for output, given in at.follows:
            yield {"output": output, "input": given}


class VaryingInput(Doubt):
    """An input of the case varies over time, and the linear model holds for its value at time 0."""

    about = (Linear,)
    weight = "remark"
    sentence = "{key} varies over time: the state uses its value at time 0, {value:g}"
    remedy = "Give the value about which the model is to be linearised as a constant."

    def look(self, at: Linear) -> Values:
        for key, value in at.varying:
            yield {"key": key, "value": value}


def _closed(at: Linear) -> dict[str, Any] | None:
    friction = (
        "friction is linearised at the present sliding speed" if at.moves else "without friction at rest"
    )
    return {"closed": at.closed, "friction": friction} if at.closed else None


remark(
    Linear,
    "the controller in Python is left out: its torque stays constant",
    lambda at: any(getattr(q, "kind", "") == "python" for q in getattr(at.case.top, "control", ())),
)
remark(
    Linear,
    "{closed} contacts with the wall are closed and act as springs; open contacts stay open; {friction}",
    _closed,
)
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
