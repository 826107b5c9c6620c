"""`drillpetsc follow --log witsml:..`: a small WITSML 1.4.1.1 store on this machine that grows, breaks, repeats and wants a password."""

from __future__ import annotations

import base64
import json
import threading
from collections.abc import Callable, Iterator
from datetime import datetime, timedelta
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.metadata import EntryPoint
from xml.etree import ElementTree
from xml.sax.saxutils import escape

import numpy as np
import pytest

from drillpetsc.analysis.follow import readers
from drillpetsc.cli import main
from drillpetsc.logs import witsml_store
from drillpetsc.output.files.tables import read_table
from tests.cli.test_follow_cli import CASE, lines
from tests.helpers.command import main_succeeds

SPACE = "http://www.witsml.org/schemas/1series"
NAMES = "TIME,DBTM,DMEA,HKLD,TQA,RPM,TFLO"
UNITS = "s,m,m,kN,kN.m,rpm,L/min"
UIDS = "well=W-1&wellbore=B-1&log=L%201"
USER, SECRET = "driller", "pass:word-7"


def rows() -> list[str]:
    """The trip of the text log, with a clock."""
    first, out = datetime(2026, 11, 27, 6), []
    for line in lines()[1:]:
        t, rest = line.split(",", 1)
        out.append(f"{(first + timedelta(seconds=float(t))).isoformat()}.000Z,{rest}")
    return out


def document(data: list[str], kind: str = "date time", names: str = NAMES, units: str = UNITS) -> str:
    """A document with one log."""
    curves = "".join(
        f"<logCurveInfo uid='{n}'><mnemonic>{n}</mnemonic><unit>{u}</unit></logCurveInfo>"
        for n, u in zip(names.split(","), units.split(","), strict=True)
    )
    body = "".join(f"<data>{q}</data>" for q in data)
    table = (
        f"<logData><mnemonicList>{names}</mnemonicList><unitList>{units}</unitList>{body}</logData>"
        if data
        else ""
    )
    return (
        f'<logs xmlns="{SPACE}" version="1.4.1.1"><log uidWell="W-1" uidWellbore="B-1" uid="L 1"><objectGrowing>true</objectGrowing>'
        f"<indexType>{kind}</indexType><direction>increasing</direction><nullValue>-999.25</nullValue>{curves}{table}</log></logs>"
    )


def answer(text: str, result: int = 1, said: str = "") -> bytes:
    return (
        '<soap:Envelope xmlns:soap="http://schemas.xmlsoap.org/soap/envelope/"><soap:Body>'
        f'<m:WMLS_GetFromStoreResponse xmlns:m="http://www.witsml.org/message/120"><Result>{result}</Result>'
        f"<XMLout>{escape(text)}</XMLout><SuppMsgOut>{said}</SuppMsgOut></m:WMLS_GetFromStoreResponse></soap:Body></soap:Envelope>"
    ).encode()


class Store:
    """A store; acts: what it does at each call, the last one again and again.  starts: the indices that were asked for."""

    def __init__(self) -> None:
        self.acts: list[Callable[[str], bytes | int | None]] = []
        self.starts: list[str] = []
        self.headers: list[str | None] = []
        store = self

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self) -> None:
                call = ElementTree.fromstring(self.rfile.read(int(self.headers["Content-Length"])))
                query = ElementTree.fromstring(call.findtext(".//QueryIn") or "")
                log = query[0]
                assert (
                    self.headers["SOAPAction"].endswith('WMLS_GetFromStore"')
                    and call.findtext(".//WMLtypeIn") == "log"
                )
                assert (log.get("uidWell"), log.get("uidWellbore"), log.get("uid")) == ("W-1", "B-1", "L 1")
                start = log[0].text or "" if len(log) else ""
                store.starts.append(start)
                store.headers.append(self.headers["Authorization"])
                act = store.acts.pop(0) if len(store.acts) > 1 else store.acts[0]
                said = act(start)
                if said is None:
                    self.connection.close()
                    return
                code, body = (200, said) if isinstance(said, bytes) else (said, b"")
                self.send_response(code)
                if 300 <= code < 400:
                    self.send_header("Location", "http://127.0.0.1:1/elsewhere")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_: object) -> None:
                pass

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.name = f"witsml:http://127.0.0.1:{self.server.server_port}/store?{UIDS}"


def grown(end: int, most: int = 10**6, repeat: int = 0) -> Callable[[str], bytes]:
    """The rows up to ``end`` from the index on, at most some, after some that were sent before."""

    def act(start: str) -> bytes:
        here = [q for q in rows()[:end] if q.split(",")[0] >= start]
        first = end - len(here)
        data = rows()[max(first - repeat, 0) : first] + here[:most]
        return answer(document(data), 1 if len(here) <= most else 2)

    return act


