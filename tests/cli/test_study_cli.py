"""drillpetsc study from the command line, and `run --mesh-error`: small real runs against a closed form."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from drillpetsc.studies.convergence.study import study
from tests.helpers.command import drillpetsc, succeeds

INERTIA, STIFFNESS, SPEED, RAMP = 2.0, 800.0, 3.0, 0.6  # [kg m2], [N m/rad], [rad/s], [s]
#: a disc of inertia J on a shaft of stiffness k, almost without inertia, turned from above
CASE = f"""
title: Disc on a shaft
string:
  - {{kind: beam, length: 1 m, axial_stiffness: 1e6, bending_stiffness: 1e4, torsional_stiffness: {STIFFNESS}, mass: 1, polar_inertia: 1e-9,
     element_length: 1 m}}
  - {{kind: body, length: 0.1 m, mass: 10, inertia: {{axial: {INERTIA}, transverse: 1}}}}
top: {{kind: top_drive, rotation: {{ramp: {RAMP} s, value: {SPEED}}}}}
bottom: free
gravity: 0
time: {{end: {RAMP} s}}
output: {{history_every: 0.01 s}}
"""


@pytest.fixture
def case_file(tmp_path) -> Path:
    file = tmp_path / "disc.yaml"
    file.write_text(CASE, encoding="utf-8")
    return file


def disc(case, t: np.ndarray) -> dict[str, np.ndarray]:
    """Speed w of the disc: w'' + q^2 w = q^2 W (1 - cos a t)/2, q^2 = k/J, a = pi/ramp, at rest at first:
    w = W/2 [1 - cos qt - q^2/(q^2 - a^2) (cos at - cos qt)]."""
    q, a = np.sqrt(STIFFNESS / INERTIA), np.pi / RAMP
    return {
        "bit_speed": SPEED / 2 * (1 - np.cos(q * t) - q**2 / (q**2 - a**2) * (np.cos(a * t) - np.cos(q * t)))
    }


def test_order_of_bdf2_is_seen(case_file, tmp_path):
    """Disc that a shaft drags along (period 0.31 s), fixed steps of 4, 2 and 1 ms: order 2 within 0.2 of
    BDF2, and its confidence interval is reported."""
    result = study(
        case_file,
        "time-step",
        values=["4 ms", "2 ms", "1 ms"],
        repeats=1,
        out=tmp_path / "out",
        exact=disc,
        say=lambda line: None,
    )
    assert result.failed == 0
    order = result.findings["orders"]["bdf2-fixed"]["bit_speed"]["rms"]
    assert order["points"] == 3
    assert order["order"] == pytest.approx(2.0, abs=0.2)
    assert order["low"] < order["order"] < order["high"]
    assert [row["steps"] for row in result.rows] == [150, 300, 600]
    assert all(row["residuals"] >= row["newton_iterations"] > 0 for row in result.rows)


def test_curve_against_a_run_of_another_integrator(case_file, tmp_path):
    """`--curves`: the reference is a run by BDF3 and reports its own error, smaller than those of the points; a
    tolerance 100 times smaller gives a smaller error."""
    out = tmp_path / "out"
    words = "--curves bdf2 --few --repeats 1 --outputs bit_speed --reference bdf3 -ts_max_steps 100000"
    succeeds(f"study {case_file} {words} --out {out}", cwd=tmp_path)
    reported = json.loads((out / "study.json").read_text(encoding="utf-8"))
    assert "bdf3" in reported["reference"]["what"]
    table = read_table(out / "study.csv")
    assert list(table["curve [-]"]) == ["bdf2"] * 3
    errors = table["error_bit_speed_rms [-]"]
    assert errors[2] < errors[0]
    assert 0 < reported["reference"]["own_error"]["bit_speed"] < errors[2]
    assert (out / "orders.png").is_file()


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        ("--vary wind", 2, "time-step | tolerance"),
        ("", 2, "either --vary or --curves"),
        ("--vary time-step --values '10 kg'", 2, "--values"),
        ("--vary tolerance --limit -1", 2, "seconds, above 0"),
        ("--vary tolerance --outputs bit_sped", 2, "nearest: bit_speed"),
        ("--vary tolerance --values 1e-3 -ts_bdf_ordr 2 --repeats 1 --reference bdf2", 1, "ts_bdf_ordr"),
    ],
)
def test_exit_status(case_file, tmp_path, words, status, message):
    """2 for bad input with nothing written; 1 where every run fails, with the reason in its point."""
    done = drillpetsc(f"study {case_file} {words} --out out", cwd=tmp_path)
    assert done.returncode == status
    assert message in done.stderr + done.stdout
    assert (tmp_path / "out" / "study.csv").exists() == (status == 1)


def test_run_states_time_and_mesh_error(tmp_path):
    """A shaft that turns with its inertia, 8 elements against 4: differences of bit speed are stated as
    shares of its range, and the time error of the spin angle is of the size of the tolerance times its usual
    size."""
    file = tmp_path / "shaft.yaml"
    file.write_text(
        CASE.replace("polar_inertia: 1e-9", "polar_inertia: 2").replace(
            "element_length: 1 m", "element_length: 0.125 m"
        ),
        encoding="utf-8",
    )
    done = succeeds("run shaft.yaml --out out --mesh-error --progress silent -ts_rtol 1e-5", cwd=tmp_path)
    assert "mesh, against elements twice as long" in done.stdout
    reported = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["error_estimate"]
    assert reported["mesh"]["elements"] == 4
    folders = tmp_path / "out", tmp_path / "out" / "coarse-mesh"
    fine, coarse = (read_table(folder / "history.csv")["bit_speed [rad/s]"] for folder in folders)
    column = reported["mesh"]["columns"]["bit_speed [rad/s]"]
    assert column["range"] == pytest.approx(np.ptp(fine))
    assert column["max"] == pytest.approx(np.abs(fine - coarse).max() / np.ptp(fine))
    spin = reported["time"]["unknowns"]["string.spin"]
    assert 0.1 * 1e-5 * spin["usual_size"] < spin["largest_step"] < 10 * 1e-5 * spin["usual_size"]
    assert spin["largest_step"] <= spin["sum"]
    assert spin["net"] <= spin["sum"]


def test_run_checks_its_tolerance(case_file, tmp_path):
    """`run --check-tolerance` with a tolerance of the command line: the fine run has a tenth of it, and the report
    says what would change, or that nothing does."""
    for tolerance, verdict in (("5e-2", "not fine enough"), ("1e-6", "the same classes of motion")):
        words = f"--out {tolerance} --check-tolerance --progress silent -ts_rtol {tolerance}"
        done = succeeds(f"run {case_file} {words}", cwd=tmp_path)
        assert verdict in done.stdout
        fine = json.loads((tmp_path / tolerance / "fine-tolerance" / "summary.json").read_text("utf-8"))
        assert float(fine["petsc_options"]["ts_rtol"]) == pytest.approx(float(tolerance) / 10)
        assert fine["motion"][-1]["rotation"] == "turns"
