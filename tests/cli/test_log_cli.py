"""`drillpetsc import log`: a planted log to states, points and a page, and points to `calibrate`."""

from __future__ import annotations

import json

import numpy as np
import pytest

import drillpetsc
from drillpetsc.case.files.measured_file import read_measured
from drillpetsc.cli import main
from drillpetsc.errors import CaseError
from drillpetsc.output.files.tables import read_table
from tests.helpers.command import main_succeeds


@pytest.fixture
def log(tmp_path):
    """A log of drilling, 1000 to 1020 m, a hook load of 100 t and a torque of 12 kN m."""
    rows = ["md_m,hookload_t,torque_kNm,rpm,flow_in_lpm,rop_m_per_h,who"]
    rows += [f"{1000 + 0.1 * i},{100 + 0.1 * (i % 3)},12,120,2000,20,me" for i in range(200)]
    path = tmp_path / "rig.csv"
    path.write_text("\n".join(rows))
    return path


def test_import_log_writes_its_folder(log, tmp_path, capsys):
    out = tmp_path / "out"
    main_succeeds("import", "log", log, "--out", out, "--every", "5m")
    text = capsys.readouterr().out
    assert "200 rows by depth" in text and "not used: who" in text and "drilling 200" in text
    assert {q.name for q in out.iterdir() if q.suffix != ".parquet"} == {
        "log.csv",
        "states.csv",
        "points.csv",
        "quality.json",
        "log.html",
    }
    table = read_table(out / "log.csv")
    np.testing.assert_allclose(table["hook_load [N]"][:3], np.array([100, 100.1, 100.2]) * 9806.65)
    readings, _ = read_measured(str(out / "points.csv"))
    assert [round(q.values["bit_depth"]) for q in readings] == [1002, 1007, 1012, 1017]
    assert (
        readings[0].values["torque"] == pytest.approx(12e3) and readings[0].values["operation"] == "drilling"
    )
    quality = json.loads((out / "quality.json").read_text())
    assert quality["states"] == {"drilling": 200} and quality["unused"] == ["who"]
    page = (out / "log.html").read_text()
    assert "data:image/png;base64," in page and "http" not in page.replace("http-equiv", "")
    assert main(["import", "log", str(log), "--out", str(out)]) == 2
    assert "--overwrite" in capsys.readouterr().err


def test_a_log_without_points_is_doubtful(tmp_path, capsys):
    """Rows that hang make no points, and trips none without the hook load in slips; the log of the other tests does."""
    head = "time_s,bit_md_m,hole_md_m,hookload_t,rpm,flow_in_lpm\n"
    still = [f"{10 * i},1000,1500,100,0,0" for i in range(30)]
    trips = [f"{10 * i},{1000 + 5 * i},1500,100,0,0" for i in range(30)]
    for rows, why in (
        (still, "no row trips, drills or rotates off bottom"),
        (trips, "the hook load in slips"),
    ):
        (tmp_path / "rig.csv").write_text(head + "\n".join(rows))
        out = tmp_path / "out"
        main_succeeds("import", "log", tmp_path / "rig.csv", "--out", out, "--overwrite")
        text = capsys.readouterr().out
        assert "WARNING: the log makes no points for calibrate" in text and why in text
        assert any(why in q for q in json.loads((out / "quality.json").read_text())["warnings"])


def test_rows_below_the_hole_of_the_case_have_no_weight(tmp_path):
    """Half of the rows are below a case of 1010 m: the others show the size of the hook load, and the log is read."""
    case = {
        "well": {
            "survey": {"md": ["0 m", "1010 m"], "inclination": ["0 deg"] * 2, "azimuth": ["0 deg"] * 2},
            "sections": [{"kind": "open_hole", "diameter": "216 mm"}],
        },
        "string": [{"kind": "pipe", "length": "1010 m", "od": "127 mm", "id": "108.6 mm"}],
        "top": "clamped",
    }
    rows = ["md_m,hookload_t,torque_kNm,rpm,rop_m_per_h"]
    rows += [f"{1000 + 0.1 * i},30,12,120,20" for i in range(200)]
    (tmp_path / "rig.csv").write_text("\n".join(rows))
    found = drillpetsc.import_log(tmp_path / "rig.csv", case=drillpetsc.Case(**case), out=tmp_path / "out")
    assert found.states.count() == {"drilling": 200}
    (tmp_path / "rig.csv").write_text("\n".join(rows).replace(",30,", ",3000,"))
    with pytest.raises(CaseError, match="times the computed weight"):
        drillpetsc.import_log(tmp_path / "rig.csv", case=drillpetsc.Case(**case), out=tmp_path / "other")


