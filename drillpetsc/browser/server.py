"""The server of the local pages: HTTP on this machine, for who has the token.

A page of another site must not read or change files here. Therefore each request needs the token, which is part of the
printed address. The host name must be local, which stops rebinding of names. No address corresponds to a path of a file.
"""

from __future__ import annotations

import hmac
import json
import os
import secrets
import sys
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from drillpetsc.errors import CaseError

LOCAL = ("127.0.0.1", "localhost", "::1")
MOST_BODY = 60_000_000  # bytes
HEADERS = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    # nothing from elsewhere; plotly makes functions from text and images from blobs
    "Content-Security-Policy": "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; frame-ancestors 'none'",
}
Answer = Callable[[Mapping[str, str]], Any]
"""(values of the address, or of the body) -> what is sent as JSON; ValueError and OSError become messages."""


class Server(ThreadingHTTPServer):
    """Pages, and functions that serve them.

    pages: path -> (type, function that returns the text); get, post: functions by name, under `api/`.
    """

    daemon_threads = True

    def __init__(
        self,
        host: str,
        port: int,
        pages: Mapping[str, tuple[str, Callable[[str], str]]],
        get: Mapping[str, Answer],
        post: Mapping[str, Answer] | None = None,
    ) -> None:
        self.token, self.pages, self.get, self.post = secrets.token_urlsafe(24), pages, get, post or {}
        try:
            super().__init__((host, port), Handler)
        except OSError as error:
            want = f"an address that is free on this machine ({error.strerror})"
            raise CaseError(
                at="--port", got=f"{host}:{port}", want=want, hint="--port 0 takes any free port"
            ) from None
        self.names = (
            {f"{name}:{self.server_port}" for name in (*LOCAL, "[::1]", host)} if host in LOCAL else None
        )

    @property
    def url(self) -> str:
        """The address of the page, with the token."""
        host = str(self.server_address[0])
        return f"http://{'localhost' if host == '0.0.0.0' else host}:{self.server_port}/?token={self.token}"


class Handler(BaseHTTPRequestHandler):
    """One request."""

    server: Server
    protocol_version = "HTTP/1.1"
    timeout = 30  # s, for a connection that says nothing
    server_version, sys_version = "drillpetsc", ""

    def do_GET(self) -> None:
        """Send a page, or the result of a function as JSON."""
        self._answer(self.server.get, None)

    def do_POST(self) -> None:
        """Give the JSON of the body to a function."""
        size = self.headers.get("Content-Length", "")
        if not size.isdigit() or int(size) > MOST_BODY:
            self.close_connection = True
            return self._send_error(413, f"a body of at most {MOST_BODY // 10**6} MB is allowed")
        body = self.rfile.read(int(size))
        origin = self.headers.get("Origin")
        if origin is not None and urlsplit(origin).netloc != self.headers.get("Host"):
            return self._send_error(403, "requests of other sites are refused")
        try:
            values = json.loads(body)
        except ValueError:
            values = None
        if not isinstance(values, dict):
            return self._send_error(400, "the body is not a JSON object")
        return self._answer(self.server.post, values)

    def _answer(self, functions: Mapping[str, Answer], body: Mapping[str, Any] | None) -> None:
        address = urlsplit(self.path)
        values = {name: found[-1] for name, found in parse_qs(address.query).items()}
        given = self.headers.get("X-Token") or values.pop("token", "")
        names = self.server.names
        if names is not None and self.headers.get("Host") not in names:
            return self._send_error(403, "only the local name of this server is allowed")
        if not hmac.compare_digest(given.encode(), self.server.token.encode()):
            return self._send_error(
                403, "the token is missing or old: use the address that drillpetsc serve printed"
            )
        if body is None and address.path in self.server.pages:
            kind, text = self.server.pages[address.path]
            return self._send(200, kind, text(self.server.token).encode())
        function = (
            functions.get(address.path.removeprefix("/api/")) if address.path.startswith("/api/") else None
        )
        if function is None:
            return self._send_error(404, "no such page")
        try:
            found = function(values if body is None else body)
        except (ValueError, KeyError, OSError, TypeError) as error:
            return self._send_error(409, " ".join(str(error).split()) or type(error).__name__)
        return self._send(200, "application/json", json.dumps(found).encode())

    def _send_error(self, status: int, text: str) -> None:
        self._send(status, "application/json", json.dumps({"error": text}).encode())

    def _send(self, status: int, kind: str, content: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        for name, value in HEADERS.items():
            self.send_header(name, value)
        self.end_headers()
        try:
            self.wfile.write(content)
        except ConnectionError:  # the page was closed
            self.close_connection = True

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing: there is a request every second."""


def run_server(host: str, port: int, source: Any) -> Server:
    """A server of the page of a run; it serves when ``serve_forever`` is called."""
    from drillpetsc.browser.page import render, script_that_draws

    script = script_that_draws()
    title = source.news()["title"]
    return Server(
        host,
        port,
        {
            "/": ("text/html", lambda token: render("run", title=title, token=token)),
            "/plotly.js": ("text/javascript", lambda _: script),
        },
        {
            "news": lambda q: source.news(q.get("series", ""), int(q.get("rows", 0)), q.get("hole", "")),
            "frame": lambda q: source.frame(int(q["number"])),
        },
    )


def case_server(host: str, port: int, form: Any) -> Server:
    """A server of the form of a case; it serves when ``serve_forever`` is called."""
    from drillpetsc.browser.page import render

    pages = {"/": ("text/html", lambda token: render("case", title=form.path.name))}
    return Server(
        host, port, pages, {"open": form.open}, {"check": form.check, "edit": form.edit, "save": form.save}
    )


def serve(server: Server, open_page: bool) -> None:
    """Print the address of a page, open it, and serve it until Ctrl-C."""
    import webbrowser

    print(f"page: {server.url}", flush=True)
    if server.names is None:
        print(
            "WARNING: other machines can open this page if they know its address; token and data travel unencrypted"
        )
    print("Ctrl-C ends the server", flush=True)
    screen = sys.platform != "linux" or {"DISPLAY", "WAYLAND_DISPLAY"} & set(os.environ)
    if open_page and screen:  # without a screen a text browser would take the terminal
        webbrowser.open(server.url)
    try:
        server.serve_forever(poll_interval=0.2)
    except KeyboardInterrupt:
        print()
    finally:
        server.server_close()
