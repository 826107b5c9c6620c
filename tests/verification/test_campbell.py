"""Modes over the rotary speed and critical speeds against closed forms (manual: verif-campbell)."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

import drillpetsc
from drillpetsc import Case
from drillpetsc.analysis.linear.frequency.campbell import orbit_rate
from drillpetsc.analysis.linear.frequency.campbell_command import named_lines
from drillpetsc.analysis.linear.frequency.tracking import SpeedModes, pair, track
from drillpetsc.analysis.linear.frequency.turning import TurningModel
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers import frequency_models as m
from tests.helpers.command import main_succeeds
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well


def tables(case: dict, folder: Path, **options) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Columns of campbell.csv and critical.csv."""
    drillpetsc.campbell(Case(**case), folder, overwrite=True, **options)
    return tuple(
        {name.split(" [")[0]: values for name, values in read_table(folder / file).items()}
        for file in ("campbell.csv", "critical.csv")
    )


# ---------------------------------------------------------------------- disc
#: backward and forward frequencies [Hz] at rotary speeds [rpm], as computed for this check (C21) before the code was written
DISC = {
    0: (6.15608, 6.15608, 72.69546, 72.69546),
    120: (6.11884, 6.19325, 71.08594, 74.34486),
    600: (5.96945, 6.34122, 65.04485, 81.33975),
    3000: (5.22658, 7.05106, 43.47923, 124.98809),
}


def quartic(rpm: float) -> np.ndarray:
    """Frequencies [Hz] of the disc on a massless cantilever: positive forward, negative backward.

    (K - w^2 diag(m, It) + w Omega diag(0, Ip)) (u, theta) = 0 with K = EI/L^3 [[12, -6L], [-6L, 4L^2]].
    """
    L, mass, transverse, axial = 2.0, 300.0, 12.0, 20.0
    k = m.EI / L**3 * np.array([12.0, -6.0 * L, 4.0 * L**2])
    spin = rpm * m.RPM
    # (k0 - m w^2)(k2 - It w^2 + Ip Omega w) - k1^2 = 0
    one, two = np.array([-mass, 0, k[0]]), np.array([-transverse, axial * spin, k[2]])
    return np.sort(np.roots(np.polysub(np.polymul(one, two), [k[1] ** 2])).real) / (2 * np.pi)


def test_gyroscopic_split_of_a_disc(tmp_path):
    """Frequencies and whirl at 0, 120, 600, 3000 rpm within 0.2 %; synchronous critical speeds 376.346 rpm forward, 362.605
    and 2720.80 rpm backward (C21); the second forward branch never crosses.  Through a case file and the command line."""

    for rpm, values in DISC.items():
        assert np.sort(np.abs(quartic(rpm))) == pytest.approx(values, rel=2e-6)
    file = tmp_path / "disc.yaml"
    file.write_text(yaml.safe_dump(m.disc()))
    words = ["campbell", str(file), "--speeds", "0:3000:120 rpm", "--count", "6", "--lines", "1"]
    main_succeeds(*words, "--out", tmp_path / "run")
    found = read_table(tmp_path / "run" / "campbell.csv")
    lateral = (found["kind [-]"] == "lateral") & (found["frequency [Hz]"] < 1000)
    for rpm, values in DISC.items():
        rows = lateral & (found["rotary_speed [rpm]"] == rpm)
        assert np.sort(found["frequency [Hz]"][rows]) == pytest.approx(values, rel=2e-3)
        if rpm:
            order = np.argsort(found["frequency [Hz]"][rows])
            assert list(found["whirl_sense [-]"][rows][order]) == ["backward", "forward"] * 2
    critical = read_table(tmp_path / "run" / "critical.csv")
    rows = critical["kind [-]"] == "lateral"
    assert critical["critical_rotary_speed [rpm]"][rows] == pytest.approx(
        [362.605, 376.346, 2720.80], rel=2e-3
    )
    assert list(critical["whirl_sense [-]"][rows]) == ["backward", "forward", "backward"]
    assert np.isinf(critical["amplification [-]"][rows]).all()
    assert critical["speed_margin [%]"][rows][1] == pytest.approx(100 * (376.346 - 600) / 600, abs=0.05)
    assert (tmp_path / "run" / "plots" / "campbell.png").exists()