@pytest.mark.parametrize(
    "head, moment", [("time", "2026-01-01T06:00:{:02d}"), ("Date,Time", "2026-01-01,06:00:{:02d}")]
)
def test_a_log_with_clock_times(tmp_path, head, moment):
    """The table and the page of a log by time, whose clock times are words."""
    rows = [head + ",bit_md_m,hookload_kN,rpm"]
    rows += [moment.format(i) + f",{1000 - 0.3 * i:.1f},600,0" for i in range(40)]
    (tmp_path / "rig.csv").write_text("\n".join(rows))
    found = drillpetsc.import_log(tmp_path / "rig.csv", out=tmp_path / "out")
    assert found.states.count() == {"trip_out": 38, "unknown": 2}
    assert read_table(tmp_path / "out" / "log.csv")["clock [-]"][-1] == "2026-01-01T06:00:39+00:00"


def test_import_log_in_python(log, tmp_path):
    """The function writes what the command writes, and returns log, states, points and checks."""
    found = drillpetsc.import_log(log, out=tmp_path / "out", every="5m")
    assert len(found.points) == 4 and found.states.count() == {"drilling": 200}
    assert (tmp_path / "out" / "log.html").exists() and not any("WARNING" in q for q in found.lines)
    with pytest.raises(CaseError, match="--every"):
        drillpetsc.import_log([log], out=tmp_path / "other", every="5 kg")


def test_a_data_frame_of_the_log(log, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    main_succeeds("import", "log", log, "--out", tmp_path / "out")
    table = parquet.read_table(tmp_path / "out" / "log.parquet")
    np.testing.assert_array_equal(table["torque [N m]"].to_numpy(), np.full(200, 12e3))
    assert set(table["state [-]"].to_pylist()) == {"drilling"}


def test_refusals_name_the_option(log, tmp_path, capsys):
    wrong = []
    for words, text in (
        (["--every", "10"], "--every"),
        (["--set", "fluid=off"], "--case"),
        (["--map", "hook=who"], "--map"),
        (["--states", "x=1"], "--states"),
        (["--between", "1 kg,2 kg"], "--between"),
        (["--case", str(tmp_path / "none.yaml")], "a case file that exists"),
    ):
        status = main(["import", "log", str(log), "--out", str(tmp_path / "new"), *words])
        shown = capsys.readouterr().err
        if status != 2 or text not in shown or (tmp_path / "new").exists():
            wrong.append((words, shown))
    assert not wrong
    assert main(["import", "log", str(tmp_path / "no.csv")]) == 2


def test_calibrate_reads_a_log_and_its_points(tmp_path, capsys):
    """The same fit from the log itself and from points.csv; options that make no sense are refused by their name."""
    case = tmp_path / "case.yaml"
    case.write_text(
        """
well: {survey: {md: [0, 600, 900, 1100], inclination: [0 deg, 0 deg, 60 deg, 60 deg], azimuth: [0 deg, 0 deg, 0 deg, 0 deg]},
  sections: [{to: 700 m, kind: casing, diameter: 224 mm, friction: 0.2}, {to: end, kind: open_hole, diameter: 216 mm, friction: 0.3}]}
string: [{kind: pipe, length: 1100 m, od: 127 mm, id: 108.6 mm}]
top: clamped
rig: {block_weight: 300 kN}
"""
    )
    rng = np.random.default_rng(3)
    rows = ["md_m,hookload_kN,torque_kNm,rpm,rop_m_per_h,wob_kN,tob_kNm"]
    for i in range(400):
        torque = 2.2 + 0.001 * i + 0.02 * rng.standard_normal()
        rows.append(f"{1000 + 0.2 * i:.1f},{520 + 0.03 * i:.2f},{torque:.3f},120,20,20,1")
    log = tmp_path / "rig.csv"
    log.write_text("\n".join(rows))
    out = [tmp_path / name for name in ("points", "a", "b")]
    main_succeeds("import", "log", log, "--case", case, "--out", out[0], "--every", "2m")
    main_succeeds("calibrate", case, "--log", log, "--every", "2m", "--fit", "open_hole", "--out", out[1])
    main_succeeds(
        "calibrate", case, "--measured", out[0] / "points.csv", "--fit", "open_hole", "--out", out[2]
    )
    first, second = (json.loads((folder / "summary.json").read_text()) for folder in out[1:])
    assert (
        first["fit"] == second["fit"]
        and first["fit"]["open_hole"]["value"] is not None
        and first["errors"] == "correlated"
    )
    capsys.readouterr()
    wrong = []
    for words, text in (
        (["--log", str(log), "--measured", str(out[0] / "points.csv")], "either --log or --measured"),
        (["--log", str(log), "--prior", "cased=0.2"], "--prior"),
        (["--log", str(log), "--prior", "nothing=0.2+-0.1"], "--prior"),
        (["--log", str(log), "--hold-out", "2"], "--hold-out"),
        (["--log", str(log), "--every", "5s"], "--every"),
    ):
        status = main(["calibrate", str(case), "--out", str(tmp_path / "d"), *words])
        shown = capsys.readouterr().err
        if status != 2 or text not in shown or (tmp_path / "d").exists():
            wrong.append((words, status, shown))
    assert not wrong