@pytest.fixture
def store(monkeypatch) -> Iterator[Store]:
    """A store that is polled without a pause."""
    monkeypatch.setattr(readers, "POLLED_EACH", 0.01)
    monkeypatch.setenv("no_proxy", "127.0.0.1")
    monkeypatch.delenv(witsml_store.USER, raising=False)
    monkeypatch.setenv("NETRC", "/nonexistent")
    found = Store()
    threading.Thread(target=found.server.serve_forever, args=(0.02,), daemon=True).start()
    yield found
    found.server.shutdown()
    found.server.server_close()


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "case.yaml").write_text(CASE)
    (tmp_path / "whole.xml").write_text(document(rows()))
    return tmp_path


def follow(folder, name: str, out: str, *words: str) -> dict:
    main_succeeds("follow", folder / "case.yaml", "--log", name, "--out", folder / out, *words)
    return json.loads((folder / out / "summary.json").read_text())


def same(folder, one: str, other: str) -> None:
    """The tables are equal to 1e-6."""
    table, found = (read_table(folder / q / "follow.csv") for q in (one, other))
    assert table.keys() == found.keys() and len(table["row [-]"]) == len(found["row [-]"]) > 12
    for name, column in table.items():
        if column.dtype.kind == "f":
            assert found[name] == pytest.approx(column, rel=1e-6, nan_ok=True), name
        else:
            assert (found[name] == column).all(), name


def test_a_store_gives_what_the_file_gives(folder, store):
    """The log grows, comes in parts, is empty for a while, repeats ten rows, breaks three times in three ways."""
    store.acts = [
        grown(40),
        grown(90, 20),
        grown(90, 20),
        grown(90),
        lambda _: answer(document([])),
        lambda _: 503,
        lambda _: None,
    ]
    store.acts += [lambda _: b"<html>busy", grown(150, repeat=10), grown(224), grown(224)]
    follow(folder, str(folder / "whole.xml"), "file")
    summary = follow(folder, store.name, "store", "--wait", "2 s")
    same(folder, "file", "store")
    assert summary["rows"] == 224 and not summary["rows_left_out"]
    assert store.starts[:3] == ["", "2026-11-27T06:03:15.000Z", "2026-11-27T06:04:50.000Z"]
    notes = " ".join(summary["notes"])
    assert "3 polls of the store failed" in notes and "10 rows that the store repeated" in notes


def test_without_wait_it_ends_with_the_rows_at_hand(folder, store):
    store.acts = [grown(224, 50)]
    summary = follow(folder, store.name, "store")
    assert summary["rows"] == 224 and summary["feed"] == "ended" and len(store.starts) == 6


def test_a_store_that_stops_answering_and_a_restart(folder, store, capsys):
    """Without --wait three failures end the log, which is said; --restart asks from the last row on."""
    store.acts = [grown(100), lambda _: 503]
    summary = follow(folder, store.name, "store")
    assert summary["rows"] == 100 and summary["feed"] == "ended (HTTP 503 Service Unavailable)"
    store.acts = [grown(224)]
    count = len(store.starts)
    follow(folder, store.name, "store", "--restart")
    assert store.starts[count] == "2026-11-27T06:08:15.000Z"
    follow(folder, str(folder / "whole.xml"), "file")
    same(folder, "file", "store")


def test_a_log_by_depth(folder, store):
    """The index of a log by depth is asked for with its unit; the repeated last row counts once."""
    names, units = "DEPT,HKLD,TQA,RPM,SWOB", "m,kN,kN.m,rpm,kN"
    data = [f"{700 + 0.25 * i},{550 + i % 3},{4 + 0.1 * (i % 5)},100,20" for i in range(400)]
    (folder / "whole.xml").write_text(document(data, "measured depth", names, units))

    def act(start: str) -> bytes:
        here = [q for q in data if not start or float(q.split(",")[0]) >= float(start)]
        return answer(document(here[:80], "measured depth", names, units), 1 if len(here) <= 80 else 2)

    store.acts = [act]
    summary = follow(folder, store.name, "store")
    follow(folder, str(folder / "whole.xml"), "file")
    same(folder, "file", "store")
    assert summary["rows"] == 400 and store.starts[:3] == ["", "719.75", "739.5"]


@pytest.mark.parametrize("where", ["environment", "netrc"])
def test_user_and_password_stay_secret(folder, store, monkeypatch, where, capsys):
    """They go to the store alone, and stand in no file and no line of the screen."""
    token = base64.b64encode(f"{USER}:{SECRET}".encode()).decode()
    if where == "environment":
        monkeypatch.setenv(witsml_store.USER, USER)
        monkeypatch.setenv(witsml_store.PASSWORD, SECRET)
    else:
        (folder / "netrc").write_text(f"machine 127.0.0.1 login {USER} password {SECRET}\n")
        (folder / "netrc").chmod(0o600)
        monkeypatch.setenv("NETRC", str(folder / "netrc"))
    store.acts = [grown(224)]
    summary = follow(folder, store.name, "store")
    assert set(store.headers) == {f"Basic {token}"}
    assert any("unencrypted" in q for q in summary["notes"])
    said = capsys.readouterr()
    texts = [said.out, said.err, *(q.read_text() for q in (folder / "store").rglob("*") if q.is_file())]
    assert not any(secret in text for text in texts for secret in (SECRET, token))