def test_branches_that_cross(tmp_path):
    """Pinned shaft with a large polar inertia J: the forward branch of the first mode crosses the backward branch of the
    second.  Both follow mu q^2 -+ J Omega k^2 q - EI k^4 = 0, k = n pi/L, at every speed, and keep their sense."""
    L, EI, mass, J, n = 10.0, 1.2e5, 27.0, 8.0, 64
    section = {
        "axial_stiffness": 1e9,
        "bending_stiffness": EI,
        "torsional_stiffness": 1e8,
        "mass": mass,
        "polar_inertia": J,
    }
    case = {
        "string": [{"kind": "beam", "length": L, "element_length": L / n, **section}],
        "top": {"kind": "top_drive", "hinged": True},
        "bottom": "pinned",
        "gravity": 0.0,
        "initial": {"from": "straight"},
    }
    speeds = np.linspace(50.0, 1000.0, 20)
    found, _ = tables(case, tmp_path, speeds=list(speeds), count=6, lines="1")
    assert json.loads((tmp_path / "summary.json").read_text())["lost"] == 0
    seen = []
    for mode in (1, 2):
        for sign in (1, -1):
            half = J * speeds * (mode * np.pi / L) ** 2 / (2 * mass)
            exact = np.hypot(half, np.sqrt(EI / mass) * (mode * np.pi / L) ** 2) + sign * half
            start = found["rotary_speed"] == found["rotary_speed"].min()
            nearest = np.abs(2 * np.pi * found["frequency"][start] - exact[0]).argmin()
            rows = found["branch"] == found["branch"][start][nearest]
            got = np.interp(speeds, found["rotary_speed"][rows] * m.RPM, 2 * np.pi * found["frequency"][rows])
            assert got == pytest.approx(exact, rel=4e-3 * mode**2)  # lumped spin: second order in kh
            assert set(found["whirl_sense"][rows]) == {"forward" if sign > 0 else "backward"}
            seen.append(exact)
    assert seen[0][0] < seen[3][0] and seen[0][-1] > seen[3][-1]  # they do cross


def axial_pipe(length: float, damping: float) -> dict:
    """A pipe that is held at its top, with axial modes (2k - 1) c/4L; other motion is far above."""
    section = {"axial_stiffness": m.YOUNG * m.AREA, "bending_stiffness": 1e12, "torsional_stiffness": 1e12}
    inertia = {"mass": m.MASS, "polar_inertia": 1.0, "damping": {"stiffness": damping}}
    beam = {"kind": "beam", "length": length, "element_length": length / 20, **section, **inertia}
    return m.two_part_string() | {"string": [beam], "top": {"kind": "top_drive", "rotation": "40 rpm"}}


def test_lines_and_damping(tmp_path):
    """Axial modes of a pipe held at the top, (2k - 1) c/4L: critical speeds 60 f/n, damping ratio w b/2, amplification 1/(w b)."""
    b, L = 1e-4, 1000.0
    _, critical = tables(
        axial_pipe(L, b), tmp_path, speeds="0:120:20 rpm", count=2, kind="axial", lines="2,3"
    )
    f = np.array([1, 3]) * m.AXIAL_SPEED / (4 * L)
    expected = sorted((60 * q / n, n, q) for q in f for n in (2, 3) if 60 * q / n < 120)
    assert critical["critical_rotary_speed"] == pytest.approx([e[0] for e in expected], rel=1e-3)
    assert list(critical["excitation_line"]) == [e[1] for e in expected]
    w = 2 * np.pi * np.array([e[2] for e in expected])
    assert critical["damping_ratio"] == pytest.approx(w * b / 2, rel=2e-3)
    assert critical["amplification"] == pytest.approx(1 / (w * b), rel=2e-3)
    near = json.loads((tmp_path / "summary.json").read_text())["warnings"]
    assert any("within 15 %" in w for w in near)  # 38.4 rpm of 40 rpm


