"""A top drive whose motor turns the string: inertia, limits of the motor, and the speed controller as first-order states.

Kernel: kernels/top/top_drive.hpp.  Manual: sec-top-drive.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import DRIVE, ElementBlock, Energies, Field, Powers, Start
from drillpetsc.fem.quantity import Quantity
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.end_conditions import Input
from drillpetsc.physics.interfaces import Drive
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.physics.top.control import MODES, Law, Motor
from drillpetsc.physics.top.sampled_law import SampledTorque

_results = function("top_motor_results", "ippppp" + "p")
RESULTS = columns("top_motor_results")
HOLDING = 1.0e9  # torsional stiffness that holds the top in statics, in which its torque is unknown [N m/rad]
TORQUE_SCALE = 1.0e4  # usual torque of a top drive [N m]
DELAY_SCALE = 1.0e5  # usual rate of that torque [N m/s]
LIMIT_LAG = 5.0e-3  # time constant of a motor that has a largest rate of its torque and no time constant [s]
#: states in the order of the kernel: name, numbers, scale
STATES = (
    ("drive.integral", 1, TORQUE_SCALE),
    ("drive.lagged_torque", 1, TORQUE_SCALE),
    ("drive.low_passed_torque", 1, TORQUE_SCALE),
    ("drive.high_passed_torque", 1, TORQUE_SCALE),
    ("drive.delayed", 1, TORQUE_SCALE),
    ("drive.delayed_rate", 1, DELAY_SCALE),
)
SPIN = 6  # place of the spin angle among the kernel's unknowns
INTEGRAL, LAGGED, LOW_PASSED, HIGH_PASSED, DELAYED, DELAYED_RATE = range(7, 13)


class MotorDrive(Drive):
    """A motor with inertia at the upper end, whose torque is prescribed or set by a speed controller.

    rotation: set point over time [rad/s]; torque: prescribed over time [N m], None with laws.
    laws: controllers by the time from which they act, empty if the torque is prescribed.
    motor: inertia and limits; impedance: of the uppermost pipe, zeta [N m s/rad]; nodes: of the string.
    """

    name = "top_motor"
    free_angles = 1

    def __init__(
        self,
        rotation: Input,
        torque: Input | None,
        laws: Sequence[Law],
        motor: Motor,
        impedance: float,
        nodes: int,
    ):
        self._at_top = np.arange(nodes) == 0
        self.update_size = 2 if isinstance(torque, SampledTorque) else 0
        #: laws for reports, including a sampled controller with its mean delay
        self.described: tuple[Law, ...] = tuple(laws)
        self.rotation, self.torque_input = rotation, torque
        self.laws, self.motor, self.impedance = tuple(laws), motor, impedance
        self.lag = motor.lag or (LIMIT_LAG if motor.torque_rate else 0.0)
        self._phase, self._share = 0, 1.0
        #: static torque at the start on the rank with the top, else 0 [N m]
        self.start_torque = 0.0

    # ------------------------------------------------------------------ discretisation
    def _present(self) -> dict[str, bool]:
        """Whether the drive has each of the states."""
        laws = self.laws
        delayed = any(q.delay > 0 for q in laws)
        return {
            "drive.integral": any(q.i for q in laws),
            "drive.lagged_torque": self.lag > 0,
            "drive.low_passed_torque": any(q.filters and q.low_pass > 0 for q in laws),
            "drive.high_passed_torque": any(q.filters and q.high_pass > 0 for q in laws),
            "drive.delayed": delayed,
            "drive.delayed_rate": delayed,
        }

    def regions(self) -> dict[str, np.ndarray]:
        """The vertex of the top, and no vertex for states that the drive does not have."""
        return {"top": self._at_top, "nowhere": np.zeros_like(self._at_top)}

    def fields(self) -> tuple[Field, ...]:
        present = self._present()
        return tuple(
            Field(
                name,
                size,
                region="top" if present[name] else "nowhere",
                scale=scale,
                second_order=False,
                physics=DRIVE,
            )
            for name, size, scale in STATES
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([0]))
        m = self.motor
        self.params = Parameters(
            "top_motor",
            len(vertices),
            held=0.0,
            angle=0.0,
            inertia=m.inertia,
            closed=0.0,
            speed=0.0,
            given=0.0,
            proportional=0.0,
            integration=0.0,
            compensation=0.0,
            coupling=0.0,
            low_pass=0.0,
            high_pass=0.0,
            estimated=0.0,
            delay_state=0.0,
            delay=0.0,
            lag=self.lag,
            rate=m.torque_rate,
            max_torque=m.max_torque,
            min_torque=m.min_torque,
            power=m.power,
        )
        self._speed, self._given = self.params["speed"], self.params["given"]
        slots = (*VERTEX_SLOTS, *((name, 0) for name, _, _ in STATES))
        self._block = ElementBlock(
            "top_motor", "top_motor", "vertex", vertices, slots, (0,), self.params.array, update=self._update
        )
        self._starts = np.array([q.start for q in self.laws])
        self._set_phase(0)
        return (self._block,)

    def _set_phase(self, phase: int) -> None:
        """Act by another of the laws.

        A law without filters or delay leaves them running as in the first law that has them, for a law that
        comes later.
        """
        self._phase = phase
        if not self.laws:
            return
        law = self.laws[phase]
        filtered = law if law.filters else next((q for q in self.laws if q.filters), law)
        delayed = law if law.delay else next((q for q in self.laws if q.delay), law)
        self.params.update(
            {
                "closed": 1.0,
                "proportional": law.p,
                "integration": law.i,
                "compensation": law.compensation,
                "coupling": law.coupling,
                "low_pass": filtered.low_pass if filtered.filters else 0.0,
                "high_pass": filtered.high_pass if filtered.filters else 0.0,
                "estimated": float(filtered.estimated),
                "delay": law.delay,
                "delay_state": delayed.delay,
            }
        )

    def _update(self, t: float) -> None:
        self._speed[:] = self._share * self.rotation.value(t)
        if self.torque_input is not None:
            self._given[:] = self._share * self.torque_input.value(t)
        if len(self.laws) > 1:
            phase = self._phase_at(t)
            if phase != self._phase:
                self._set_phase(phase)

    def _phase_at(self, t: float) -> int:
        """Number of the law that acts at ``t`` [s]."""
        return max(0, int(np.searchsorted(self._starts, t, side="right")) - 1)

    def breaks(self) -> tuple[float, ...]:
        inputs = (self.rotation, self.torque_input)
        of_inputs = {b for i in inputs if i is not None for b in i.breaks()}
        return tuple(sorted(of_inputs | {q.start for q in self.laws[1:]}))

    # ------------------------------------------------------------------ statics and start
    def hold(self) -> None:
        """Hold the top by a stiff spring, whose torque statics finds; the states are zero."""
        self.params["held"] = HOLDING

    def begin_motion(self, state: Any, start: Start) -> None:
        """The states carry the static torque; the set point of a start at rest is zero."""
        self._share = 0.0 if start.at_rest else 1.0
        self._set_phase(0)
        if not len(self._block.points) or not self.params["held"][0] > 0:
            return
        index, size = state.index_of(self._block)[0], state.layout.size
        torque = self.params["held"][0] * (self.params["angle"][0] - state.x[index[SPIN]])
        self.params["held"] = 0.0
        self.start_torque = float(torque)
        if self.motor.max_torque:
            torque = min(max(torque, self.motor.min_torque), self.motor.max_torque)
        for place in (INTEGRAL, LAGGED, LOW_PASSED, HIGH_PASSED, DELAYED):
            if index[place] < size:
                state.x[index[place]] = torque
        if self.params["estimated"][0] and index[LOW_PASSED] < size:
            state.x[index[LOW_PASSED]] = 0.0  # filtered inertia torque

    def begin_new_states(self, t: float, state: Any) -> bool:
        """Start filters, lag and delay at the torque requested by the controller.

        If they started at zero, the whole torque would appear as a sudden change.  The torque of the pipe, which would be
        exact, requires the acceleration of the top, which a restored state does not have.
        """
        if not len(self._block.points) or not self.laws:
            return False
        self._update(t)
        index, size = state.index_of(self._block)[0], state.layout.size
        integral = state.x[index[INTEGRAL]] if index[INTEGRAL] < size else 0.0
        torque = integral + self.laws[self._phase].p * (self._speed[0] - state.y[index[SPIN]])
        if self.motor.max_torque:
            torque = min(max(torque, self.motor.min_torque), self.motor.max_torque)
        changed = False
        for place in (LAGGED, LOW_PASSED, HIGH_PASSED, DELAYED):
            if place == LOW_PASSED and self.params["estimated"][0]:
                continue  # the filtered inertia torque, about zero
            at = index[place]
            if at < size and state.x[at] == 0.0 and state.y[at] == 0.0:
                state.x[at], changed = torque, True
        return changed

    def at_break(self, t: float, state: Any) -> bool:
        """Change to the law that acts from ``t`` [s] on without a jump of the torque; True if states change."""
        phase = self._phase_at(t) if len(self.laws) > 1 else self._phase
        earlier = float(np.nextafter(t, -np.inf))
        if phase == (self._phase_at(earlier) if self.laws else 0):
            return False
        self._update(earlier)  # as the step did that ended here; a restarted run has made none
        old = self.results(state)
        self._set_phase(phase)
        if not len(self._block.points) or not self.params["integration"][0]:
            return False
        self._speed[:] = self._share * self.rotation.value(t)
        new, law = self.results(state), self.laws[phase]
        kept = old[RESULTS["torque"]] if old[RESULTS["limited"]] else old[RESULTS["command"]]
        gain = 1.0
        if not self.lag and (law.low_pass == 0 or law.estimated):  # the torque acts on its set point
            gain += law.p * law.coupling
        index = state.index_of(self._block)[0]
        state.x[index[INTEGRAL]] += gain * (kept - new[RESULTS["command"]])
        return True

    # ------------------------------------------------------------------ history
    def local_update(self, state: Any) -> FloatArray:
        """(2,) torque of the motor and on the pipe [N m], for the samples of a controller; (0,) without one.

        nan if a restored state has no accelerations yet.
        """
        held = self.torque_input
        if isinstance(held, SampledTorque) and held.resumed and not np.any(state.a):
            return np.full(2, np.nan)
        r = self.results(state)
        return np.array([r[RESULTS["torque"]], r[RESULTS["pipe"]]][: self.update_size])

    def apply_update(self, total: FloatArray) -> None:
        if isinstance(self.torque_input, SampledTorque) and np.all(np.isfinite(total)):
            self.torque_input.measured, self.torque_input.resumed = total.copy(), False

    def get_state(self) -> dict[str, FloatArray]:
        """Held torque and memory of a controller in Python; empty without one."""
        return self.torque_input.get_state() if isinstance(self.torque_input, SampledTorque) else {}

    def set_state(self, state: dict[str, FloatArray]) -> None:
        if isinstance(self.torque_input, SampledTorque):
            self.torque_input.set_state(state)

    # ------------------------------------------------------------------ outputs
    def results(self, state: Any) -> FloatArray:
        """(5,) results of the drive by the names of ``RESULTS``; zero on ranks without the top."""
        out = np.zeros((len(self._block.points), RESULTS.width))
        if not len(out):
            return np.zeros(RESULTS.width)
        index = state.index_of(self._block)
        _results(
            len(out),
            pointer(index),
            pointer(self.params.array),
            pointer(state.x),
            pointer(state.y),
            pointer(state.a),
            pointer(out),
        )
        return out[0]

    def figures(self, t: float, state: Any) -> FloatArray:
        """(7,) speed, set point [rad/s], motor torque, torque on the pipe [N m], error [rad/s], mode, limit."""
        self._update(t)
        if not len(self._block.points):
            return np.zeros(7)
        speed = state.y[state.index_of(self._block)[0, SPIN]]
        r = self.results(state)
        sampled = isinstance(self.torque_input, SampledTorque)
        kind = self.torque_input.kind if isinstance(self.torque_input, SampledTorque) else "torque"
        mode = MODES[self.laws[self._phase].kind if self.laws else kind]
        torque, pipe, limited = (r[RESULTS[name]] for name in ("torque", "pipe", "limited"))
        error = self._speed[0] - speed if self.laws or sampled else 0.0
        return np.array([speed, self._speed[0], torque, pipe, error, float(mode), limited])

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.TOP_MOTOR

    def torque(self, t: float, state: Any) -> float:
        """Torque of the drive on the string [N m], zero on ranks without the top."""
        self._update(t)
        return float(self.results(state)[RESULTS["pipe"]])

    def energies(self, t: float, state: Any) -> Energies:
        if not len(self._block.points):
            return Energies()
        here = state.index_of(self._block)[0, SPIN]
        twist = state.x[here] - self.params["angle"][0]
        return Energies(
            kinetic=0.5 * self.motor.inertia * state.y[here] ** 2,
            strain=0.5 * self.params["held"][0] * twist**2,
        )

    def powers(self, t: float, state: Any) -> Powers:
        if not len(self._block.points) or self.params["held"][0] > 0:
            return Powers()
        self._update(t)
        here = state.index_of(self._block)[0, SPIN]
        return Powers(supplied=float(self.results(state)[RESULTS["torque"]] * state.y[here]))
