"""The server of the local page: who may ask, what is answered, and that it lives on."""

from __future__ import annotations

import http.client
import json
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from drillpetsc.browser.run_source import RunSource
from drillpetsc.browser.server import Server, run_server
from drillpetsc.errors import CaseError
from tests.helpers.output_samples import make_run

pytest.importorskip("plotly")


def ask(
    server: Server, path: str, method: str = "GET", body: str | None = None, **headers: str
) -> tuple[int, str]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=20)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    connection.request(method, path, body, named)
    answer = connection.getresponse()
    text = answer.read().decode()
    connection.close()
    return answer.status, text


def api(server: Server, path: str) -> Any:
    status, text = ask(server, f"/api/{path}", X_Token=server.token)
    assert status == 200, text
    return json.loads(text)


def test_page_script_and_numbers(server: Server) -> None:
    status, page = ask(server, f"/?token={server.token}")
    assert (
        status == 200
        and "A helix in a hole" in page
        and "http://" not in page.replace("http://www.w3.org", "")
    )
    status, script = ask(server, f"/plotly.js?token={server.token}")
    assert status == 200 and len(script) > 1e6
    news = api(server, "news")
    assert news["rows"] == 101 and news["times"] == [0.0, 1.0, 2.0, 3.0]
    assert api(server, f"news?series={news['series']}&rows=101")["first"] == 101
    assert api(server, "frame?number=3")["time"] == 3.0


@pytest.mark.parametrize("path", ["/", "/plotly.js", "/api/news", "/api/frame?number=0", "/?token=wrong"])
def test_nothing_without_the_token(server: Server, path: str) -> None:
    status, text = ask(server, path)
    assert status == 403 and "token" in text


def test_a_rebound_name_is_refused(server: Server) -> None:
    status, text = ask(server, f"/?token={server.token}", Host=f"evil.example:{server.server_port}")
    assert status == 403 and "local name" in text
    assert ask(server, f"/?token={server.token}", Host=f"localhost:{server.server_port}")[0] == 200


@pytest.mark.parametrize(
    "path",
    [
        "/../../etc/passwd",
        "/history.csv",
        "/api/../history.csv",
        "/%2e%2e/summary.json",
        "/api/",
        "/api/frame/../news",
        "//etc/passwd",
    ],
)
def test_no_address_is_a_file(server: Server, path: str) -> None:
    status, text = ask(server, path, X_Token=server.token)
    assert status == 404 and "error" in json.loads(text)


@pytest.mark.parametrize(
    "query", ["frame?number=99", "frame?number=-1", "frame?number=../1", "frame", "news?rows=many"]
)
def test_a_wrong_question_is_answered(server: Server, query: str) -> None:
    status, text = ask(server, f"/api/{query}", X_Token=server.token)
    assert status == 409 and json.loads(text)["error"]
    assert api(server, "news")["rows"] == 101  # and the server lives on


def test_posts_of_other_pages_and_broken_bodies_are_refused(server: Server) -> None:
    token = {"X_Token": server.token}
    assert ask(server, "/api/news", "POST", "{}", Origin="http://evil.example", **token)[0] == 403
    assert ask(server, "/api/news", "POST", "no json", **token)[0] == 400
    assert ask(server, "/api/news", "POST", "{}", **token)[0] == 404  # a run has nothing to write


def test_a_folder_that_goes_and_comes_back(server: Server, folder: Path) -> None:
    shutil.move(folder, folder.with_name("moved"))
    assert api(server, "news")["status"]["word"] == "missing"
    assert ask(server, "/api/frame?number=0", X_Token=server.token)[0] == 409
    shutil.move(folder.with_name("moved"), folder)
    assert api(server, "news")["rows"] == 101


def test_a_port_in_use_is_named(server: Server, folder: Path) -> None:
    with pytest.raises(CaseError) as error:
        run_server("127.0.0.1", server.server_port, RunSource(folder))
    assert error.value.at == "--port" and str(server.server_port) in str(error.value.got)


def test_the_command_prints_its_address_and_ends_on_ctrl_c(folder: Path) -> None:
    command = [sys.executable, "-P", "-m", "drillpetsc", "serve", str(folder), "--no-open", "--port", "0"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stderr is not None
    address = process.stdout.readline().split()[-1]
    connection = http.client.HTTPConnection(urlsplit(address).netloc, timeout=20)
    connection.request("GET", address)
    assert b"A helix in a hole" in connection.getresponse().read()
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 0
    assert process.stderr.read() == ""


def test_the_command_exports_a_page(folder: Path, tmp_path: Path) -> None:
    file = tmp_path / "page.html"
    command = [sys.executable, "-P", "-m", "drillpetsc", "serve", str(folder), "--units", "field", "--export"]
    found = subprocess.run([*command, str(file)], capture_output=True, text=True, check=True)
    assert found.stdout.startswith(f"{file}  (") and "A helix in a hole" in file.read_text()
    refused = subprocess.run([*command, str(tmp_path / "no" / "page.html")], capture_output=True, text=True)
    assert refused.returncode == 2 and "--export" in refused.stderr


def test_a_missing_folder_is_refused(tmp_path: Path) -> None:
    command = [sys.executable, "-P", "-m", "drillpetsc", "serve", str(tmp_path / "none"), "--no-open"]
    found = subprocess.run(command, capture_output=True, text=True)
    assert found.returncode == 2 and "a run folder or a case file" in found.stderr


def test_without_plotly_the_message_says_what_to_install(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    with pytest.raises(CaseError) as error:
        run_server("127.0.0.1", 0, RunSource(folder))
    assert "plotly" in error.value.want and error.value.hint == "pip install 'drillpetsc[browser]'"


def test_a_folder_of_runs_is_refused_with_their_names(tmp_path: Path) -> None:
    for name in ("b", "a"):
        (make_run(tmp_path / name).path / "case.yaml").write_text("title: a\n")
    command = [sys.executable, "-P", "-m", "drillpetsc", "serve", str(tmp_path), "--no-open"]
    found = subprocess.run(command, capture_output=True, text=True)
    assert found.returncode == 2 and f"one run folder, such as {tmp_path / 'a'}" in found.stderr
