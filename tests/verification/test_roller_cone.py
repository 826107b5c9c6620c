"""Bit on the lobes that roller cones leave: force in the string, flight off the bottom, energy (manual: verif-roller-cone).

Closed forms: waves along a string of two pipes, held at the top, whose lower end a spring couples to a moving
surface; a rigid mass on a moving surface that can leave it.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillpetsc import Case, run
from drillpetsc.analysis.linear.frequency.campbell_command import default_lines
from drillpetsc.analysis.linear.frequency.turning import turning_case
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.case.blocks.formation import Formation, level_bottom
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from tests.helpers.bit_models import bit_of, drilling
from tests.helpers.motion import beam, fixed, sampled
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

YOUNG, DENSITY, RPM = 206e9, 7850.0, np.pi / 30
PIPE, COLLAR = (0.127, 0.1086), (0.1778, 0.0714)
ALPHA = {"ts_type": "alpha2", "ts_alpha_radius": 0.8}


def area(section: tuple[float, float]) -> float:
    return np.pi / 4 * (section[0] ** 2 - section[1] ** 2)


def force_amplitude(
    frequency: float, move: float, pipe: float, collar: float, spring: float = np.inf, damping: float = 0.0
) -> float:
    """Force [N] at the lower end of collars below pipe, held at the top, whose lower end a surface moves.

    frequency [rad/s]; move: amplitude of the surface [m]; pipe, collar: lengths [m]; spring: between end and
    surface [N/m]; damping: force per mass over velocity [1/s].  Waves exp(i w t): EA u'' = -(w^2 - i w c) rho A u.
    """
    k = np.sqrt((frequency**2 - 1j * frequency * damping) * DENSITY / YOUNG)
    a, b = YOUNG * area(PIPE) * k, YOUNG * area(COLLAR) * k
    above = a / np.tan(k * pipe)  # force over displacement at the collars' upper end
    tangent = np.tan(k * collar)
    below = (above - b * tangent) / (1 + above / b * tangent)
    return float(abs(move / (1 / below + 1 / spring)))


@pytest.mark.parametrize(
    ("rpm", "expected"), [(60, 14.811e3), (90, 76.071e3), (120, 307.98e3), (150, 931.28e3)]
)
def test_the_closed_form_is_that_of_the_list(rpm, expected):
    """3 mm at 3 per turn, 200 m of collars below 1800 m of pipe (list of tool checks, C17 without a shock sub)."""
    assert force_amplitude(3 * rpm * RPM, 3e-3, 1800, 200) == pytest.approx(expected, rel=1e-3)


def string_on_lobes(
    law: dict, rpm: float, pipe: float, collar: float, wob: float, spring: float, damping: float
):
    """Model of pipe and collars, stiff across, under a weight on bit in a vertical hole without gravity."""
    items = [
        beam(
            length, elements, YOUNG * area(s), 1e14, 1e10, DENSITY * area(s), 0.1,
            od=0.2, id=0.05, damping={"mass": damping},
        )
        for length, elements, s in ((pipe, 40, PIPE), (collar, 8, COLLAR))
    ]  # fmt: skip
    end = pipe + collar
    case = Case(
        string=items,
        well=simple_well(end, 0.2, friction=0.0),
        contact=None,
        top={"kind": "top_drive", "rotation": rpm * RPM},
        bottom={"kind": "bit", "stiffness": spring, "friction": 0.0},
        formation={"drillability": 0, "bit_law": law},
        gravity=0.0,
        initial={"from": "statics", "wob": wob},
    )
    model = build_model(case)
    find_equilibrium(model)
    release(model)
    move_rigidly(model)
    return model


@pytest.mark.parametrize(
    ("lobes", "amplitude", "rpm", "pipe", "collar", "spring"),
    [(3, 3e-3, 90.0, 1800.0, 200.0, 2e8), (5, 0.7e-3, 111.0, 640.0, 130.0, 5e7)],
)
def test_force_of_the_bit_on_lobes(lobes, amplitude, rpm, pipe, collar, spring):
    """The amplitude of the weight on bit is that of the closed form within 1 %; the bit stays on the bottom."""
    damping, frequency = 4.0, lobes * rpm * RPM
    expected = force_amplitude(frequency, amplitude, pipe, collar, spring, damping)
    law = {"kind": "roller_cone", "lobes": lobes, "amplitude": amplitude}
    model = string_on_lobes(law, rpm, pipe, collar, 1.5 * expected, spring, damping)
    period = 2 * np.pi / frequency
    step = period / 60
    rows = sampled(
        model.system,
        56 * period,
        lambda s: bit_of(model).weight_and_torque(s.assembly),
        **fixed(step),
        **ALPHA,
    )
    t, weight, torque = rows[rows[:, 0] > 50 * period - 0.5 * step].T
    assert len(t) == 361
    wave = 2 * np.mean(weight[:-1] * np.exp(-1j * frequency * t[:-1]))
    assert abs(wave) == pytest.approx(expected, rel=1e-2)
    assert weight.mean() == pytest.approx(1.5 * expected, rel=2e-2)
    # no friction: the torque is that of climbing, W dh/dphi, and its mean power feeds the waves
    climb = lobes * amplitude * np.cos(frequency * t)
    assert torque == pytest.approx(weight * climb, abs=2e-2 * abs(weight * climb).max())


def test_no_lobes_move_nothing():
    law = {"kind": "roller_cone", "amplitude": 0.0}
    model = string_on_lobes(law, 90.0, 100.0, 50.0, 40e3, 1e8, 0.0)
    rows = sampled(
        model.system, 0.3, lambda s: bit_of(model).weight_and_torque(s.assembly), **fixed(0.01), **ALPHA
    )
    assert rows[:, 1] == pytest.approx(40e3, rel=1e-6)


def bouncing(mass: float, omega: float, waves, spring: float, end: float):
    """Height of a rigid mass [m] above its place at the start, on a surface that it can leave: (t) -> height."""

    def surface(t: float) -> float:
        return sum(a * (np.sin(n * omega * t + p) - np.sin(p)) for n, a, p in waves)

    rest = mass * 9.81 / spring

    def rate(t, y):
        return [y[1], max(surface(t) - y[0] + rest, 0.0) * spring / mass - 9.81]

    found = solve_ivp(rate, (0, end), [0.0, 0.0], rtol=1e-9, atol=1e-12, max_step=2e-3, dense_output=True)
    return found.sol, surface


@pytest.mark.parametrize(
    ("mass", "omega", "waves", "end"),
    [(1000.0, 15.0, [(3, 0.01, np.pi / 2)], 0.23), (640.0, 8.0, [(5, 4e-3, 1.1), (2, 0.03, 1.5)], 0.4)],
)
def test_a_mass_flies_off_the_lobes_and_lands(mass, omega, waves, end):
    """Where the surface falls faster than gravity the bit leaves it, and falls freely until it lands.

    Flight and landing of a rod are those of a rigid mass.  From a crest the first flight is g t^2/2.
    """
    spring = 1e9
    pattern = [{"order": n, "amplitude": a, "phase": p} for n, a, p in waves]
    model = drilling(
        {"drillability": 0, "bit_law": {"kind": "roller_cone", "pattern": pattern}},
        {"kind": "top_drive", "rotation": omega, "force": 0.0},
        mass=mass, axial=1e12, stiffness=spring, friction=0.0, gravity=9.81,
        initial={"from": "statics"},
    )  # fmt: skip
    find_equilibrium(model)
    release(model)
    move_rigidly(model)
    start = model.system.field("string.position")[-1, 2]
    rows = sampled(
        model.system,
        end,
        lambda s: [s.field("string.position")[-1, 2] - start, bit_of(model).weight_and_torque(s.assembly)[0]],
        **fixed(1e-4),
        **ALPHA,
    )
    t, down, weight = rows.T
    height, surface = bouncing(mass, omega, waves, spring, end)
    free = weight <= 0
    reach = np.abs(height(t)[0]).max()
    steps = np.diff(free.astype(int))
    expected = height(t)[0] > [surface(s) + mass * 9.81 / spring for s in t]
    landings = np.flatnonzero(np.diff(expected.astype(int)) == -1)
    assert len(landings) >= 1
    assert t[np.flatnonzero(steps == -1)][: len(landings)] == pytest.approx(t[landings], abs=1e-3)
    first = np.flatnonzero(free & (t > 0.01))[0]
    landing = np.flatnonzero(~free & (np.arange(len(t)) > first))[0]
    assert -down == pytest.approx(height(t)[0], abs=0.02 * reach)
    assert landing > first + 20
    if waves[0][2] == np.pi / 2:  # from the crest: a free fall but for the release of the spring
        drop = 0.5 * 9.81 * t[20:landing] ** 2
        launch = np.sqrt(9.81**2 * mass / spring)
        assert down[20:landing] == pytest.approx(drop, abs=1.1 * launch * t[landing])


def test_energy_of_a_bit_on_lobes_closes(tmp_path):
    """The drive's work is stored, radiates and is damped; the balance closes within 1 % over lift-off and landing."""
    case = Case(
        string=[
            {"kind": "pipe", "length": 60, "od": 0.127, "id": 0.1086, "element_length": 10},
            {"kind": "pipe", "length": 39.7, "od": 0.1778, "id": 0.0714, "element_length": 5},
            {"kind": "bit", "length": 0.3, "od": 0.216, "mass": 80},
        ],
        well=simple_well(100, 0.216, 0.1, friction=0.2),
        material={"damping": {"stiffness": 1e-4, "mass": 0.2}},
        top={"kind": "top_drive", "rotation": 12.0},
        bottom={"kind": "bit", "stiffness": 5e7},
        formation={
            "drillability": 1e-8,
            "bit_law": {"kind": "roller_cone", "amplitude": "3 mm", "phase": 0.3},
        },
        initial={"from": "statics", "wob": 20e3},
        time={"end": 1.5},
        output={"history_every": 2e-3},
    )
    result = run(case, tmp_path / "run", progress="silent")
    history = read_table(result.folder / "history.csv")
    off = history["wob [N]"] <= 0
    assert 0.02 < off.mean() < 0.9
    work = np.abs(history["kinetic_energy [J]"]).max()
    assert np.abs(history["energy_error [J]"]).max() < 0.01 * work


