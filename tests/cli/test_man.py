"""`drillpetsc man`: the manual page, as `man` reads it."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

from drillpetsc.operations import OPERATIONS
from drillpetsc.operations.operation import Mark
from tests.helpers.command import main_succeeds


def page(capsys) -> str:
    main_succeeds("man")
    return capsys.readouterr().out


def test_every_command_and_option_is_there(capsys):
    """A section for each command, and a paragraph for each of its options."""
    text = page(capsys).replace("\\-", "-")
    sections = dict(re.findall(r"^\.SS \"([\w-]+).*?\"\n(.*?)(?=^\.S)", text, re.S | re.M))
    assert set(sections) == {q.command() for q in OPERATIONS}
    for operation in OPERATIONS:
        shown = [q.flag for q in operation.options() if Mark.PYTHON not in q.marks]
        found = re.findall(r"^\.TP\n\\fB(.*?)\\fR", sections[operation.command()], re.M)
        assert found == shown


def test_no_text_is_a_request_of_roff(capsys):
    """A line that begins with a dot or a quote, or a lone backslash, would vanish from the page."""
    lines = page(capsys).splitlines()
    assert all(re.match(r"\.(TH|SH|SS|TP|B|br)\b", line) for line in lines if line[:1] in (".", "'"))
    assert not re.search(r"\\(?![-e&(]|f[BR])", "\n".join(lines))


@pytest.mark.skipif(shutil.which("groff") is None, reason="groff is not installed")
def test_groff_has_no_complaint(capsys):
    done = subprocess.run(
        ["groff", "-man", "-ww", "-Tutf8", "-z"], input=page(capsys), capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
