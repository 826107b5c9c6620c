"""The Python function of an operation: its signature and docstring follow from the fields of the class."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import Any, get_origin

from drillpetsc.operations.operation import RENAMED_OPTIONS, DrawnOperation, Mark, Operation, Option

CASE = "a Case, or the path of a case file"


def function_of(operation: type[Operation]) -> Callable[..., Any]:
    """Make the Python function of an operation."""
    options = [q for q in operation.options() if Mark.SHELL not in q.marks]
    options.sort(key=_place)
    back = "Result" if issubclass(operation, DrawnOperation) else inspect.Signature.empty
    signature = inspect.Signature([_parameter(q) for q in options], return_annotation=back)

    def function(*arguments: Any, **keywords: Any) -> Any:
        for old in keywords:
            if old not in signature.parameters and f"--{old}" in RENAMED_OPTIONS:
                new = RENAMED_OPTIONS[f"--{old}"].removeprefix("--")
                raise TypeError(f"{function.__name__}: {old} is now called {new}")
        return operation(**signature.bind(*arguments, **keywords).arguments).call()

    function.__name__ = function.__qualname__ = operation.command().replace("-", "_")
    function.__module__ = "drillpetsc"
    function.__doc__ = _docstring(operation, options)
    function.__signature__ = signature  # type: ignore[attr-defined]
    return function


def _place(option: Option) -> int:
    """Order in the signature: the case, what else is positional, `out`, the keywords, any keywords."""
    if Mark.POSITIONAL in option.marks:
        return {"case": 0, "out": 2}.get(option.name, 1)
    return 4 if _any(option) else 3


def _any(option: Option) -> bool:
    """Whether a field takes the keywords that have no name in the signature."""
    return get_origin(option.kind) is dict


def _parameter(option: Option) -> inspect.Parameter:
    positional = Mark.POSITIONAL in option.marks
    kind = inspect.Parameter.POSITIONAL_OR_KEYWORD if positional else inspect.Parameter.KEYWORD_ONLY
    if _any(option):
        return inspect.Parameter(option.name, inspect.Parameter.VAR_KEYWORD)
    default = inspect.Parameter.empty if option.required else option.default
    return inspect.Parameter(option.name, kind, default=default, annotation=option.type)


def _docstring(operation: type[Operation], options: list[Option]) -> str:
    """The docstring of the class, and a line for each parameter, with the names that Python has."""
    lines = [inspect.getdoc(operation) or "", ""]
    for option in options:
        text = CASE if option.name == "case" else re.sub(r"--([a-z][a-z-]*)", _name_in_python, option.text)
        lines.append(f"{option.name}: {text}")
    return "\n".join(lines) + "\n"


def _name_in_python(found: re.Match[str]) -> str:
    return found[1].replace("-", "_")
