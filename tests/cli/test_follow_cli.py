"""`drillpetsc follow` as a program: a file that grows, standard input, a feed that stops."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import threading
import time

import pytest

from drillpetsc.analysis.follow import session
from drillpetsc.cli import main
from drillpetsc.output.files.tables import read_table
from tests.helpers.command import main_succeeds

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
    main_succeeds("follow", folder / "case.yaml", "--log", folder / "rig.csv", "--out", folder / "file")
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


def test_a_file_that_grows(folder, monkeypatch):
    """Half of the rows, then the others: the page and the state are there before the feed ends."""
    monkeypatch.setattr(session, "WRITTEN_EACH", 0.1)
    rows, log, out, feeds = lines(), folder / "growing.csv", folder / "out", list[str]()
    log.write_text("\n".join(rows[:210]) + "\n")

    def grow() -> None:
        deadline = time.monotonic() + 60
        while not (out / "state.json").exists() and time.monotonic() < deadline:
            time.sleep(0.02)
        feeds.append(json.loads((out / "state.json").read_text())["feed"])
        with open(log, "a") as file:
            file.write("\n".join(rows[210:]))  # the last line has no end

    growing = threading.Thread(target=grow)
    growing.start()
    main_succeeds("follow", folder / "case.yaml", "--log", log, "--out", out, "--wait", "2 s")
    growing.join()
    assert feeds == ["running"]
    assert json.loads((out / "summary.json").read_text())["rows"] in (223, 224)
    assert "feed: " in (out / "live.html").read_text()


def test_a_missing_block_weight_and_a_missing_log(folder, capsys):
    words = ["follow", str(folder / "case.yaml"), "--out", str(folder / "no"), "--log"]
    (folder / "case.yaml").write_text(CASE.replace("block_weight: 300 kN, ", ""))
    assert main([*words, str(folder / "rig.csv")]) == 2
    assert "rig.block_weight" in capsys.readouterr().err
    assert main([*words, str(folder / "none.csv")]) == 2
    assert "--log" in capsys.readouterr().err and not (folder / "no").exists()


def frames(system: str) -> list[str]:
    """The same trip as WITS frames: record 1 each 5 s, and record 9 of the same moment; units of IADC's specification."""
    foot, klbf, kdan = 0.3048, 4.4482216152605, 10.0
    length, force = (1.0, kdan) if system == "metric" else (foot, klbf)
    out = []
    for line in lines()[1:]:
        t, depth, hole, hook, torque, rpm, flow = map(float, line.split(","))
        clock = f"{int(t) // 3600:02d}{int(t) // 60 % 60:02d}{int(t) % 60:02d}"
        out += [
            "&&",
            "0101WELL",
            "0105261127",
            f"0106{clock}",
            f"0108{depth / length}",
            f"0110{hole / length}",
        ]
        out += [f"0114{hook / force}", f"0118{torque}", f"0120{rpm}", f"0130{flow}", "!!"]
        out += ["noise of the line", "&&", f"0917{0.0}", "!!"]
    return out


@pytest.fixture
def server():
    """A function that serves texts, one a connection, at a port of this machine; pieces end anywhere."""
    listener = socket.create_server(("127.0.0.1", 0))

    def serve(*texts: str) -> int:
        def run() -> None:
            for text in texts:
                connection = listener.accept()[0]
                with connection:
                    data = text.encode()
                    for i in range(0, len(data), 1777):
                        connection.sendall(data[i : i + 1777])

        threading.Thread(target=run, daemon=True).start()
        return listener.getsockname()[1]

    yield serve
    listener.close()