@pytest.mark.parametrize("frequency", ["wd", "wn"])
def test_lines_meet_damped_or_natural_frequencies(frequency, tmp_path):
    """Strain damping b leaves |s| = w and makes Im s = w sqrt(1 - (w b/2)^2) [closed form]: critical speeds 60 f/n, 0.1 %."""
    length, damping = 1000, 0.03
    keys = {"speeds": "0:120:20 rpm", "count": 1, "kind": "axial", "lines": "1,2", "frequency": frequency}
    _, critical = tables(axial_pipe(length, damping), tmp_path, **keys)
    w = 2 * np.pi * m.AXIAL_SPEED / (4 * length)
    ratio = w * damping / 2
    assert ratio > 0.1
    f = w / (2 * np.pi) * (1.0 if frequency == "wn" else np.sqrt(1 - ratio**2))
    expected = sorted(60 * f / n for n in (1, 2) if 60 * f / n < 120)
    assert expected
    assert critical["critical_rotary_speed"] == pytest.approx(expected, rel=1e-3)
    assert critical["frequency"] == pytest.approx(f, rel=1e-3)
    assert critical["damping_ratio"] == pytest.approx(ratio, rel=2e-3)


def test_line_of_the_motor(tmp_path):
    """The rotor of a motor without load orbits with |N_r n Q - Omega| in space, n in rad per volume [derived]; axial modes (2k - 1) c/4L."""
    lobes, flow, length = [5, 6], 0.02, 1300.0
    turn = 100.0  # rad/m3
    pipe = {"od": 0.127, "id": 0.1086}
    section = {
        "rev_per_volume": turn,
        "stall_torque": 14e3,
        "no_load_pressure": 6e5,
        "flow_rate": flow,
        "lobes": lobes,
    }
    case = {
        "string": [
            {"kind": "pipe", "length": length - 6, **pipe, "element_length": length / 20},
            {"kind": "pdm", "length": 6.0, **pipe, "element_length": 3.0, "pdm": section},
        ],
        "top": {"kind": "top_drive", "rotation": 4.0},
        "bottom": {"kind": "free"},
        "gravity": 0.0,
        "time": {"end": 1.0},
    }
    branches, critical = tables(case, tmp_path, speeds="10:160:50 rpm", count=3, kind="axial", lines="motor")
    orbit = lobes[0] * turn * flow
    assert set(critical["excitation"]) == {"motor"}
    w = np.pi / 2 * 5122.698 / length * np.array([1, 3, 5])  # c of the pipe, 206 GPa and 7850 kg/m3
    expected = sorted(q for q in (*(orbit - w), *(orbit + w)) if 1.05 < q < 16.75)
    assert expected
    found = critical["critical_rotary_speed"] * np.pi / 30
    assert found == pytest.approx(expected, abs=2e-3 * orbit)
    assert critical["excitation_line"] * found == pytest.approx(np.abs(orbit - found), rel=1e-3)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["motor_line"][0] == pytest.approx(
        (orbit - np.pi / 3) / (2 * np.pi), abs=lobes[0] * 1e-4 / (2 * np.pi)
    )  # the law's slope of 1e-4 rad/s (manual: eq-motor-speed)
    states = TurningModel(Case(**case))
    states.at(4.0)
    assert orbit_rate(states.model) == pytest.approx(4.0 - orbit, abs=lobes[0] * 1e-4)  # backwards


def test_line_of_the_blades(tmp_path):
    """``blades`` stands for the number of a drag bit's blades."""
    case = axial_pipe(1000.0, 1e-4)
    case["string"].append({"kind": "bit", "length": 0.3, "od": 0.2, "mass": 1.0})
    case |= {"contact": None, "bottom": {"kind": "bit"}}
    case["well"] = simple_well(1000.3, 0.216, friction=0.2)
    case["formation"] = {"bit_law": {"kind": "drag_bit", "blades": 5}}
    drilling = Case(**case)
    assert named_lines(drilling, (1.0, "blades")) == (1.0, 5.0)
    with pytest.raises(CaseError, match="without a drag bit or a reamer"):
        named_lines(Case(**axial_pipe(1000.0, 1e-4)), ("blades",))
    with pytest.raises(CaseError, match="a pdm with lobes"):
        named_lines(drilling, ("motor",))


# ---------------------------------------------------------------------- tracking
def modes_of(speed: float, s: list[complex], x: np.ndarray) -> SpeedModes:
    s_ = np.array(s, dtype=complex)
    x = x / np.linalg.norm(x, axis=0)
    count = len(s_)
    return SpeedModes(
        speed, s_, x, x.copy(), ("lateral",) * count, ("mixed",) * count, np.ones(count, dtype=bool)
    )


