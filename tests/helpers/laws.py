"""Laws of a user, as functions that a case names: the built-in ones once more, and one with a memory."""

from __future__ import annotations

import numpy as np


def weakening(state, static=10e3, dynamic=5e3, speed=0.02):
    """The built-in velocity weakening, with its derivatives (manual: eq-bit-torque-weakening)."""
    rest = speed / 100
    u, q = np.clip(state.speed / rest, -1, 1), state.speed / speed
    fall = dynamic + (static - dynamic) * np.exp(-(q**2))
    sign, rising = u * (15 - 10 * u**2 + 3 * u**4) / 8, 15 * (1 - u**2) ** 2 / 8 / rest
    slope = fall * rising - sign * 2 * q * (fall - dynamic) / speed
    others = {f"torque_by_{name}": 0.0 for name in ("weight", "angle", "advance", "depth")}
    return {"torque": fall * sign, "torque_by_speed": slope} | others


def weakening_alone(state, static=10e3, dynamic=5e3, speed=0.02):
    """The torque alone: the program takes its derivatives."""
    return weakening(state, static, dynamic, speed)["torque"]


def stribeck(state, ratio=1.5, speed=0.1):
    """The built-in Stribeck friction (manual: eq-contact-stribeck)."""
    return state.given * (1 + (ratio - 1) * np.exp(-((state.slip_speed / speed) ** 2)))


def warming(state, memory, torque=600.0, time=0.01):
    """Friction that falls as the bit warms up: a memory of its power over a time [s]."""
    passed = state.time - memory.get("time", state.time)
    heat = memory.get("heat", 0.0)
    friction = torque * (1 - 0.5 * np.tanh(heat / 3e3)) * np.tanh(state.speed)
    heat = heat + np.clip(passed / time, 0, 1) * (friction * state.speed - heat)
    return {"torque": friction, "rate": 2e-6 * state.weight, "memory": {"heat": heat, "time": state.time}}


def shear_stress(state, consistency=0.5, index=0.6):
    """A power law (manual: eq-mud-laminar)."""
    return consistency * state.shear_rate**index


def speed_control(t, measured, memory):
    """Torque of a PI controller of the top drive that is called every 4 ms."""
    error = measured["set_point"] - measured["top_speed"]
    memory["integral"] = memory.get("integral", 0.0) + 4e-3 * error
    return 8e3 * error + 12e3 * memory["integral"]
