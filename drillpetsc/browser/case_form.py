"""The form of a case file: its keys with what the schema says of them, the errors beside them, and the text of `check`."""

from __future__ import annotations

import hashlib
import shutil
import threading
from codecs import BOM_UTF8
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from drillpetsc.browser.yaml_edit import with_value, without
from drillpetsc.case.changes import text_of
from drillpetsc.case.files.yaml_text import read_mapping
from drillpetsc.case.reader import case_from_data
from drillpetsc.case.schema import case_json_schema
from drillpetsc.errors import CaseError, DrillError, shown
from drillpetsc.output.files.atomic import replace_file

DEFS = "#/$defs/"
KINDS = ("kind", "model")  # keys that choose among blocks


class CaseForm:
    """A case file that is edited in the browser; nothing is written but by ``save``.  Safe for several threads.

    path: the case file; units: of the answer of check, by default the case's.
    """

    def __init__(self, path: str | Path, units: str | None = None) -> None:
        self.path, self._units = Path(path), units
        self._schema = case_json_schema()
        self._lock = threading.Lock()  # PETSc works for one at a time

    def open(self, values: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """The file as it is."""
        text = _read(self.path)
        return {"name": self.path.name, "digest": _digest(text), **self.check({"text": text})}

    def check(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """What `check` says of a text: form, errors by key, and the description of the model if there are none."""
        text = str(values["text"])
        answer: dict[str, Any] = {"text": text, "form": [], "absent": [], "errors": [], "report": ""}
        with self._lock:
            try:
                data, lines = read_mapping(text, self.path)
                node = self._block(self._schema, data, "")
                answer |= {"form": node["parts"], "absent": node["absent"]}
                answer["report"] = self._describe(case_from_data(data, self.path, lines))
            except CaseError as error:
                answer["errors"] = [_as_data(each) for each in (error, *error.also)]
            except DrillError as error:
                answer["errors"] = [{"at": "", "line": None, "got": "", "want": str(error), "hint": ""}]
        return answer

    def edit(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """The text with one value changed (``at``, ``value``), or removed without ``value``; and what check says."""
        text, at, value = str(values["text"]), str(values["at"]), values.get("value")
        try:
            return self.check(
                {"text": without(text, at) if value is None else with_value(text, at, str(value))}
            )
        except CaseError as error:
            raise ValueError(" ".join(str(error).split())) from None

    def save(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Write the text to the file.  Raises ValueError if the file is no longer the one with ``digest``."""
        text, path = str(values["text"]), self.path.resolve()
        with self._lock:
            now = _digest(_read(path)) if path.is_file() else ""
            if now != values.get("digest"):
                raise ValueError(
                    f"{self.path} was changed or removed by another program: load it again, or copy your text first"
                )

            raw = path.read_bytes()
            coding = "utf-8-sig" if raw.startswith(BOM_UTF8) else "utf-8"
            ends = "\r\n" if b"\r\n" in raw else "\n"  # as the file had them

            def write(file: Path) -> None:
                file.write_text(text, encoding=coding, newline=ends)
                shutil.copymode(path, file)

            replace_file(path, write, lasting=True)
        return {"digest": _digest(text)}

    def _describe(self, case: Any) -> str:
        from drillpetsc.analysis.commands.check import describe

        if self._units is not None:
            case = case.model_copy(update={"output": case.output.model_copy(update={"units": self._units})})
        return describe(case, False)

    # ------------------------------------------------------------------ the form
    def _block(self, schema: Any, data: Mapping[str, Any], at: str) -> dict[str, Any]:
        """Parts of a block in the order of the text, and the keys that it does not have."""
        branch, kinds = self._branch(schema, data)
        known = branch.get("properties", {})
        parts = [
            self._part(known.get(key, {}), value, f"{at}.{key}" if at else str(key), str(key))
            for key, value in data.items()
        ]
        for part in parts:
            if part["key"] in kinds:
                part["choices"] = kinds[part["key"]]
            part["required"] = part["key"] in branch.get("required", ())
        absent = [
            {
                "key": key,
                "about": found.get("description", ""),
                "choices": self._choices(found),
                "default": _default(found),
            }
            for key, found in known.items()
            if key not in data
        ]
        return {"parts": parts, "absent": absent}

    def _part(self, schema: Any, value: Any, at: str, key: str) -> dict[str, Any]:
        """One key with its value: a block, a list of blocks, or a value on one line."""
        part: dict[str, Any] = {
            "key": key,
            "at": at,
            "about": self._about(schema, value),
            "choices": self._choices(schema),
        }
        if isinstance(value, Mapping) and value:
            return part | self._block(schema, value, at)
        if isinstance(value, list) and any(isinstance(entry, Mapping) for entry in value):
            items: Any = next((each["items"] for each in self._branches(schema) if "items" in each), {})
            parts = [self._part(items, entry, f"{at}[{i}]", _name(entry, i)) for i, entry in enumerate(value)]
            return part | {"parts": parts, "absent": []}
        return part | {"value": text_of(value) if value is not None else ""}

    def _about(self, schema: Any, value: Any) -> str:
        if "description" in schema or not isinstance(value, Mapping):
            return str(schema.get("description", ""))
        return str(self._branch(schema, value)[0].get("description", ""))

    def _branches(self, schema: Any) -> Iterator[Any]:
        """The schemas that a value may have, references resolved."""
        while "$ref" in schema:
            schema = self._schema["$defs"][schema["$ref"].removeprefix(DEFS)]
        inside = [*schema.get("anyOf", ()), *schema.get("oneOf", ())] if "properties" not in schema else []
        if not inside:
            yield schema
        for each in inside:
            yield from self._branches(each)

    def _branch(self, schema: Any, data: Mapping[str, Any]) -> tuple[Any, dict[str, list[str]]]:
        """The schema of a block with these keys, and the words of the keys that choose among blocks."""
        blocks = [each for each in self._branches(schema) if "properties" in each]
        kinds: dict[str, list[str]] = {}
        for each in blocks:
            for key in KINDS:
                found = kinds.setdefault(key, [])
                found += [word for word in _words(each["properties"].get(key, {})) if word not in found]
        fitting = [
            each
            for each in blocks
            if all(data.get(key) in _words(each["properties"].get(key, {})) for key in KINDS if key in data)
        ]
        best = max(
            fitting or blocks or [{}], key=lambda each: len(set(data) & set(each.get("properties", ())))
        )
        return best, {key: words for key, words in kinds.items() if words}

    def _choices(self, schema: Any) -> list[str]:
        """Words that a value may be, if only words are allowed."""
        branches = [each for each in self._branches(schema) if each.get("type") != "null"]
        words = [
            word
            for each in branches
            for word in (["true", "false"] if each.get("type") == "boolean" else _words(each))
        ]
        free = any(not _words(each) and each.get("type") != "boolean" for each in branches)
        return [] if free else words


def _words(schema: Mapping[str, Any]) -> list[str]:
    return [schema["const"]] if "const" in schema else list(schema.get("enum", ()))


def _default(schema: Mapping[str, Any]) -> str:
    value = schema.get("default")
    return "" if value is None or isinstance(value, dict | list) else text_of(value)


def _name(entry: Any, number: int) -> str:
    """What a list entry is called: its name or kind, with its number."""
    if not isinstance(entry, Mapping):
        return str(number + 1)
    name = next((str(entry[key]) for key in ("name", "kind", "model") if entry.get(key)), "")
    return f"{number + 1}  {name}".strip()


def _as_data(error: CaseError) -> dict[str, Any]:
    got = "" if error.got is None else shown(error.got)
    return {"at": error.at, "line": error.line, "got": got, "want": error.want, "hint": error.hint}


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8-sig")