def test_a_degenerate_pair_may_turn_its_axes():
    """Two planes at rest become a forward and a backward circle: each agrees with the span of both (1), with neither plane
    alone (0.5).  A mode of another shape is not taken."""
    at_rest = modes_of(0.0, [5j, 5j], np.array([[1, 0], [0, 1], [0, 0]], dtype=complex))
    turning = modes_of(1.0, [4.9j, 5.1j], np.array([[1, 1], [1j, -1j], [0, 0]]))
    found = pair(at_rest, turning)
    assert sorted(found.after) == [0, 1] and found.mac == pytest.approx([1.0, 1.0])
    other = modes_of(1.0, [4.9j, 5.1j], np.array([[1, 0], [1j, 0], [0, 1]]))
    assert sorted(pair(at_rest, other).after) == [-1, 0]


def test_a_lost_branch_is_not_swapped():
    """A mode without a partner ends its branch, and the mode at its frequency begins another one."""
    before = modes_of(0.0, [5j, 9j], np.eye(3)[:, :2].astype(complex))
    after = modes_of(1.0, [5j, 9j], np.eye(3)[:, [2, 1]].astype(complex))
    branches = track([before, after], [pair(before, after)])
    assert [b.points for b in branches] == [[(0, 0)], [(0, 1), (1, 1)], [(1, 0)]]
    assert [b.end for b in branches] == ["lost", "", ""]


# ---------------------------------------------------------------------- unlucky inputs
@each_row(
    ("changes", "options", "words"),
    [
        ({"top": "free"}, {}, ("top", "turn")),
        ({"bottom": "clamped"}, {}, ("bottom", "turn")),
        (
            {"beam": {"formulation": "quaternion"}, "string": [m.drill_pipe(9.0, 3)]},
            {},
            ("beam.formulation", "campbell"),
        ),
        ({}, {"speeds": "60 rpm"}, ("--speeds", "two speeds")),
        ({}, {"speeds": "-10:60:10 rpm"}, ("--speeds", "at least 0")),
        ({}, {"speeds": "0:60:100 rpm"}, ("--speeds", "step")),
        ({}, {"lines": "1,0"}, ("--lines", "above 0")),
        ({}, {"lines": "one"}, ("--lines", "cycles per turn")),
        ({}, {"count": 0}, ("--count", "at least 1")),
    ],
)
def test_bad_input_is_refused(changes, options, words, tmp_path):
    case = Case(**(m.disc() | changes))
    with pytest.raises(CaseError) as error:
        drillpetsc.campbell(case, tmp_path / "run", **({"speeds": "0:120:60 rpm"} | options))
    assert all(word in str(error.value) for word in words), str(error.value)


def test_rest_without_friction_is_told(tmp_path):
    """A string that hangs against the wall of an inclined hole: at 0 rpm another state, which is said; no crash, no loss."""
    well = simple_well(60, 0.2159, 0.6, kind="casing", friction=0.25)
    case = {
        "string": [m.drill_pipe(50.0, 10, 1e-3)],
        "well": well,
        "top": {"kind": "top_drive", "rotation": 6.0},
    }
    tables(case, tmp_path, speeds="0:60:30 rpm", count=6)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert any("without friction" in w for w in summary["warnings"])


# ---------------------------------------------------------------------- what is found, and what is not
def test_branches_do_not_hang_on_rounding(tmp_path, monkeypatch):
    """Four modes of a disc at rest end between two equal ones: both count, whatever the rounding of the eigensolver.

    Rounding is put on here; 2 of 10 such draws gave 5 branches with 19 rows for 4 with 16, as other machines did.
    """
    import drillpetsc.solvers.linear.quadratic_eigenproblem as solver

    eig, rows = np.linalg.eig, []
    for seed in (0, 1, 3):
        rng = np.random.default_rng(seed)
        monkeypatch.setattr(
            solver.np.linalg, "eig", lambda A, rng=rng: eig(A * (1 + 1e-15 * rng.standard_normal(A.shape)))
        )
        speeds = tuple(m.RPM * np.array([0.0, 200.0, 400.0, 600.0]))
        table, _ = tables(m.disc(), tmp_path / str(seed), speeds=speeds, count=4, lines=(1.0,))
        rows.append(np.array([table["rotary_speed"], table["branch"], table["frequency"]]))
    assert rows[0].shape == (3, 20)
    for other in rows[1:]:
        assert other == pytest.approx(rows[0], rel=1e-6)
    assert rows[0][2][:8] == pytest.approx(
        np.abs([quartic(rpm)[k] for k in (1, 2) for rpm in (0, 200, 400, 600)]), rel=2e-3
    )


