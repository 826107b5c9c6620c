"""Classes of motion of a run: how its stabilizers, bit and probes move in the hole (manual: sec-time-classes).

Only a run that is watched for it has them (``run --check-tolerance``).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.quantity import Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.probes import Probes
from drillpetsc.output.measured.rigid_items import RigidItems
from drillpetsc.parallel import total

MOSTLY, RARELY = 0.9, 0.1  # share of the time from which on a state holds, and up to which it does not
WHIRL_RATIO, WHIRL_TURNS = (
    0.1,
    0.5,
)  # turns of whirl by turns of the string, and turns, below which nothing whirls
SLOW = 0.05  # speed by its mean below which a part counts as standing
SMALLEST_OFFSET = 1e-5  # offset from the hole's axis [m] below which its direction has no meaning
STANDING = 1e-3  # mean spin rate [rad/s] below which the string does not turn
#: class -> (number that decides it, difference of the number that is a change of class)
DECIDED_BY = {
    "rotation": ("standing_share", 0.02),
    "contact": ("contact_share", 0.05),
    "sliding": ("sliding_share", 0.05),
    "whirl": ("whirl_ratio", 0.05),
}


class MotionClasses:
    """Sums over the second half of a run, from which the classes follow; all ranks call it.

    model: the drilling model.
    begin: time from which on steps count [s].
    """

    def __init__(self, model: DrillingModel, begin: float) -> None:
        self.model, self.begin, self.comm = model, begin, model.system.comm.tompi4py()
        self._probes, self._items = Probes(model), RigidItems(model)
        mesh = model.mesh
        self._bodies = [mesh.bodies[k] for k in self._items.items] if model.beam.moves else []
        self.names = [*self._items.names[: len(self._bodies)], *("probe" for _ in self._probes.depths)]
        self.depths = [*self._items.depths[: len(self._bodies)], *self._probes.depths]
        cells = [mesh.place_of(d)[0] for d in self._probes.depths]
        self._radii = np.array(
            [*(b.radius for b in self._bodies), *(0.5 * float(mesh.contact_diameter[c]) for c in cells)]
        )
        chain = model.system.chain
        self._vertex = {int(v): i for i, v in enumerate(chain.vertices) if chain.owned[i]}
        n = len(self.names)
        self._slip_velocity = model.contact.law.slip_velocity if model.contact is not None else 0.0
        self._touching, self._sliding, self._whirl, self._spin, self._speed = (np.zeros(n) for _ in range(5))
        self._last: tuple[FloatArray, FloatArray] | None = None
        self._time = self._turned = 0.0
        self._rates: list[tuple[float, float]] = []  # (dt, spin rate) of the lower end

    def _places(self, t: float) -> FloatArray:
        """(n + 1, 5) position [m], spin rate [rad/s] and force of the wall [N]; the last row is the lower end."""
        state = self.model.system.assembly
        out = np.zeros((len(self.names) + 1, 5))
        beam = self.model.beam
        nodes = [
            *((k, b.node) for k, b in enumerate(self._bodies)),
            (len(self.names), self.model.mesh.nodes - 1),
        ]
        for k, node in nodes:
            if node in self._vertex:
                out[k, :3], _, out[k, 3] = beam.section(state, self._vertex[node])
        m = len(self._bodies)
        sample = Sample(self.model.system, t)
        out[m:-1, :4] = self._probes.motions(sample)[0]
        if self.model.contact is not None:
            out[:m, 4] = self._items.loads(sample)[:m, 0]
            out[m:-1, 4] = self._probes.contact_forces(sample)[0]
        return np.asarray(total(self.comm, out))

    def step(self, t: float, dt: float) -> None:
        """Count an accepted step of ``dt`` [s] that ends at ``t`` [s]; collective."""
        if t < self.begin:
            return
        places = self._places(t)
        n = len(self.names)
        self._time += dt
        self._rates.append((dt, float(places[n, 3])))
        if not n or self.model.well is None:
            return
        position, spin, force = places[:n, :3], places[:n, 3], places[:n, 4]
        foot = self.model.well.project(position)
        offset = foot.offset
        if self._last is not None:
            before, offset_before = self._last
            velocity = (position - before) / dt
            size, size_before = np.linalg.norm(offset, axis=1), np.linalg.norm(offset_before, axis=1)
            turned = np.arctan2(
                np.sum(np.cross(offset_before, offset) * foot.tangent, axis=1),
                np.sum(offset_before * offset, axis=1),
            )
            self._whirl += np.where(np.minimum(size, size_before) > SMALLEST_OFFSET, turned, 0.0)
            self._spin += spin * dt
            normal = offset / np.maximum(size, SMALLEST_OFFSET)[:, None]
            slip = velocity - np.sum(velocity * normal, axis=1, keepdims=True) * normal
            slip += (spin * self._radii)[:, None] * np.cross(foot.tangent, normal)
            speed = np.abs(spin) * self._radii
            touches = force > 0
            slides = np.linalg.norm(slip, axis=1) > np.maximum(self._slip_velocity, SLOW * speed)
            self._touching += dt * touches
            self._sliding += dt * (touches & slides)
            self._speed += dt * speed
            self._turned += dt
        self._last = position.copy(), offset.copy()

    def summary(self) -> list[dict[str, Any]]:
        """Classes of every part with the numbers that decide them; empty before the first step."""
        if self._time <= 0:
            return []
        out: list[dict[str, Any]] = []
        for k, (name, depth) in enumerate(zip(self.names, self.depths, strict=True)):
            if self._turned <= 0 or self.model.contact is None:
                continue
            part: dict[str, Any] = {"name": name, "md [m]": float(depth)}
            share = float(self._touching[k] / self._turned)
            part["contact"] = _held(share, "at the wall", "off the wall", "bouncing")
            part["contact_share"] = share
            if share > RARELY:
                sliding = float(self._sliding[k] / self._touching[k])
                turning = self._speed[k] / self._turned > 2 * self._slip_velocity
                part["sliding"] = _held(
                    sliding, "sliding", "rolling" if turning else "sticking", "partly sliding"
                )
                part["sliding_share"] = sliding
            part |= _whirl(float(self._whirl[k]), float(self._spin[k]))
            out.append(part)
        if self.model.beam.moves:
            out.append(
                {"name": "lower end", "md [m]": float(self.model.mesh.total_length), **self._rotation()}
            )
        return out

    def _rotation(self) -> dict[str, Any]:
        dt, rate = np.array(self._rates).T
        mean = float(dt @ rate / dt.sum())
        if abs(mean) < STANDING:
            return {"rotation": "does not turn", "standing_share": 1.0}
        forward = rate * np.sign(mean)
        standing = float(dt[np.abs(forward) < SLOW * abs(mean)].sum() / dt.sum())
        backward = float(dt[forward <= -SLOW * abs(mean)].sum() / dt.sum())
        word = "turns"
        if standing + backward > DECIDED_BY["rotation"][1]:
            word = "turns backward at times" if backward > standing else "sticks at times"
        return {"rotation": word, "standing_share": standing + backward}


def _held(share: float, yes: str, no: str, between: str) -> str:
    return yes if share > MOSTLY else no if share < RARELY else between


def _whirl(angle: float, spin: float) -> dict[str, Any]:
    """Class of whirl from the angle [rad] about the hole's axis and the angle of the string's rotation."""
    turns, ratio = angle / (2 * np.pi), angle / spin if spin else 0.0
    forward = turns * (np.sign(spin) or 1.0)
    if abs(turns) < WHIRL_TURNS or (spin and abs(ratio) < WHIRL_RATIO):
        word = "no whirl"
    else:
        word = "forward whirl" if forward > 0 else "backward whirl"
    return {"whirl": word, "whirl_turns": float(turns), "whirl_ratio": float(ratio)}


def changed_classes(motion: list[dict[str, Any]], other: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Classes of motion that differ between two runs: name, md [m], what, was, is.

    motion, other: as returned by ``MotionClasses.summary``, of the same case.  A class has not changed if its
    deciding number is at its limit in both runs and almost equal.
    """
    out = []
    for part, fine in zip(motion, other, strict=True):
        for what, (number, least) in DECIDED_BY.items():
            if what not in part or what not in fine or part[what] == fine[what]:
                continue  # a part that slides in one run only has another class of contact
            if abs(part[number] - fine[number]) >= least:
                place = {"name": part["name"], "md [m]": part["md [m]"]}
                out.append({**place, "what": what, "was": part[what], "is": fine[what]})
    return out
