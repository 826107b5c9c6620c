"""`drillpetsc follow` as a program: a file that grows, standard input, a feed that stops."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time

import pytest

from drillpetsc.cli import main
from drillpetsc.output.files.tables import read_table

CASE = """
title: a short string
rig: {block_weight: 300 kN, max_hookload: 900 kN, max_surface_torque: 30 kN m}
well:
  survey: {md: [0 m, 300 m, 900 m], inclination: [0 deg, 0 deg, 40 deg], azimuth: [0 deg, 0 deg, 0 deg]}
  sections: [{kind: casing, to: 300 m, diameter: 311 mm, friction: 0.2}, {kind: open_hole, to: end, diameter: 216 mm, friction: 0.25}]
bit_depth: 900 m
string:
  - {kind: pipe, length: fill, od: 127 mm, id: 108.6 mm}
  - {kind: drill_collar, length: 60 m, od: 165 mm, id: 71 mm}
top: {kind: top_drive, rotation: 100 rpm}
bottom: bit
"""
HEAD = "time [s],bit depth [m],hole depth [m],hook load [kN],torque [kN m],rpm,flow in [l/min]"


def lines() -> list[str]:
    """A trip out at 5 s: eight stands of 28 m, 70 s each, then 70 s in slips."""
    out, depth = [HEAD], 890.0
    for i in range(8 * 28):
        pulled = i % 28 < 14
        depth -= 2.0 if pulled else 0.0
        out.append(f"{5 * i},{depth},900,{640 + 3 * (i % 3) if pulled else 300},0,0,0")
    return out


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "case.yaml").write_text(CASE)
    (tmp_path / "rig.csv").write_text("\n".join(lines()) + "\n")
    return tmp_path


def start(folder, *words: str, **keywords) -> subprocess.Popen:
    command = [sys.executable, "-m", "drillpetsc", "follow", str(folder / "case.yaml"), *words]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ, **keywords
    )


def test_standard_input_gives_what_the_file_gives(folder):
    assert (
        main(
            [
                "follow",
                str(folder / "case.yaml"),
                "--log",
                str(folder / "rig.csv"),
                "--out",
                str(folder / "file"),
            ]
        )
        == 0
    )
    piped = start(folder, "--log", "-", "--out", str(folder / "pipe"), stdin=subprocess.PIPE)
    said, error = piped.communicate("\n".join(lines()) + "\n", timeout=120)
    assert piped.returncode == 0, error
    assert (folder / "pipe" / "follow.csv").read_bytes() == (folder / "file" / "follow.csv").read_bytes()
    table = read_table(folder / "file" / "follow.csv")
    assert (table["operation [-]"] == "trip_out").sum() == 8 and (
        table["operation [-]"] == "in_slips"
    ).sum() == 8
    assert table["block_weight [N]"][-1] == pytest.approx(300e3, abs=3e3)
    assert "alarms:" in said


def test_a_file_that_grows(folder):
    """Half of the rows, then the others: the page and the state are there before the feed ends."""
    rows, log, out = lines(), folder / "growing.csv", folder / "out"
    log.write_text("\n".join(rows[:210]) + "\n")
    process = start(folder, "--log", str(log), "--out", str(out), "--wait", "4 s")
    try:
        deadline = time.monotonic() + 60
        while not (out / "state.json").exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        assert json.loads((out / "state.json").read_text())["feed"] == "running"
        with open(log, "a") as file:
            file.write("\n".join(rows[210:]))  # the last line has no end
        said, error = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 0, error
    assert "224 rows" in said or "223 rows" in said
    assert "feed: " in (out / "live.html").read_text()


def test_a_missing_block_weight_and_a_missing_log(folder, capsys):
    words = ["follow", str(folder / "case.yaml"), "--out", str(folder / "no"), "--log"]
    (folder / "case.yaml").write_text(CASE.replace("block_weight: 300 kN, ", ""))
    assert main([*words, str(folder / "rig.csv")]) == 2
    assert "rig.block_weight" in capsys.readouterr().err
    assert main([*words, str(folder / "none.csv")]) == 2
    assert "--log" in capsys.readouterr().err and not (folder / "no").exists()
