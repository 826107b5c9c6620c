"""Pages of the keys of the case file, from the pydantic classes behind `drillpetsc.case.Case`: `case/*.md` of the manual."""

from __future__ import annotations

import re
import types
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, Union, get_args, get_origin

HEAD = "% Written by docs/generate.py; edits are lost.\n\n"
PLAIN = {bool: "true, false", str: "text", int: "whole number", float: "number"}


@dataclass
class Key:
    """One row of a table of keys."""

    name: str
    unit: str
    allowed: str
    default: str
    meaning: str
    blocks: list[type] = field(default_factory=list)


def is_block(kind: Any) -> bool:
    return isinstance(kind, type) and hasattr(kind, "model_fields")


def case_class() -> Any:
    from drillpetsc.case import Case

    return Case


def blocks_in(annotation: Any) -> Iterator[type]:
    """Classes of blocks that may stand in a value of this type, in order."""
    if is_block(annotation):
        yield annotation
    for part in get_args(annotation):
        if part is not None and not isinstance(part, (str, int, float, bool)):
            yield from blocks_in(part)


def case_pages() -> dict[str, str]:
    """A page for each top-level key of the case file that holds blocks, one for the other keys, and the
    index."""
    case = case_class()
    pages, rows, names = {}, [], []
    for name, info in case.model_fields.items():
        key = key_row(name, info)
        rows.append(key)
        if key.blocks:
            names.append(name)
            pages[f"case/{name}.md"] = block_page(name, info, key)
    for row in rows:
        if row.name in names:
            row.name = f"{{doc}}`{row.name} <{row.name}>`"
        else:
            row.name = f"`{row.name}`"
    toctree = "\n".join(names)
    pages["case/index.md"] = (
        f"{HEAD}(case-keys)=\n# Keys of the case file\n\n"
        "One page a block. A bare number is in the unit of the table; a text carries a unit of its own (`80 rpm`, `2000 m`).\n"
        "A block that is absent is physics that the model does not have.\n\n"
        + table(rows, code=False)
        + f"\n```{{toctree}}\n:maxdepth: 1\n:hidden:\n\n{toctree}\n```\n"
    )
    return pages


def block_page(name: str, info: Any, key: Key) -> str:
    """Tables of a block and of all blocks inside it."""
    out = [f"{HEAD}(case-{name})=\n# `{name}`\n", sentence(info.description or "") + "\n"]
    if key.allowed or key.default:
        parts = [
            f"Allowed: {key.allowed}." if key.allowed else "",
            f"Default: {key.default}." if key.default else "",
        ]
        out.append(" ".join(part for part in parts if part) + "\n")
    queue, seen = [(block, name) for block in key.blocks], set()
    while queue:
        block, where = queue.pop(0)
        if block in seen:
            continue
        seen.add(block)
        rows = [key_row(n, f) for n, f in block.model_fields.items()]
        rows.sort(key=lambda row: row.name not in ("kind", "model", "at", "from", "to"))
        title = title_of(block, where)
        out.append(f"## {'Keys' if title == f'`{name}`' else title}\n")
        if block.__doc__:
            out.append(markdown(sentence(" ".join(block.__doc__.split()))) + "\n")
        out.append(table(rows))
        queue += [(inner, f"{where}.{row.name}") for row in rows for inner in row.blocks]
    return "\n".join(out)


def title_of(block: Any, where: str) -> str:
    """`{kind: pipe}` in `string`, or the path of the block."""
    for key in ("kind", "model"):
        if key in block.model_fields:
            words = literals(block.model_fields[key].annotation)
            if words:
                return f"`{where}`: `{key}: {' | '.join(words)}`"
    if "at" in block.model_fields and "from_" not in block.model_fields and where == "loads":
        return f"`{where}`: point load"
    if where == "loads":
        return f"`{where}`: distributed load"
    return f"`{where}`"


def literals(annotation: Any) -> list[str]:
    """Words of all Literal types in an annotation."""
    if get_origin(annotation) is Literal:
        return [str(word) for word in get_args(annotation) if word is not None]
    if get_origin(annotation) in (Union, types.UnionType, Annotated):
        return [word for part in get_args(annotation) for word in literals(part)]
    return []


def metadata_of(annotation: Any, own: Any) -> list[Any]:
    """Metadata of a field and of the types in its annotation."""
    found = list(own)
    if get_origin(annotation) is Annotated:
        found += [part for part in get_args(annotation)[1:] if not isinstance(part, str)]
    for part in get_args(annotation):
        if not isinstance(part, (str, int, float, bool)) and part is not None and not is_block(part):
            found += metadata_of(part, ())
    return found


