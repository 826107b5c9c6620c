"""XML files as trees of plain elements. A document type declaration is refused: it could define endless entities."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from drillpetsc.case.files.named_file import bytes_of
from drillpetsc.case.importers.table import MAX_BYTES
from drillpetsc.errors import CaseError

MAX_DEPTH, MAX_ELEMENTS = 60, 2_000_000
CHUNK = 1 << 16  # [bytes]


@dataclass
class Element:
    """An element: name without namespace, attributes, text, children, line in the file."""

    name: str
    space: str
    attributes: dict[str, str]
    line: int
    text: str = ""
    children: list[Element] = field(default_factory=list)

    def all(self, name: str) -> Iterator[Element]:
        """Children of this name."""
        return (child for child in self.children if child.name == name)

    def first(self, *path: str) -> Element | None:
        """First descendant along a path of names."""
        here: Element | None = self
        for name in path:
            here = next(here.all(name), None) if here is not None else None
        return here

    def word(self, *path: str) -> str:
        """Text of a descendant, "" without one."""
        found = self.first(*path)
        return " ".join(found.text.split()) if found is not None else ""


def first_element(file: Path) -> str:
    """Name of the first element of an XML file, without namespace; only the part of the file up to it is read.

    CaseError for a document type declaration, and for a file that is not XML.
    """
    parser = expat.ParserCreate(namespace_separator="|")
    found: list[str] = []

    def start(name: str, attributes: dict[str, str]) -> None:
        found.append(name.rpartition("|")[2])

    def doctype(*_: object) -> None:
        want = "XML without a document type declaration"
        raise CaseError(got="<!DOCTYPE", want=want, file=file, line=parser.CurrentLineNumber)

    parser.StartElementHandler, parser.StartDoctypeDeclHandler = start, doctype
    try:
        with file.open("rb") as opened:
            while not found:
                piece = opened.read(CHUNK)
                parser.Parse(piece, not piece)
                if not piece:
                    break
    except (expat.ExpatError, ValueError, LookupError) as error:
        if not found:
            raise CaseError(got=str(error), want="an XML file", file=file, line=1) from None
    return found[0]


def read_xml(file: Path) -> Element:
    """The root of an XML file."""
    return xml_tree(bytes_of(file, MAX_BYTES), file)


def xml_tree(raw: bytes, file: Path) -> Element:
    """The root of a text; file: its name in messages."""
    parser = expat.ParserCreate(namespace_separator="|")
    parser.buffer_text = True
    root: list[Element] = []
    open_elements: list[Element] = []
    count = [0]

    def refused(got: str, want: str) -> CaseError:
        return CaseError(got=got, want=want, file=file, line=parser.CurrentLineNumber)

    def start(name: str, attributes: dict[str, str]) -> None:
        count[0] += 1
        if len(open_elements) >= MAX_DEPTH or count[0] > MAX_ELEMENTS:
            raise refused("more elements", f"at most {MAX_DEPTH} levels and {MAX_ELEMENTS} elements")
        space, _, local = name.rpartition("|")
        element = Element(local, space, attributes, parser.CurrentLineNumber)
        (open_elements[-1].children if open_elements else root).append(element)
        open_elements.append(element)

    def end(name: str) -> None:
        open_elements.pop()

    def data(text: str) -> None:
        if open_elements:
            open_elements[-1].text += text

    def doctype(*_: object) -> None:
        raise refused("<!DOCTYPE", "XML without a document type declaration")

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = data, doctype
    try:
        parser.Parse(raw, True)
    except expat.ExpatError as error:
        got = expat.errors.messages.get(error.code, "text that is not XML")
        raise CaseError(got=got, want="an XML file", file=file, line=max(error.lineno, 1)) from None
    except (ValueError, LookupError) as error:  # an encoding that does not exist
        raise CaseError(got=str(error), want="an XML file in UTF-8", file=file, line=1) from None
    return root[0]
