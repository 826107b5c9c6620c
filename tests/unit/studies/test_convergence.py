"""Convergence studies: errors, orders, costs, Richardson, plans and restarts, with synthetic data and stub runs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.errors import CaseError
from drillpetsc.studies.convergence.error_norms import (
    cost_of,
    errors_of,
    extent,
    moves,
    observed_order,
    richardson,
)
from drillpetsc.studies.convergence.exact_solutions import characteristics, exact_outputs
from drillpetsc.studies.convergence.plan import (
    case_of,
    default_steps,
    default_tolerances,
    newton_tolerance,
    options_of,
    plan_curves,
    plan_of,
    read_base,
)
from drillpetsc.studies.convergence.runs import Job
from drillpetsc.studies.convergence.study import study
from tests.helpers.tables import each_row

CASE = """
title: Shaft
string:
  - {kind: beam, length: 2 m, axial_stiffness: 1e6 N, bending_stiffness: 1e4 N m^2, torsional_stiffness: 1e4 N m^2, mass: 10 kg/m,
     polar_inertia: 0.1 kg m, element_length: 0.5 m}
top: {kind: top_drive, rotation: {ramp: 1 s, value: 10 rad/s}}
bottom: free
gravity: 0
time: {end: 1 s}
output: {history_every: 0.01 s}
petsc: {ts_rtol: 1.0e-3, ts_bdf_order: 2}
"""


@pytest.fixture
def case_file(tmp_path) -> Path:
    file = tmp_path / "shaft.yaml"
    file.write_text(CASE, encoding="utf-8")
    return file


# ---------------------------------------------------------------------- norms
def test_norms_are_shares_of_the_range_of_the_reference():
    """Errors (0, 1, -2, 1) in a range of 4: largest 1/2, rms sqrt(6/4)/4, last 1/4, mean 0."""
    reference = np.array([0.0, 4.0, 2.0, 1.0])
    found = errors_of(reference + [0.0, 1.0, -2.0, 1.0], reference)
    assert found == pytest.approx({"max": 0.5, "rms": np.sqrt(1.5) / 4, "end": 0.25, "mean": 0.0}, abs=1e-15)


def test_a_constant_output_has_no_relative_error():
    still = np.full(5, 792684.0) + [0, 1e-4, -1e-4, 0, 0]
    assert extent(still) == 0.0
    with pytest.raises(ValueError, match="constant in the reference"):
        errors_of(still, still)
    assert not moves(np.array([1e6, 1e6 + 0.5]))
    assert moves(np.array([1e6, 1e6 + 5.0]))


# ---------------------------------------------------------------------- orders
def test_order_of_exact_powers():
    h = np.array([0.08, 0.04, 0.02, 0.01])
    order = observed_order(h, 3.0 * h**2)
    assert order is not None
    assert (order.order, order.points) == (pytest.approx(2.0, abs=1e-12), 4)
    assert order.low == pytest.approx(2.0, abs=1e-6)


def test_confidence_interval_contains_the_order_with_its_probability():
    """Error h^2 times noise of 10 %, normal in the logarithm: the 95 % interval holds 2 in 950 of 1000 draws;
    the number of hits is binomial with a standard deviation of 6.9, so 920 to 980 is missed once in 10^4
    draws of this test, and its seed is fixed."""
    generator, h = np.random.default_rng(5), 0.1 * 0.5 ** np.arange(6)
    hits = 0
    for _ in range(1000):
        order = observed_order(h, h**2 * np.exp(generator.normal(0.0, 0.1, 6)))
        assert order is not None
        hits += order.low <= 2.0 <= order.high
    assert 920 <= hits <= 980


def test_plateau_and_unresolved_points_show_no_order():
    """Order 2 between an error above 0.3, which is no convergence yet, and 3 times the reference's own error
    of 1e-5."""
    h = 0.5 ** np.arange(10)
    errors = np.maximum(h**2, 1e-5)
    errors[0] = 0.9
    order = observed_order(h, errors, floor=1e-5)
    assert order is not None
    assert order.order == pytest.approx(2.0, abs=1e-9)
    assert order.points == 7  # h = 1/2 ... 1/128: 1/4 ... 6.1e-5; 1/256 gives 1.5e-5, below 3e-5
    assert observed_order(h[:2], errors[:2]) is None


def test_cost_of_an_error():
    """Error 1/seconds: 1 % costs 100 s for any points. If the first point is already more accurate the answer
    is `below`."""
    seconds = np.array([10.0, 40.0, 320.0])
    cost = cost_of(0.01, 1 / seconds, seconds)
    assert cost is not None
    assert (cost.seconds, cost.how) == (pytest.approx(100.0), "between")
    beyond = cost_of(1e-3, 1 / seconds, seconds)
    assert beyond is not None
    assert (beyond.seconds, beyond.how) == (pytest.approx(1000.0), "beyond")
    assert cost_of(1e-3, np.array([0.1, 0.0031, 0.003]), seconds) is None  # has come to a plateau
    below = cost_of(0.5, 1 / seconds, seconds)
    assert below is not None
    assert (below.seconds, below.how) == (10.0, "below")
    assert cost_of(1e-5, 1 / seconds, seconds) is None


def test_a_more_expensive_and_less_accurate_point_does_not_count():
    """The point at 2 s with an error of 1 lies above the line from (1 s, 0.1) to (4 s, 0.001): 0.01 costs 2
    s, in the middle."""
    cost = cost_of(0.01, np.array([0.1, 1.0, 0.001]), np.array([1.0, 2.0, 4.0]))
    assert cost is not None
    assert cost.seconds == pytest.approx(2.0)


# ---------------------------------------------------------------------- Richardson
def test_richardson_finds_limit_and_order():
    """f + C h^4 at h = 4, 2, 1: limit f, order 4, own error |C|."""
    f, C = np.sin(np.arange(7.0)), 1e-3 * np.cos(np.arange(7.0))
    found = richardson(f + 256 * C, f + 16 * C, f + C)
    assert found.values == pytest.approx(f, abs=1e-12)
    assert found.order == pytest.approx(4.0, abs=1e-9)
    assert found.error == pytest.approx(np.sqrt(np.mean(C**2)))


def test_richardson_returns_the_finest_mesh_without_convergence():
    found = richardson(np.zeros(3), np.ones(3), np.zeros(3) - 1.0)
    assert np.isnan(found.order)
    assert (found.values == -1.0).all()
    assert found.error == 2.0


# ---------------------------------------------------------------------- closed forms
def test_characteristics_of_two_cells():
    """Two cells of impedance 1 and 3 below a top whose speed is 1 from time 0.  Of a wave 1 the joint, at
    speed 2 (1 d + 3 u)/4, lets 0.5 pass and sends -0.5 back; the free end doubles: speed 1 after two cell
    times.  Then the top, still at 1, sends 1.5 down, which meets
    0.5 from the end at the joint: 2 (1.5 + 1.5)/4 = 1.5, less 0.5 goes on: 1, doubled 2."""
    t, v = characteristics(np.array([1.0, 3.0]), 0.5, lambda t: 1.0, 3.0)
    assert t[:3] == pytest.approx([0.0, 0.5, 1.0])
    assert v[:5] == pytest.approx([0.0, 0.0, 1.0, 1.0, 2.0])


def test_uniform_string_reflects_the_speed_of_its_top(case_file):
    """Free lower end: speed there 2 [w(t - T) - w(t - 3T) + ...], T = L/c = 2 m/sqrt(1e4/0.1) m/s
    (d'Alembert); within 1e-6, the cells being 1/1000 of T."""
    from drillpetsc.case import load_case

    found = exact_outputs(load_case(case_file), times := np.linspace(0.0, 1.0, 200))
    assert found is not None
    T, w = 2 / np.sqrt(1e5), lambda t: 10 * np.sin(0.5 * np.pi * np.clip(t, 0, 1)) ** 2
    exact = sum((-1) ** k * 2 * w(times - (2 * k + 1) * T) for k in range(100))
    assert found[0]["bit_speed"] == pytest.approx(exact, abs=1e-5)


@pytest.mark.parametrize(
    "change", ["bottom=pinned", "loads=[{at: 1, force: [1, 0, 0]}]", "gravity=[1, 0, 0]"]
)
def test_no_closed_form_where_its_assumptions_fail(case_file, change):
    from drillpetsc.case import load_case

    assert exact_outputs(load_case(case_file, [change]), np.linspace(0, 1, 5)) is None


# ---------------------------------------------------------------------- plans
def test_steps_and_tolerances_lie_around_those_of_the_case(case_file):
    base = read_base(case_file, {})
    assert (base.tolerance, base.history_every, base.end) == (1e-3, 0.01, 1.0)
    assert default_steps(base) == pytest.approx([0.08, 0.04, 0.02, 0.01, 0.005, 0.0025])
    assert default_tolerances(base) == pytest.approx([0.1, 1e-2, 1e-3, 1e-4, 1e-5])
    assert newton_tolerance(base, 0.005, 2) == pytest.approx(1e-3 / 8)
    assert newton_tolerance(base, 0.02, 2) == 1e-3


def test_every_default_curve_has_five_points_or_more(case_file):
    base = read_base(case_file, {})
    for vary in ("time-step", "tolerance", "order", "mesh", "formulation", "integrator", "solver"):
        points = plan_of(vary, base)
        for curve in {p.curve for p in points}:
            assert sum(p.curve == curve for p in points) >= 5
    assert [p.ranks for p in plan_of("ranks", base)] == [1, 2]
    names = {p.curve for p in plan_curves("curves", ("bdf1-fixed", "arkimex"), base)}
    assert names == {"bdf1-fixed", "arkimex"}


def test_options_of_one_integrator_do_not_reach_another(case_file):
    """The case sets ts_bdf_order, which ARKIMEX would not read, and the run would refuse."""
    base = read_base(case_file, {"q_snes_stol": "1e-8"})
    ark = case_of(base, plan_of("integrator", base, ["arkimex"])[0])
    assert "ts_bdf_order" not in ark.petsc
    assert "q_snes_stol" not in ark.petsc
    assert ark.petsc["ts_type"] == "arkimex"
    bdf = case_of(base, plan_of("integrator", base, ["bdf3"])[0])
    assert bdf.petsc["ts_bdf_order"] == "3"
    assert bdf.petsc["q_snes_stol"] == "1e-8"


def test_points_of_a_case_with_generalised_alpha(tmp_path):
    """The integrator of the case is an option that curves replace; its radius goes with it."""
    path = tmp_path / "case.yaml"
    text = "{string: [{kind: pipe, length: 10 m, od: 127 mm, id: 100 mm}], top: clamped, "
    path.write_text(
        text
        + "time: {end: 1 s, integrator: generalized_alpha, spectral_radius: 0.5}, petsc: {ts_rtol: 1e-3}}"
    )
    base = read_base(path, {})
    own = case_of(base, plan_of("tolerance", base, ["1e-3"])[0])
    assert own.petsc["ts_type"] == "alpha2" and own.petsc["ts_alpha_radius"] == 0.5
    bdf = case_of(base, plan_of("integrator", base, ["bdf3"])[0])
    assert bdf.petsc["ts_type"] == "bdf" and "ts_alpha_radius" not in bdf.petsc
    assert bdf.time is not None and bdf.time.integrator == "bdf"


def test_options_from_the_command_line():
    assert options_of(["-ts_rtol", "1e-5", "-snes_monitor", "-ts_dt", "-1"]) == {
        "ts_rtol": "1e-5",
        "snes_monitor": "",
        "ts_dt": "-1",
    }


@pytest.mark.parametrize(
    ("vary", "values", "names"),
    [
        ("time-step", ["2 m"], "--values"), ("tolerance", ["-1"], "--values"), ("ranks", ["1.5"], "--values"),
        ("order", ["9"], "--values"), ("integrator", ["rk4"], "--values"), ("wind", [], "--vary"),
        ("tolerance", ["1e-3", "1e-3"], "--values"),
    ],
)  # fmt: skip
def test_invalid_requests_are_refused_before_anything_is_written(case_file, tmp_path, vary, values, names):
    with pytest.raises(CaseError) as caught:
        study(
            case_file,
            vary,
            values=values,
            out=tmp_path / "out",
            run=lambda job: "never",
            say=lambda line: None,
        )
    assert caught.value.at == names
    assert not (tmp_path / "out").exists()


# ---------------------------------------------------------------------- runs by a stub
class Stub:
    """Stub of a run with known errors: bit speed (1 + h^2 + mesh (L/n)^4) t.

    h is the fixed step, L/n the element length. The stub records its calls, and fails on request.
    """

    def __init__(self, fails: str = "never", mesh: float = 0.0):
        self.calls: list[str] = []
        self.ranks: list[int] = []
        self.fails, self.mesh = fails, mesh

    def __call__(self, job: Job) -> str:
        from drillpetsc.case import load_case

        self.calls.append(str(job.folder))
        self.ranks.append(job.ranks)
        if self.fails in str(job.folder):
            return "Newton's method failed\n  where:   time 0.5 s"
        case = load_case(job.case)
        h = float(case.petsc.get("ts_dt", 0.0))
        element = case.string[0].element_length
        t = 0.01 * np.arange(101)
        job.folder.mkdir(parents=True)
        rows = "".join(f"{float(a)!r},{float(a * (1 + h**2 + self.mesh * element**4))!r}\n" for a in t)
        (job.folder / "history.csv").write_text("time [s],bit_speed [rad/s]\n" + rows, encoding="utf-8")
        steps = round(1 / (h or 1e-3))
        summary = {
            "wall_seconds": 2.0 * steps,
            "cpu_seconds": float(steps),
            "steps": steps,
            "simulated": 1.0,
            "elements": round(2 / element),
        }
        (job.folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
        return ""


def line(case, times: np.ndarray) -> dict[str, np.ndarray]:
    return {"bit_speed": times}


def run_study(case_file: Path, out: Path, stub: Stub, **more):
    return study(
        case_file,
        "time-step",
        values=["40 ms", "0.02", "0.01"],
        repeats=2,
        out=out,
        run=stub,
        exact=line,
        say=lambda text: None,
        **more,
    )


def test_a_study_by_a_stub(case_file, tmp_path):
    """Errors h^2: order 2 exactly; seconds 1/h: an error of 0.001 costs 1/sqrt(0.001) s."""
    result = run_study(case_file, tmp_path / "out", stub := Stub())
    assert len(stub.calls) == 1 + 3 * 2  # the pilot, and two repeats of each point
    assert [row["error_bit_speed_max"] for row in result.rows] == pytest.approx([1.6e-3, 4e-4, 1e-4])
    assert result.findings["cpu_seconds_at_rms_error"]["bdf2-fixed"]["bit_speed"]["0.001"]["how"] == "below"
    assert {f.name for f in result.files} == {"study.csv", "study.json", "work_precision.png", "orders.png"}
    assert all(f.stat().st_size > 0 for f in result.files)
    assert not result.useless


def test_a_mesh_study_by_a_stub(case_file, tmp_path):
    """Errors C h^4, elements of 2 m to 0.5 m; Richardson from separate runs at 0.5, 0.25 and 0.125 m finds
    the limit and the order."""
    result = study(
        case_file,
        "mesh",
        values=[4, 2, 1],
        repeats=1,
        out=tmp_path / "out",
        run=(stub := Stub(mesh=1e-3)),
        reference="bdf2",
        say=lambda text: None,
    )
    assert "Richardson" in result.findings["reference"]["what"]
    assert result.findings["reference"]["mesh_order"]["bit_speed"] == pytest.approx(4.0, abs=1e-6)
    assert [row["error_bit_speed_max"] for row in result.rows] == pytest.approx(
        [16e-3, 1e-3, 1e-3 / 16], rel=1e-6
    )
    assert result.findings["orders"]["mesh"]["bit_speed"]["max"]["order"] == pytest.approx(4.0, abs=1e-6)
    assert (
        sum("reference" in folder for folder in stub.calls) == 3
    )  # none of the points stands for the reference


def test_ranks_are_compared_with_a_separate_run_on_one(case_file, tmp_path):
    result = study(
        case_file,
        "ranks",
        values=[1, 2],
        repeats=1,
        out=tmp_path / "out",
        run=(stub := Stub()),
        say=lambda text: None,
    )
    assert stub.ranks == [1, 1, 1, 2]  # pilot, reference, points
    assert result.findings["speed_up"] == {"1": 1.0, "2": 1.0}
    assert [row["error_bit_speed_max"] for row in result.rows] == [0.0, 0.0]
    assert [f.name for f in result.files] == ["study.csv", "study.json", "speed_up.png"]


def test_a_restart_keeps_finished_runs(case_file, tmp_path):
    out = tmp_path / "out"
    first = Stub(fails="0.01s")
    result = run_study(case_file, out, first)
    assert [row["status"] for row in result.rows] == ["done", "done", "failed"]
    assert result.rows[2]["message"].startswith("Newton's method failed; where: time 0.5 s")
    assert "failed" in (out / "study.csv").read_text(encoding="utf-8")
    again = Stub()
    result = run_study(case_file, out, again, restart=True)
    assert len(again.calls) == 2  # the two repeats of the point that had failed
    assert [row["status"] for row in result.rows] == ["done"] * 3
    case_file.write_text(CASE.replace("10 rad/s", "11 rad/s"), encoding="utf-8")
    other = Stub()
    run_study(case_file, out, other, restart=True)
    assert len(other.calls) == 7  # of another case nothing is kept


def test_a_study_with_failed_points_only_is_useless_and_still_reported(case_file, tmp_path):
    result = run_study(case_file, tmp_path / "out", Stub(fails="run"))
    assert result.useless
    assert result.failed == 3
    assert {f.name for f in result.files} >= {"work_precision.png"}  # a picture of crosses
    assert (tmp_path / "out" / "study.csv").is_file()


def test_reference_is_finer_than_the_points(case_file):
    """Points with tolerances 1e-3 and 1e-5: the smallest is 1e-5. Points with steps of 20 and 5 ms only: 5 ms
    is half the interval of the rows, which replaces the mean step, so the tolerance is 1e-3/2^3."""
    from drillpetsc.studies.convergence.plan import finest_tolerance

    base = read_base(case_file, {})
    assert (
        finest_tolerance(
            plan_of("tolerance", base, ["1e-3", "1e-5"]) + plan_of("time-step", base, ["1 ms"]), base
        )
        == 1e-5
    )
    assert finest_tolerance(plan_of("time-step", base, ["0.02", "5 ms"]), base) == pytest.approx(1e-3 / 8)


@each_row("far, expected", [({"arkimex"}, "bdf3"), ({"arkimex", "bdf3", "bdf2"}, "bdf2"), (set(), "arkimex")])
def test_a_reference_is_accepted_by_its_estimated_error(far, expected, monkeypatch):
    """A reference far from its control run is rejected; if all are, the one with the smallest error is taken
    (bdf2 here)."""
    from types import SimpleNamespace

    from drillpetsc.studies.convergence import reference as study_reference
    from drillpetsc.studies.convergence.reference import CONTROL_TOLERANCE_FACTOR, Reference, _integrated

    t = np.linspace(0.0, 1.0, 11)
    off = {"arkimex": 0.5, "bdf3": 0.4, "bdf2": 0.3}

    def of_run(runs, point, description, limit=None):
        name = description.split(",")[0]
        control = description.endswith(f"{CONTROL_TOLERANCE_FACTOR * 1e-5:.3g}")
        values = {"wob": t + (off[name] * control if name in far else 0.0), "energy_error": t - control}
        return Reference(t, values, description)  # columns about the computation play no part

    monkeypatch.setattr(study_reference, "_of_run", of_run)
    monkeypatch.setattr(
        study_reference,
        "finest_tolerance",
        lambda points, base: 1e-5 / study_reference.REFERENCE_TOLERANCE_FACTOR,
    )
    runs = SimpleNamespace(
        base=SimpleNamespace(history_every=0.1, own_options={}), say=lambda line: None, limit=1.0
    )
    found = _integrated(runs, [], ("arkimex", "bdf3", "bdf2"))
    assert found is not None and found.description.startswith(f"separate run by {expected}")
