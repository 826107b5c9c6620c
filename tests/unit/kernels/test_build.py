"""The compiled library: where it lies, what an import does, which files are refused."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import drillpetsc.kernels as kernels
from drillpetsc.kernels import KernelsUnavailable, build
from tests.helpers.tables import each_row

HAS_ROOT = os.getuid() == 0


def test_library_lies_in_the_package_in_the_cache_or_where_told(monkeypatch, tmp_path):
    """In the package where that can be written, else in the user's cache; DRILLPETSC_KERNELS goes before both."""
    package = Path(kernels.__file__).parent / "_build"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    assert build.library_path().parent == package
    monkeypatch.setattr(build, "FLAGS", ("-O1",))  # a library that is not there
    assert build.library_path().parent == package
    monkeypatch.setattr(build.os, "access", lambda path, mode: package not in (path, path / "_build"))
    assert build.library_path().parent == tmp_path / "cache" / "drillpetsc"
    monkeypatch.setenv("DRILLPETSC_KERNELS", str(tmp_path / "own"))
    assert build.library_path().parent == tmp_path / "own"
    monkeypatch.setattr(build.os, "access", lambda path, mode: False)
    with pytest.raises(RuntimeError, match="own cannot be written"):
        build.library_path()


def test_a_portable_library_serves_every_processor_that_has_its_instructions(monkeypatch, tmp_path):
    """Built for x86-64-v3, opened without the variable by a processor that has it, and by no other."""
    source = tmp_path / "source"
    source.mkdir()
    (source / "one.cpp").write_text('extern "C" int one() { return 1; }\n')
    monkeypatch.setattr(build, "SOURCES", source)
    monkeypatch.setenv("DRILLPETSC_KERNELS", str(tmp_path / "out"))
    v2, v3 = build.PORTABLE["x86-64-v2"], build.PORTABLE["x86-64-v3"]
    monkeypatch.setattr(build, "_processor", lambda: f"flags : {v2} {v3}")
    monkeypatch.setenv("DRILLPETSC_ARCH", "x86-64-v3")
    path = build.library_path()
    path.parent.mkdir()
    path.touch()
    monkeypatch.delenv("DRILLPETSC_ARCH")
    assert build.library_path() == path
    monkeypatch.setattr(build, "_processor", lambda: f"flags : {v2} {v3} another")
    assert build.library_path() == path
    monkeypatch.setattr(build, "_processor", lambda: f"flags : {v2}")
    assert build.library_path() != path and build._architectures() == ["native", "x86-64-v2"]
    monkeypatch.setenv("DRILLPETSC_ARCH", "x86-64-v9")
    with pytest.raises(RuntimeError, match="allowed: native, x86-64-v4"):
        build.library_path()


def test_sources_flags_and_processor_name_the_library(monkeypatch):
    before = build.library_path()
    assert build.library_path() == before
    monkeypatch.setattr(build, "FLAGS", ("-O2",))
    other = build.library_path()
    monkeypatch.setattr(build, "_processor", lambda: "another")
    assert len({before, other, build.library_path()}) == 3


def test_import_opens_nothing_and_compiles_nothing(tmp_path):
    """In a folder that holds something of the library's name."""
    (tmp_path / build.library_path().name).write_bytes(b"not a library")
    code = "import drillpetsc.kernels as k; print(k.library.cache_info().currsize, 'subprocess' in dir(k))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["0", "False"]


def test_a_missing_library_is_built_at_first_use(monkeypatch, tmp_path, capfd):
    source = tmp_path / "source"
    source.mkdir()
    (source / "one.cpp").write_text('extern "C" int one() { return 7; }\n')
    monkeypatch.setattr(build, "SOURCES", source)
    monkeypatch.setenv("DRILLPETSC_KERNELS", str(tmp_path / "out"))
    kernels.library.cache_clear()
    assert kernels.library().one() == 7 and kernels.library().one() == 7
    assert capfd.readouterr().err.count("compiling the kernels") == 1
    kernels.library.cache_clear()


