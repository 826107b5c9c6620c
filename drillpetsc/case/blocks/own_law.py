"""Functions of the user in a case: a law in the place of a built-in one, a controller (manual: sec-own-physics)."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, PrivateAttr, model_validator

from drillpetsc.case.block import Block
from drillpetsc.case.files.own_function import Found, load, load_compiled, name_of
from drillpetsc.case.key_paths import refuse
from drillpetsc.own_code import MEMORY, parameters_of

FunctionName = Annotated[str, BeforeValidator(name_of, json_schema_input_type=str)]


class OwnFunction(Block):
    """Keys of every function of the user; the function is loaded as the case is read."""

    function: FunctionName = Field(
        description="file.py:function, beside the case file, or module:function; from Python also the function itself"
    )
    source: str | None = Field(
        default=None,
        description="SHA-256 of the file with the function, filled in; a case that gives it does not run with another file",
    )

    _call: Callable[..., Any] = PrivateAttr()

    @property
    def call(self) -> Callable[..., Any]:
        """The function."""
        return self._call

    @model_validator(mode="after")
    def _loaded(self) -> OwnFunction:
        found = self.find()
        if self.source not in (None, found.source):
            want = f"the file of this case, with the SHA-256 {str(self.source)[:12]}..., not {found.source[:12] or 'no file'}..."
            raise refuse(
                "function", got=self.function, want=want, hint="remove source to use the present file"
            )
        self._call = found.call
        self.check_signature()
        self.fill_defaults(function=found.name, source=found.source or None)
        return self

    def find(self) -> Found:
        """Find the function."""
        return load(self.function)

    def check_signature(self) -> None:
        """Refuse a function that cannot be called."""


class OwnLaw(OwnFunction):
    """Keys of every law of the user."""

    parameters: dict[str, float] = Field(
        default={}, description="numbers that the function takes by name, in SI units"
    )

    def check_signature(self) -> None:
        """Refuse a function that cannot be called with a state and the parameters of the case."""
        names = parameters_of(self._call)
        rest = {q.name: q for q in names[1:]}
        for name in self.parameters:
            if name not in rest and not any(q.kind is q.VAR_KEYWORD for q in names):
                raise refuse(
                    "parameters",
                    name,
                    want=f"a parameter of the function: {', '.join(rest) or 'it has none'}",
                )
        plain = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
        needed = [
            q.name for q in rest.values()
            if q.default is q.empty and q.kind in (*plain, q.KEYWORD_ONLY) and q.name not in {MEMORY, *self.parameters}
        ]  # fmt: skip
        if not names or names[0].kind not in plain or needed:
            hint = f"give parameters: {{{needed[0]}: ...}}, or a default in the function" if needed else ""
            want = "a function of the state, and of parameters by name"
            raise refuse("function", got=self.function, want=want, hint=hint)


class OwnComponent(OwnLaw):
    """A component of the user: a function that builds it from the string and its hole."""

    parameters: dict[str, Any] = Field(default={}, description="what the function takes by name, in SI units")


class LawOfKind(OwnLaw):
    """A law that is a function in Python, or compiled."""

    of: ClassVar[str]
    """What the law is about, as the macro names it that exports one in C++."""

    kind: Literal["python", "compiled"] = Field(
        description="python: a function in Python; compiled: a law in a C++ file, file.cpp:law, whose folder is a plug-in"
    )

    def find(self) -> Found:
        return load(self.function) if self.kind == "python" else load_compiled(self.function, self.of)

    def check_signature(self) -> None:
        if self.kind == "python":
            super().check_signature()
