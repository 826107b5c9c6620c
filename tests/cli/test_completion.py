"""`drillpetsc completion`: what bash offers after its script was read."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from tests.helpers.command import main_succeeds


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_bash_offers_commands_options_and_words(capsys: pytest.CaptureFixture[str]) -> None:
    main_succeeds("completion")
    script = capsys.readouterr().out

    def offered(*words: str) -> list[str]:
        line = " ".join(f"'{word}'" for word in words)
        ask = f'{script}\nCOMP_WORDS=({line}); COMP_CWORD={len(words) - 1}; _drillpetsc; echo "${{COMPREPLY[@]}}"'
        return subprocess.run(["bash", "-c", ask], capture_output=True, text=True, check=True).stdout.split()

    assert offered("drillpetsc", "s") == [
        "sweep",
        "study",
        "schema",
        "statics",
        "surge",
        "sensitivities",
        "stability",
        "serve",
    ]
    assert offered("drillpetsc", "surge", "case.yaml", "--sp") == ["--speeds"]
    assert offered("drillpetsc", "modes", "--kind", "") == ["lateral", "axial", "torsional", "fluid"]
    assert offered("drillpetsc", "statics", "case.yaml", "--motion", "h") == ["hoist"]
    assert offered("drillpetsc", "roadmap", "--comm") == []
