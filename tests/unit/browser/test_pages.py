"""The pages in a real browser: what is drawn, followed and exported.  Left out on a machine without Chromium."""

from __future__ import annotations

import base64
import json
import re
import shutil
import threading
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.browser import page as page_module
from drillpetsc.browser import run_source
from drillpetsc.browser.case_form import CaseForm
from drillpetsc.browser.page import export_page
from drillpetsc.browser.run_source import RunSource
from drillpetsc.browser.server import Server, case_server
from drillpetsc.output import FieldWriter, read_frame, read_series
from tests.helpers import chromium
from tests.helpers.output_samples import helix_frame, make_pendulum

pytest.importorskip("plotly")
needs_browser = pytest.mark.skipif(chromium.program() is None, reason="no Chromium on this machine")


def drawn(page: chromium.Page, name: str, trace: int = 0, key: str = "y") -> np.ndarray:
    """Numbers of a curve as the page has drawn them."""
    return np.array(page.run(f"Array.from(document.getElementById('{name}').data[{trace}].{key})"))


def test_an_exported_page_has_every_number_and_loads_nothing(folder: Path) -> None:
    text, remarks = export_page(RunSource(folder, "metric"))
    assert remarks == []
    assert not re.search(r"(?:src|href)=\"(?!data:)", text.split("<script>")[0]), "nothing from elsewhere"
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    data = json.loads(found[1])
    assert [frame["time"] for frame in data["frames"]] == data["news"]["times"] == [0.0, 1.0, 2.0, 3.0]
    force = np.frombuffer(base64.b64decode(data["news"]["columns"]["hook_load [N]"]), "<f4")
    np.testing.assert_allclose(force, 800 + np.sin(np.linspace(0, 3, 101)), rtol=1e-6)
    for number, frame in enumerate(data["frames"]):
        offset = np.frombuffer(base64.b64decode(data["arrays"][frame["arrays"]["ox"]]), "<f4")
        expected = 1e3 * helix_frame(float(number))[1]["offset_x [m]"]
        np.testing.assert_allclose(offset, expected, rtol=1e-5, atol=1e-4)
    depths = {frame["arrays"]["md"] for frame in data["frames"]}
    assert len(depths) == 1, "what does not change is there once"


