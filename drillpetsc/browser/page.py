"""The page of a run as HTML: for the server, which sends the numbers, or whole with everything that it shows."""

from __future__ import annotations

import base64
import contextlib
import json
from pathlib import Path
from typing import Any

from drillpetsc.browser.run_source import RunSource
from drillpetsc.errors import CaseError
from drillpetsc.plotting.interactive import plotly_script
from drillpetsc.version import __version__

HERE = Path(__file__).parent
MOST_BYTES = 80_000_000  # of the frames in an exported page: a browser opens it in seconds
INSTALL = "pip install 'drillpetsc[browser]'"


def script_that_draws() -> str:
    """The script of the package plotly, so that no network is needed; raises CaseError if the package is missing."""
    try:
        return plotly_script()
    except CaseError:
        want = "the package plotly, whose script draws in the browser"
        raise CaseError(at="serve", want=want, hint=INSTALL) from None


def render(name: str, **values: Any) -> str:
    """A page of this folder: ``name``.html with its script and the style."""
    from jinja2 import Environment

    template = Environment(autoescape=True).from_string((HERE / f"{name}.html").read_text(encoding="utf-8"))
    script, css = ((HERE / file).read_text(encoding="utf-8") for file in (f"{name}.js", "style.css"))
    return template.render(version=__version__, script=script, css=css, **values)


def export_page(source: RunSource) -> tuple[str, list[str]]:
    """A page with all rows and frames, which needs no server; and remarks on what it leaves out."""
    news = source.news()
    parts = [news]
    while parts[-1]["more"]:
        parts.append(source.news(news["series"], parts[-1]["rows"], news["hole"]))
    remarks = list(parts[-1]["notes"])
    kept = _fitting(source, len(news["times"]), remarks)
    pool: dict[str, int] = {}  # arrays that do not change over time are there once
    frames: list[dict[str, Any]] = []
    for number in kept:
        with contextlib.suppress(OSError, ValueError):  # a damaged frame
            found = source.frame(number)
            arrays = {name: pool.setdefault(text, len(pool)) for name, text in found["arrays"].items()}
            frames.append({"number": len(frames), "time": found["time"], "arrays": arrays})
    lost = len(kept) - len(frames)
    remarks += [f"damaged frames that are left out: {lost}"] if lost else []
    last = parts[-1]
    news = {
        **last,
        "first": 0,
        "more": False,
        "wall": parts[0].get("wall"),
        "times": [frame["time"] for frame in frames],
    }
    news["columns"] = {
        title: base64.b64encode(b"".join(base64.b64decode(part["columns"][title]) for part in parts)).decode(
            "ascii"
        )
        for title in last["columns"]
    }
    data = json.dumps({"news": news, "frames": frames, "arrays": list(pool)}).replace("<", "\\u003c")
    return render("run", title=news["title"], data=data, plotly=script_that_draws()), remarks


def _fitting(source: RunSource, count: int, remarks: list[str]) -> range:
    """Numbers of the frames that a file holds: all, or evenly chosen ones, which becomes a remark."""
    size = 0
    if count:
        with contextlib.suppress(OSError, ValueError):
            size = sum(map(len, source.frame(count - 1)["arrays"].values()))
    kept = range(0, count, max(-(-size * count // MOST_BYTES), 1))
    if len(kept) < count:
        remarks.append(f"{len(kept)} of {count} frames, to keep the file small")
    return kept