BOMB = '<!DOCTYPE a [<!ENTITY b "x">]><logs/>'


@pytest.mark.parametrize(
    ("act", "said"),
    [
        (lambda _: 401, "DRILLPETSC_WITSML_USER"),
        (lambda _: 302, "HTTP 302"),
        (lambda _: None, "no answer"),
        (lambda _: answer("", -425, "no such thing"), "-425: no such thing"),
        (lambda _: answer(f'<logs xmlns="{SPACE}" version="1.4.1.1"/>'), "no log L 1"),
        (lambda _: answer(f'<logs xmlns="{SPACE}" version="1.3.1.1"/>'), "WITSML 1.4.1"),
        (lambda _: answer(document(rows()[:5], "elapsed time")), "elapsed time"),
        (lambda _: answer(BOMB), "DOCTYPE"),
        (lambda _: b"not XML", "not XML"),
        (lambda _: b"<e><Body><Fault><faultstring>tired</faultstring></Fault></Body></e>", "tired"),
        (lambda _: answer(document([])), "no row"),
    ],
)
def test_answers_that_are_no_log(folder, store, act, said, capsys):
    """Exit 2 with the reason; nothing is written."""
    store.acts = [act]
    assert main(["follow", str(folder / "case.yaml"), "--log", store.name, "--out", str(folder / "no")]) == 2
    assert said in capsys.readouterr().err and not (folder / "no").exists()


def test_a_store_that_is_slow_or_not_there(folder, store, monkeypatch, capsys):
    monkeypatch.setattr(witsml_store, "ANSWERS_WITHIN", 0.3)
    blocked = threading.Event()
    store.acts = [lambda _: 503 if blocked.wait(5) else None]
    command = ["follow", str(folder / "case.yaml"), "--out", str(folder / "no"), "--log"]
    assert main([*command, store.name]) == 2
    assert "timed out" in capsys.readouterr().err
    blocked.set()
    for name in (
        "witsml:rig",
        "witsml:ftp://rig/store?" + UIDS,
        "witsml:http://rig/store?well=1",
        f"witsml:http://rig:x/?{UIDS}",
        "witsml:http://rig:80/s",
    ):
        assert main([*command, name]) == 2
        assert "witsml:https://HOST/PATH" in capsys.readouterr().err
    assert main([*command, f"witsml:https://{USER}:{SECRET}@rig/store?{UIDS}"]) == 2
    said = capsys.readouterr().err
    assert "netrc" in said and SECRET not in said


class Rows:
    """A reader of an installed package: five minutes of a string in slips."""

    def __init__(self, name: str, mapping: dict, waits: bool) -> None:
        self.stream = readers.LogStream(name, mapping)
        self.ended, self.trouble, self.titles, self.start, self.left_out, self.remarks = (
            False,
            "",
            {},
            None,
            {},
            (),
        )

    def read(self):
        log = self.stream.rows(lines())
        self.titles, self.ended = self.stream.titles, True
        return log

    def position(self) -> dict:
        return {}

    def go_on_from(self, position: dict) -> None:
        pass


def test_a_reader_of_an_installed_package(folder, monkeypatch, capsys):
    """An entry point of the group drillpetsc.readers is found by the word before the colon; one that cannot be loaded is named."""
    points = [
        EntryPoint("slips", f"{__name__}:Rows", "drillpetsc.readers"),
        EntryPoint("lost", "nowhere:It", "drillpetsc.readers"),
    ]
    monkeypatch.setattr(
        readers, "entry_points", lambda group, name=None: [q for q in points if name in (None, q.name)]
    )
    (folder / "rig.csv").write_text("\n".join(lines()) + "\n")
    follow(folder, "slips:here", "own")
    follow(folder, str(folder / "rig.csv"), "file")
    same(folder, "file", "own")
    for name, said in (("lost:x", "nowhere:It"), ("none:x", "slips:..")):
        assert main(["follow", str(folder / "case.yaml"), "--log", name, "--out", str(folder / "no")]) == 2
        assert said in capsys.readouterr().err


def test_indices_are_ordered_by_time_and_by_depth():
    one, two = (
        witsml_store.place_of("2026-11-27T06:00:00.000Z"),
        witsml_store.place_of("2026-11-27T07:00:01+01:00"),
    )
    assert two - one == 1 and witsml_store.place_of("1e3") == 1000 and np.isnan(witsml_store.place_of("soon"))