@each_row(
    ("law", "words"),
    [
        ({"kind": "roller_cone"}, ("amplitude",)),
        (
            {"kind": "roller_cone", "amplitude": "3 mm", "pattern": [{"order": 3, "amplitude": 1e-3}]},
            ("pattern",),
        ),
        ({"kind": "roller_cone", "amplitude": "3 mm", "base": "drag_bit"}, ("rop", "velocity_weakening")),
        ({"kind": "roller_cone", "amplitude": "3 mm", "lobes": 0}, ("lobes",)),
        ({"kind": "roller_cone", "amplitude": "-3 mm"}, ("amplitude",)),
        ({"kind": "roller_cone", "amplitude": "3 mm", "base": {"kind": "rop", "stiffness": 1e8}}, ("base",)),
        ({"kind": "roller_cone", "pattern": [{"order": 0, "amplitude": 1e-3}]}, ("order",)),
    ],
)
def test_bad_lobes_are_refused(law, words):
    with pytest.raises(CaseError) as error:
        drilling({"drillability": 0, "bit_law": law}, {"kind": "top_drive", "rotation": 1.0})
    for word in words:
        assert word in str(error.value)


def test_quasi_static_runs_have_no_lobes():
    law = {"kind": "roller_cone", "amplitude": "3 mm"}
    with pytest.raises(CaseError, match="quasi-static"):
        drilling(
            {"bit_law": law}, {"kind": "top_drive", "rotation": 1.0},
            time={"end": 1, "mode": "quasi_static"}, initial={"from": "statics"},
        )  # fmt: skip


def test_linear_models_stand_on_the_mean_bottom():
    """Formation and bit of the linear analyses are those of the base law; the lobes are lines of excitation."""
    base = {"kind": "velocity_weakening", "static": 900, "dynamic": 500, "speed": 1.0}
    law = {"kind": "roller_cone", "pattern": [{"order": 2.5, "amplitude": "1 mm"}], "base": base}
    formation = Formation(bit_law=law)
    level = level_bottom(formation)
    assert level is not None
    assert not level.bit_law.orders
    assert level.bit_law == Formation(bit_law=base).bit_law
    assert level_bottom(Formation(bit_law=base)) == Formation(bit_law=base)
    model = string_on_lobes(law, 90.0, 100.0, 50.0, 40e3, 1e8, 0.0)
    assert 2.5 in default_lines(model.case)
    assert turning_case(model.case, "campbell").formation.bit_law == level.bit_law