@pytest.mark.parametrize("system, breaks", [("metric", True), ("fps", False)])
def test_wits_frames_give_what_the_file_gives(folder, server, system, breaks):
    """A feed breaks in the middle of a frame, and the server repeats its last ten minutes: each row counts once."""
    case, rows = str(folder / "case.yaml"), frames(system)
    cut = rows.index("!!", len(rows) // 2) - 3 if breaks else len(rows)
    parts = [rows[:cut], rows[cut - 1500 :]] if breaks else [rows]
    port = server(*("\r\n".join(part) + "\r\n" * (part is parts[-1]) for part in parts))
    main(["follow", case, "--log", str(folder / "rig.csv"), "--out", str(folder / "file")])
    name = f"wits:127.0.0.1:{port}" + (":fps" if system == "fps" else "")
    wait = ["--wait", "2 s"] if breaks else []
    main_succeeds("follow", case, "--log", name, *wait, "--out", folder / "wits")
    table, other = (read_table(folder / q / "follow.csv") for q in ("file", "wits"))
    assert (table["operation [-]"] == other["operation [-]"]).all()
    for name in ("hook_load [N]", "cased [-]", "block_weight [N]", "time [s]"):
        assert other[name] == pytest.approx(table[name], rel=1e-6, nan_ok=True), name
    left = json.loads((folder / "wits" / "summary.json").read_text())["rows_left_out"]
    assert set(left) == ({"rows older than the row before"} if breaks else set())


def test_a_wits_feed_in_other_units_and_a_server_that_is_not_there(folder, server, capsys):
    case, out = str(folder / "case.yaml"), str(folder / "no")
    port = server("\r\n".join(frames("fps")) + "\r\n")
    assert main(["follow", case, "--log", f"wits:127.0.0.1:{port}", "--out", out]) == 2
    assert "feet" in capsys.readouterr().err
    free = socket.create_server(("127.0.0.1", 0))
    gone = free.getsockname()[1]
    free.close()
    for name, said in (
        (f"wits:127.0.0.1:{gone}", "WITS server"),
        ("wits:rig", "wits:HOST:PORT"),
        ("wits:rig:99999", "WITS"),
    ):
        assert main(["follow", case, "--log", name, "--out", out]) == 2
        assert said in capsys.readouterr().err
    assert not (folder / "no").exists()


def test_wits_frames_without_a_clock(folder, server):
    """The rows have the time of their arrival, and the summary says so."""
    rows = [q for q in frames("metric") if not q.startswith(("0105", "0106"))]
    port = server("\r\n".join(rows) + "\r\n")
    out = folder / "out"
    main_succeeds("follow", folder / "case.yaml", "--log", f"wits:127.0.0.1:{port}", "--out", out)
    notes = json.loads((out / "summary.json").read_text())["notes"]
    assert any("time of their arrival" in q for q in notes)


def test_a_wits_clock_that_jumps_ahead(folder, server):
    """One frame of 23:59:59: it alone is left out, and said; the others would all be older."""
    rows = frames("metric")
    places = [i for i, q in enumerate(rows) if q.startswith("0106")]
    rows[places[100]] = "0106235959"
    port = server("\r\n".join(rows) + "\r\n")
    out = folder / "out"
    main_succeeds("follow", folder / "case.yaml", "--log", f"wits:127.0.0.1:{port}", "--out", out)
    summary = json.loads((out / "summary.json").read_text())
    assert summary["rows"] == len(places) - 1 and not summary["rows_left_out"]
    assert any("jumped ahead" in q for q in summary["notes"])


def test_a_trip_out_to_the_rig(folder):
    """The bit comes above the rig: these rows are left out, and said."""
    rows = []
    for line in lines()[1:]:
        t, depth, rest = line.split(",", 2)
        rows.append(f"{t},{float(depth) - 710},{rest}")
    (folder / "rig.csv").write_text("\n".join([HEAD, *rows]) + "\n")
    main_succeeds("follow", folder / "case.yaml", "--log", folder / "rig.csv", "--out", folder / "out")
    warnings = json.loads((folder / "out" / "summary.json").read_text())["warnings"]
    assert len(warnings) == 1 and "no string at that bit depth" in warnings[0]