def key_row(name: str, info: Any) -> Key:
    """The row of one key."""
    annotation, meta = info.annotation, metadata_of(info.annotation, info.metadata)
    quantity = next((part for part in meta if hasattr(part, "unit")), None)
    text = info.description or ""
    unit = getattr(quantity, "unit", "") or ""
    if not unit and not is_block(annotation):
        units = [
            word for word in re.findall(r"\[([^\]]+)\]", text) if not re.search(r"[,=]|north|down", word)
        ]
        unit = units[0] if len(units) == 1 else ""
    blocks = list(dict.fromkeys(blocks_in(annotation)))
    words = literals(annotation) + [
        word for part in meta for word in words_of(getattr(part, "json_schema_input_type", None))
    ]
    words = list(dict.fromkeys(words))
    allowed = allowed_of(annotation, meta, quantity, words, blocks)
    required = info.is_required() or "needed unless" in text
    default = "required" if required else default_of(info, text)
    return Key(info.alias or name, pretty(unit), allowed, default, text, blocks)


def words_of(annotation: Any) -> list[str]:
    """Words that may be written in place of a block, from the type that the schema shows; not the words inside blocks."""
    return literals(annotation) if get_origin(annotation) in (Literal, Union, types.UnionType) else []


def allowed_of(annotation: Any, meta: list[Any], quantity: Any, words: list[str], blocks: list[type]) -> str:
    """Range, words, or form of a value."""
    parts = []
    if words:
        parts.append(", ".join(f"`{word}`" for word in words))
    if words and float in get_args(annotation):
        parts.append("or a number")
    if blocks:
        parts.append("a list of blocks" if is_sequence(annotation) else "a block")
    kind = type(quantity).__name__
    if kind == "OverTime":
        parts.append("a value over time")
    elif kind == "Vector":
        more = getattr(quantity, "along_x", False) or getattr(quantity, "along_z", False)
        parts.append("three components" + (", or one number" if more else ""))
    elif quantity is not None:
        spoken = quantity.allowed() if hasattr(quantity, "allowed") else ""
        spoken = spoken.removesuffix(f" {quantity.unit}") if quantity.unit else spoken
        parts.append(
            (
                "a list, each "
                if is_sequence(annotation) and spoken
                else "a list of numbers"
                if is_sequence(annotation)
                else ""
            )
            + (spoken or ("" if is_sequence(annotation) else "any number"))
        )
    for bound, word in (("ge", "at least"), ("le", "at most"), ("min_length", "entries: at least")):
        limits = [getattr(part, bound) for part in meta if getattr(part, bound, None) is not None]
        if limits:
            parts.append(f"{word} {limits[0]:g}")
    if not parts:
        bare = next((PLAIN[t] for t in PLAIN if t is annotation or t in get_args(annotation)), "")
        parts.append(bare if not str(annotation).startswith("dict") else "a mapping of names and values")
    return ", ".join(part for part in parts if part)


def is_sequence(annotation: Any) -> bool:
    return get_origin(annotation) in (tuple, list) or any(
        is_sequence(part)
        for part in get_args(annotation)
        if get_origin(annotation) in (Union, types.UnionType, Annotated)
    )


def default_of(info: Any, text: str) -> str:
    """A default as it would be written."""
    value = info.default
    if value is None:
        if "when not given" in text or "none" in text.lower().split(";")[-1]:
            return "see meaning"
        return "none"
    if hasattr(value, "constant"):
        value = value.constant
    if is_block(type(value)):
        if "kind" in type(value).model_fields:
            return f"`{value.kind}`"
        return "the block's defaults"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, float):
        return number(value)
    if value in ("", (), {}, []):
        return "empty"
    if isinstance(value, tuple):
        return "[" + ", ".join(number(v) if isinstance(v, float) else str(v) for v in value) + "]"
    return f"`{value}`"


def number(value: float) -> str:
    """2e+09 -> 2e9."""
    return re.sub(
        r"e([+-])0*(\d)",
        lambda m: "e" + m.group(1).replace("+", "") + m.group(2),
        f"{value:g}" if float(f"{value:g}") == value else f"{value:.10g}",
    )


def pretty(unit: str) -> str:
    """`kg/m^3` -> kg/m³."""
    unit = unit.replace("Pa = N/m2", "Pa").strip()
    if unit == "-":
        return "-"
    return re.sub(r"\^?([23])(?![\d.])", lambda m: {"2": "²", "3": "³"}[m.group(1)], unit)


def sentence(text: str) -> str:
    """With a capital first letter and a full stop."""
    text = text.strip()
    return (
        text[:1].upper() + text[1:] + ("" if text.endswith((".", ":", "")) and text.endswith(".") else ".")
        if text
        else ""
    )


def markdown(text: str) -> str:
    """Plain text as Markdown: no emphasis, no brackets that look like links, no table bars."""
    text = re.sub(r"([*_<>\[\]|$])", r"\\\1", text)
    return text.replace("{", "\\{").replace("}", "\\}")


def table(rows: list[Key], code: bool = True) -> str:
    """Rows as a Markdown table."""
    lines = ["| key | unit | allowed | default | meaning |", "| --- | --- | --- | --- | --- |"]
    for row in rows:
        name = f"`{row.name}`" if code else row.name
        meaning = re.sub(
            r"\s*\[([^\]]*)\]",
            lambda m, u=row.unit: "" if pretty(m.group(1)) == u else m.group(0),
            row.meaning,
        )
        cells = [name, markdown(row.unit), row.allowed, row.default, markdown(meaning)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"