def test_a_large_export_leaves_frames_out_and_says_so(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = RunSource(folder)
    size = sum(map(len, source.frame(0)["arrays"].values()))
    monkeypatch.setattr(page_module, "MOST_BYTES", 2 * size)
    monkeypatch.setattr(run_source, "MOST_ROWS", 40)  # and a history that comes in parts
    text, remarks = export_page(source)
    assert remarks == ["2 of 4 frames, to keep the file small"]
    data = json.loads(text.split('id="data">')[1].split("</script>")[0])
    assert data["news"]["times"] == [0.0, 2.0] and [frame["number"] for frame in data["frames"]] == [0, 1]
    time = np.frombuffer(base64.b64decode(data["news"]["columns"]["time [s]"]), "<f8")
    np.testing.assert_allclose(time, np.linspace(0, 3, 101))
    assert data["news"]["first"] == 0 and not data["news"]["more"] and data["news"]["wall"]


def test_a_damaged_frame_is_left_out_of_an_export(folder: Path) -> None:
    (folder / "string" / "000001.vtu").write_text("<VTK")
    text, remarks = export_page(RunSource(folder))
    data = json.loads(text.split('id="data">')[1].split("</script>")[0])
    assert data["news"]["times"] == [0.0, 2.0, 3.0] and "000001.vtu" in remarks[0]
    assert remarks[1] == "damaged frames that are left out: 1"


def test_a_title_of_a_run_is_no_markup(folder: Path) -> None:
    (folder / "summary.json").write_text('{"title": "</script><b>bold</b>", "status": "done"}')
    text, _ = export_page(RunSource(folder))
    assert "<b>bold</b>" not in text and "\\u003c/script>" in text


@pytest.mark.slow
@needs_browser
def test_a_page_draws_and_follows_a_run(server: Server, folder: Path) -> None:
    with chromium.browser() as page:
        page.open(server.url)
        page.wait("state.now && document.querySelector('#histories .trace')")
        assert page.run("state.shown") == 3  # the last frame
        np.testing.assert_allclose(drawn(page, "histories"), 800 + np.sin(np.linspace(0, 3, 101)), rtol=1e-6)
        tracks = page.run("state.tracks")
        assert tracks[0] == "axial_force [N]"
        np.testing.assert_allclose(drawn(page, "tracks", key="x"), np.linspace(800, -50, 81), rtol=1e-5)
        # a straightened string: the centre of each ring is the offset of its node [mm]
        rings = drawn(page, "string", key="x").reshape(81, -1)
        offset = 1e3 * helix_frame(3.0)[1]["offset_y [m]"]
        np.testing.assert_allclose(rings.mean(axis=1), offset, atol=1e-2)
        np.testing.assert_allclose(np.ptp(rings, axis=1), 120.0, rtol=1e-4)  # the pipe's diameter
        page.run("view('true')")
        page.wait("state.view === 'true' && document.getElementById('string').data.length === 2")
        page.run("show(1)")
        page.wait("state.shown === 1")
        FieldWriter(folder, restart_time=10.0).write(4.0, *helix_frame(4.0))
        page.wait("state.times.length === 5", 20)
        assert page.run("state.shown") == 1  # the run is not being written: the page stays
        shutil.move(folder, folder.with_name("moved"))
        page.wait("document.getElementById('status').textContent.includes('gone')", 20)
        shutil.move(folder.with_name("moved"), folder)
        page.wait("state.rows === 101", 20)
        assert [text for text in page.said if "409" not in text] == []


@pytest.mark.slow
@needs_browser
def test_an_exported_page_plays_from_a_file(folder: Path, tmp_path: Path) -> None:
    file = tmp_path / "page.html"
    file.write_text(export_page(RunSource(folder, "field"))[0], encoding="utf-8")
    with chromium.browser() as page:
        page.open(file.as_uri(), 420, 900, dark=True)
        page.wait("state.now && document.querySelector('#histories .trace')")
        assert page.run("document.documentElement.scrollWidth") <= 420
        page.run("show(0)")
        page.wait("state.shown === 0")
        page.run("byId('speed').value = '30'; play()")
        page.wait("state.shown === 3 && !state.playing")
        offset = helix_frame(3.0)[1]["offset_y [m]"] / 0.0254  # inches
        rings = drawn(page, "string", key="x").reshape(81, -1)
        np.testing.assert_allclose(rings.mean(axis=1), offset, atol=1e-3)
        assert page.said == []


@pytest.mark.slow
@needs_browser
def test_the_form_of_a_case_checks_and_saves(tmp_path: Path) -> None:
    file = tmp_path / "case.yaml"
    file.write_text((Path(__file__).parents[3] / "cases" / "lying-string.yaml").read_text())
    before = file.read_text()
    made = case_server("127.0.0.1", 0, CaseForm(file))
    thread = threading.Thread(target=made.serve_forever, args=(0.05,))
    thread.start()
    set_od = """(value) => {{ const field = document.querySelector('input[data-at="string[0].od"]');
        field.value = value; field.onchange(); }}"""
    try:
        with chromium.browser() as page:
            page.open(made.url)
            page.wait(
                "byId('status').textContent === 'valid' && byId('report').textContent.includes('31 nodes')"
            )
            page.run(f"({set_od.format()})('-5 in')")
            page.wait("byId('status').textContent === '1 error'")
            beside = page.run(
                "document.querySelector('input[data-at=\"string[0].od\"]').closest('.row').innerText"
            )
            assert "given: -5 in" in beside and "at most" in beside
            assert file.read_text() == before
            page.run("byId('undo').click()")
            page.wait("byId('status').textContent === 'valid' && byId('save').disabled")
            page.run(
                "byId('text').value = byId('text').value.replace('127 mm', '5 in'); byId('text').oninput()"
            )
            page.wait("!byId('save').disabled && byId('status').textContent === 'valid'")
            assert page.run("document.querySelector('input[data-at=\"string[0].od\"]').value") == "5 in"
            page.run("byId('save').click()")
            page.wait("byId('status').textContent === 'valid, saved'")
            assert file.read_text() == before.replace("127 mm", "5 in", 1)
            assert page.said == []
    finally:
        made.shutdown()
        thread.join()
        made.server_close()


@pytest.mark.slow
@needs_browser
def test_a_damaged_last_frame_does_not_hide_the_others(server: Server, folder: Path) -> None:
    (folder / "string" / "000003.vtu").write_text("<VTK")
    with chromium.browser() as page:
        page.open(server.url)
        page.wait("state.shown === 2")
        assert drawn(page, "string", key="x").size > 0


@pytest.mark.slow
@needs_browser
def test_a_bent_string_is_shown_as_it_lies_in_a_box_of_all_frames(tmp_path: Path) -> None:
    run = make_pendulum(tmp_path / "run")
    run.release()
    points = np.concatenate([read_frame(file).points for _, file in read_series(run.path)])
    file = tmp_path / "page.html"
    file.write_text(export_page(RunSource(run.path, "metric"))[0], encoding="utf-8")
    with chromium.browser() as page:
        page.open(file.as_uri())
        page.wait("state.now && state.view === 'true' && state.reach")
        page.wait("document.getElementById('string').layout.scene.zaxis.title.text.startsWith('depth')")
        scene = page.run("document.getElementById('string').layout.scene")
        for axis, column in (("xaxis", 1), ("yaxis", 0), ("zaxis", 2)):
            low, high = sorted(scene[axis]["range"])
            assert low <= points[:, column].min() + 1e-6 and high >= points[:, column].max() - 1e-6
        sizes = {axis: abs(np.diff(scene[f"{axis}axis"]["range"])[0]) for axis in "xyz"}
        ratios = [scene["aspectratio"][axis] / sizes[axis] for axis in "xyz"]
        np.testing.assert_allclose(ratios, ratios[0], rtol=1e-6)  # one scale in all directions
        assert page.said == []