def test_without_a_compiler_the_ways_are_named(monkeypatch, tmp_path):
    monkeypatch.setenv("DRILLPETSC_KERNELS", str(tmp_path / "out"))
    monkeypatch.setattr(build.shutil, "which", lambda name: None)
    kernels.library.cache_clear()
    with pytest.raises(KernelsUnavailable, match="install g") as caught:
        kernels.library()
    assert (
        "python -m drillpetsc.kernels build" in caught.value.hint and "DRILLPETSC_ARCH" in caught.value.hint
    )
    kernels.library.cache_clear()


def library(folder: Path) -> Path:
    folder.chmod(0o755)
    path = folder / "kernels-0.so"
    path.write_bytes(b"")
    path.chmod(0o755)
    return path


def test_library_of_the_user_is_trusted(tmp_path):
    build.check_trusted(library(tmp_path))


@each_row("mode", [0o775, 0o757, 0o777])
@each_row("which", ["library", "folder"])
def test_what_others_can_write_is_refused(which, mode, monkeypatch, tmp_path):
    path = library(tmp_path)
    (path if which == "library" else tmp_path).chmod(mode)
    with pytest.raises(build.UntrustedLibrary, match="written by other users"):
        build.check_trusted(path)
    monkeypatch.setattr(kernels, "library_path", lambda: path)
    kernels.library.cache_clear()
    with pytest.raises(KernelsUnavailable, match="not opened"):
        kernels.library()
    kernels.library.cache_clear()


@pytest.mark.skipif(not HAS_ROOT, reason="only root can give files away")
@pytest.mark.parametrize("which", ["library", "folder"])
def test_what_belongs_to_another_user_is_refused(which, tmp_path):
    path = library(tmp_path)
    os.chown(path if which == "library" else tmp_path, 12345, -1)
    with pytest.raises(build.UntrustedLibrary, match="12345"):
        build.check_trusted(path)


def test_library_that_others_could_write_is_built_again(monkeypatch, tmp_path):
    source, out = tmp_path / "source", tmp_path / "out"
    source.mkdir()
    (source / "one.cpp").write_text('extern "C" int one() { return 1; }\n')
    monkeypatch.setattr(build, "SOURCES", source)
    before = os.umask(0o002)
    try:
        path = build.build(out)
        build.check_trusted(path)
        path.write_bytes(b"another")
        path.chmod(0o775)
        assert build.build(out) == path
        build.check_trusted(path)
        assert path.read_bytes()[:4] == b"\x7fELF"
    finally:
        os.umask(before)


def test_compiler_error_is_shown(monkeypatch, tmp_path):
    source = tmp_path / "source"
    source.mkdir()
    (source / "wrong.cpp").write_text("int f() { return nothing; }\n")
    monkeypatch.setattr(build, "SOURCES", source)
    with pytest.raises(RuntimeError, match="compiling wrong.cpp failed(.|\n)*nothing"):
        build.build(tmp_path / "out")


def test_changed_source_compiles_alone(monkeypatch, tmp_path):
    """An object serves as long as its source and the headers that it includes stay as they are."""
    source, compiled = tmp_path / "source", []
    source.mkdir()
    (source / "a.hpp").write_text("#pragma once\nconstexpr int A = 1;\n")
    (source / "one.cpp").write_text('#include "a.hpp"\nextern "C" int one() { return A; }\n')
    (source / "two.cpp").write_text('extern "C" int two() { return 2; }\n')
    monkeypatch.setattr(build, "SOURCES", source)
    call = build._compile
    monkeypatch.setattr(build, "_compile", lambda c, s, o: (compiled.append(s.name), call(c, s, o)))
    first = build.build(tmp_path / "out")
    assert sorted(compiled) == ["one.cpp", "two.cpp"] and first.stat().st_mode & 0o777 == 0o755
    compiled.clear()
    assert build.build(tmp_path / "out") == first and not compiled
    (source / "a.hpp").write_text("#pragma once\nconstexpr int A = 3;\n")
    assert build.build(tmp_path / "out") != first and compiled == ["one.cpp"]