def test_critical_speeds_above_the_lowest_modes(tmp_path):
    """One mode is asked for, 5.8 Hz; 12 per turn meets the second pair of the disc on a cantilever, at the roots of the quartic with
    w = +-12 Omega: det K - w^2 (m k2 + It k0) +- Ip k0 w Omega + m It w^4 -+ Ip m w^3 Omega = 0."""
    L, mass, transverse, axial, order = 2.0, 300.0, 12.0, 20.0, 12.0
    k0, k1, k2 = m.EI / L**3 * np.array([12.0, -6.0 * L, 4.0 * L**2])
    expected = []
    for sign in (1.0, -1.0):
        c = sign * axial / order  # Ip Omega w = c w^2 on the line
        four, two = mass * (transverse - c), -(mass * k2 + (transverse - c) * k0)
        expected.append(np.sqrt(np.roots([four, two, k0 * k2 - k1**2]).max()) / (2 * np.pi))
    speeds = [m.RPM * rpm for rpm in np.arange(250.0, 451.0, 25.0)]
    _, critical = tables(m.disc(), tmp_path, speeds=speeds, count=1, lines=(order,))
    assert np.sort(critical["frequency"]) == pytest.approx(np.sort(expected), rel=2e-3)
    assert np.sort(critical["critical_rotary_speed"]) == pytest.approx(
        np.sort(expected) * 60 / order, rel=2e-3
    )
    assert set(critical["whirl_sense"]) == {"forward", "backward"}


def lateral(depth: float = 600.0) -> Case:
    """A string that hangs in mud, whose lateral modes lie some hundredths of a hertz apart."""
    return Case(
        well=simple_well(depth, 0.2159, friction=0.2),
        string=[{"kind": "pipe", "length": depth - 10.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}],
        top={"kind": "top_drive", "hinged": True, "rotation": 60 * m.RPM},
        bottom="free",
        fluid={"density": 1200.0, "flow_rate": 0.02, "rheology": {"model": "newtonian", "viscosity": 0.03}},
    )  # fmt: skip


def test_the_search_beside_lines_finds_what_a_search_of_all_modes_finds(tmp_path):
    """Three modes reach 0.07 Hz and the line begins at 0.5 Hz: it said that no branch meets a line."""
    found = []
    for count in (3, 60):
        result = drillpetsc.campbell(
            lateral(), tmp_path / str(count), speeds="30:42:6 rpm", count=count, lines=(1.0,)
        )
        table = read_table(tmp_path / str(count) / "critical.csv")
        found.append(np.sort(table["critical_rotary_speed [rpm]"]))
        assert (
            max(result.summary["searched_to"]) < 0.1
            if count == 3
            else min(result.summary["searched_to"]) > 0.75
        )
    assert len(found[0]) > 5 and found[0] == pytest.approx(found[1], rel=1e-4)


def test_what_was_searched_is_said(tmp_path, monkeypatch):
    """Once per turn at 600 to 900 rpm is 10 to 15 Hz; the modes of the disc lie at 6 and 60 Hz."""
    from drillpetsc.analysis.linear.frequency import campbell, campbell_command

    rates = tuple(m.RPM * np.array([600.0, 900.0]))
    result = campbell_command.run_campbell(
        Job(Case(**m.disc()), tmp_path / "out"), campbell.Sought(rates, 1, lines=(1.0,))
    )
    assert "    none among the modes that were searched" in result.lines
    said = next(line for line in result.lines if "searched:" in line)
    # 1.4 times the way of the line to the next speed, 5 Hz, and a tenth of its frequency across
    assert said.startswith("  searched: all modes up to 5.") and said.endswith(
        "within 7.1 Hz of the excitation lines"
    )
    assert len(result.summary["searched_to"]) == len(result.summary["searched_beside"]) == 2
    assert not any("may be missing" in w for w in result.summary["warnings"])
    monkeypatch.setattr(campbell, "BESIDE_A_LINE", 6)
    speeds = tuple(m.RPM * np.array([30.0, 60.0]))
    narrow = campbell_command.run_campbell(
        Job(lateral(), tmp_path / "narrow"), campbell.Sought(speeds, 1, lines=(1.0,))
    )
    assert any(
        "too close for the search" in w and "critical speeds may be missing" in w
        for w in narrow.summary["warnings"]
    )
