"""A function of the user that a case names: where it is, and the digest of its source (manual: sec-own-physics)."""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import re
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import reduce
from importlib.metadata import entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

from drillpetsc.case.files.named_file import FOLDER, find_file
from drillpetsc.case.key_paths import refuse
from drillpetsc.own_code import CompiledLaw, file_of

INSTALLED = "drillpetsc.components"  # group of entry points: components of installed packages, by name
WANTED = "file.py:function beside the case file, or module:function of a module that can be imported"

_objects: dict[str, Callable[..., Any]] = {}  # functions given as objects, by their names
_modules: dict[tuple[Path, str], ModuleType] = {}  # files that were run, by path and digest


@dataclass(frozen=True)
class Found:
    """name: as a case file writes it, with the whole path of a file; call: the function.

    source: SHA-256 of the file that holds it, empty if there is none.
    """

    name: str
    call: Any
    source: str


def name_of(value: Any) -> Any:
    """Name under which a function object stands in a case; anything else is returned unchanged."""
    if not callable(value):
        return value
    kind = value if hasattr(value, "__qualname__") else type(value)
    base = name = f"{kind.__module__}:{kind.__qualname__}"
    number = 1
    while _objects.setdefault(name, value) is not value:  # another one of the same name
        number += 1
        name = f"{base}#{number}"
    return name


def load(name: str) -> Found:
    """Find ``file.py:function``, ``module:function`` or ``module.function``.

    A file is looked for beside the case file and in the working directory; a module there and among the installed ones.
    Raises the error of the key ``function`` if it cannot be loaded; the hint gives the user's line.
    """
    if name in _objects:
        return Found(name, _objects[name], _digest(file_of(_objects[name])))
    target = next((q.value for q in entry_points(group=INSTALLED) if q.name == name), name)
    place, _, words = target.rpartition(":" if ":" in target else ".")
    if not place or not all(word.isidentifier() for word in words.split(".")):
        raise refuse("function", got=name, want=WANTED)
    file = _source(place, ".py")
    if file is None and (place.endswith(".py") or not all(word.isidentifier() for word in place.split("."))):
        raise refuse(
            "function",
            got=name,
            want=WANTED,
            hint=f"there is no file {place}" if place.endswith(".py") else "",
        )
    try:
        module = _imported(place) if file is None else _run(file)
        call: Any = reduce(getattr, words.split("."), module)
    except (Exception, SystemExit) as error:  # the user's file may raise anything
        raise refuse("function", got=name, want=WANTED, hint=_reason(error)) from None
    if not callable(call):
        raise refuse("function", got=name, want="a function")
    if file is None:
        return Found(name, call, _digest(file_of(call)))
    return Found(f"{file}:{words}", call, _digest(file))


def load_compiled(name: str, of: str) -> Found:
    """Find the law ``file.cpp:law`` of a plug-in in its source; the library is opened for the model (``physics.own_law``).

    of: what the law is about, as in the macro that exports it: BIT for ``DP_BIT_LAW``.
    Raises the error of the key ``function``.
    """
    place, _, law = name.rpartition(":")
    file = _source(place, ".cpp")
    if file is None or not law.isidentifier():
        raise refuse("function", got=name, want="file.cpp:law, a file beside the case file")
    exported = re.findall(r"^DP_(\w+)_LAW\(\s*(\w+)\s*,", file.read_text(encoding="utf-8"), re.MULTILINE)
    laws = {name: kind for kind, name in exported}
    if laws.get(law) != of:
        has = (
            f"it is exported by DP_{laws[law]}_LAW"
            if law in laws
            else f"the file exports {', '.join(laws) or 'none'}"
        )
        raise refuse("function", got=name, want=f"a law that DP_{of}_LAW exports", hint=has)
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(file.parent.glob("*.[ch]pp"))))
    return Found(f"{file}:{law}", CompiledLaw(file.parent, law), digest.hexdigest())


def _source(place: str, suffix: str) -> Path | None:
    found = find_file(place) if place.endswith(suffix) else None
    return None if found is None else found.resolve()


def _imported(name: str) -> ModuleType:
    with _importable(FOLDER.get(), Path()):
        return importlib.import_module(name)


def _run(file: Path) -> ModuleType:
    """The module of a file, which is run again if it has changed."""
    key = file, _digest(file)
    if key not in _modules:
        spec = importlib.util.spec_from_file_location(f"_own_{file.stem}_{key[1][:12]}", file)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[module.__name__] = module  # data classes look their module up
        try:
            with _importable(file.parent):
                spec.loader.exec_module(module)
        except BaseException:
            del sys.modules[module.__name__]
            raise
        _modules[key] = module
    return _modules[key]


@contextmanager
def _importable(*folders: Path) -> Iterator[None]:
    """Modules in these folders can be imported."""
    paths = [str(folder.resolve()) for folder in folders]
    sys.path[:0] = paths
    try:
        yield
    finally:
        for path in paths:
            sys.path.remove(path)


def _digest(file: Path | None) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest() if file is not None and file.is_file() else ""


def _reason(error: BaseException) -> str:
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    if isinstance(error, SyntaxError):
        return text
    last = traceback.extract_tb(error.__traceback__)[-1:]
    own = [at for at in last if "importlib" not in at.filename and Path(at.filename) != Path(__file__)]
    return f"{text} ({own[0].filename}, line {own[0].lineno})" if own else text
