"""Notebooks of the manual: run their cells, keep the outputs in the file, and write them as pages.

    python docs/notebook_runner.py docs/notebooks/roadmap.ipynb ...     runs the cells and writes the outputs into the file

The cells run one after the other in one namespace, in the current folder. What a cell prints, and its last expression, are its
outputs: HTML and PNG where the object has them, as in Jupyter, which this needs no part of. `page` gives the Markdown of the
manual; it runs nothing. `tests/cli/test_notebooks.py` runs the cells and compares what they print.
"""

from __future__ import annotations

import ast
import base64
import contextlib
import io
import json
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

Cell = dict[str, Any]


def read(file: Path) -> dict[str, Any]:
    """The notebook of a file (format 4.5 of nbformat)."""
    return json.loads(file.read_text(encoding="utf-8"))


def source(cell: Cell) -> str:
    """Text of a cell."""
    return "".join(cell["source"])


def lines(text: str) -> list[str]:
    """A text as the list of lines of the format."""
    return text.splitlines(keepends=True)


def run_cell(text: str, namespace: dict[str, Any]) -> list[dict[str, Any]]:
    """Run a cell and return its outputs."""
    tree = ast.parse(text)
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    printed, value = io.StringIO(), None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), namespace)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), namespace)
    outputs: list[dict[str, Any]] = []
    if printed.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": lines(printed.getvalue())})
    if value is not None and not text.rstrip().endswith(";"):
        data: dict[str, Any] = {"text/plain": lines(repr(value))}
        html = value._repr_html_() if hasattr(value, "_repr_html_") else None
        if html is not None:
            data["text/html"] = lines(html)
        if hasattr(value, "_repr_png_"):
            data["image/png"] = base64.b64encode(value._repr_png_()).decode("ascii")
        outputs.append({"output_type": "display_data", "metadata": {}, "data": data})
    return outputs


def run(notebook: Mapping[str, Any]) -> list[list[dict[str, Any]]]:
    """Run all code cells in the current folder; the outputs of each."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    return [run_cell(source(cell), namespace) for cell in notebook["cells"] if cell["cell_type"] == "code"]


def printed(outputs: list[dict[str, Any]]) -> str:
    """What a cell printed."""
    return "".join("".join(each["text"]) for each in outputs if each["output_type"] == "stream")


def page(name: str, notebook: Mapping[str, Any]) -> tuple[str, dict[str, bytes]]:
    """(Markdown, pictures by file name) of a notebook with its outputs."""
    parts, pictures = [], {}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            parts.append(source(cell))
            continue
        parts.append(f"```python\n{source(cell).rstrip()}\n```")
        for output in cell["outputs"]:
            if output["output_type"] == "stream":
                parts.append(f"```text\n{''.join(output['text']).rstrip()}\n```")
                continue
            data = output["data"]
            if "text/html" in data:
                # a blank line would end the HTML for the reader of Markdown
                html = re.sub(r"\n\s*\n", "\n", "".join(data["text/html"]))
                parts.append(f"```{{raw}} html\n{html}\n```")
            elif "image/png" in data:
                file = f"{name}-{len(pictures) + 1}.png"
                pictures[file] = base64.b64decode(data["image/png"])
                parts.append(f"![{name}, picture {len(pictures)}]({file})")
            else:
                parts.append(f"```text\n{''.join(data['text/plain'])}\n```")
    return "\n\n".join(parts) + "\n", pictures


def main(files: list[str]) -> None:
    """Run notebooks and write their outputs into the files."""
    for file in map(Path, files):
        notebook = read(file)
        cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
        for count, (cell, outputs) in enumerate(zip(cells, run(notebook), strict=True), 1):
            cell |= {"execution_count": count, "outputs": outputs}
        file.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
