"""Text references to drill pipe: `5in 19.50 S-135 NC50 premium`.

SIZE WEIGHT {GRADE | UPSET | CONNECTION | CLASS}: the words after the first two in any order, case and dashes ignored.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from drillpetsc.case.catalogue.sizes import inch_text, size_at_start
from drillpetsc.case.catalogue.tables import Catalogue, Row

SIZE_TOLERANCE = 0.006  # relative
WEIGHT_TOLERANCE = 0.06 + 1e-9  # [lb/ft]
DEFAULT_GRADE = "E-75"

#: older names of connections (API RP 7G, interchange list)
INTERCHANGE = {
    "2 3/8 IF": "NC26",
    "2 7/8 IF": "NC31",
    "3 1/2 IF": "NC38",
    "4 FH": "NC40",
    "4 IF": "NC46",
    "4 1/2 XH": "NC46",
    "4 1/2 IF": "NC50",
    "5 XH": "NC50",
}
NUMBERED = tuple(f"NC{n}" for n in (23, 26, 31, 35, 38, 40, 44, 46, 50, 56, 61, 70, 77))
OTHER_CONNECTIONS = ("4 1/2 FH", "5 1/2 FH", "6 5/8 FH")
UPSETS = ("EU", "IU", "IEU")
CLASSES = {"new": "new", "premium": "premium", "class2": "class_2"}

_WEIGHT = re.compile(r"\s*(\d+(?:\.\d+)?)\s*(#|lbf?/ft|lbs/ft|ppf)?(?=[\s,]|$)", re.IGNORECASE)


#: words of a tally without further information, beyond the item's kind: `5" HWDP 49.3 # NC50`, `premium class`
_SAID_BY_KIND = re.compile(
    r"(?<![\w-])(?:hwdp|dp|drill\s?pipes?)(?![\w-])|(?<=premium )class(?![\w-])|(?<=new )class(?![\w-])",
    re.IGNORECASE,
)


class ReferenceProblem(ValueError):
    """A text that does not name a row: allowed texts, and a hint."""

    def __init__(self, want: str, hint: str = "") -> None:
        super().__init__(want)
        self.want, self.hint = want, hint


@dataclass(frozen=True)
class Reference:
    """A text reference, parsed: size [in], nominal weight [lb/ft], and the words, None if not given."""

    size: float
    weight: float
    grade: str | None = None
    upset: str | None = None
    connection: str | None = None
    wear: str | None = None


@dataclass(frozen=True)
class PipeChoice:
    """Rows of the catalogue that a reference names, and its words."""

    tube: Row
    joint: Row | None
    reference: Reference
    joints_nearby: tuple[Row, ...] = ()
    """Tool joints of other grades and connections for the same tube."""


# ---------------------------------------------------------------------- words
def _bare(word: str) -> str:
    return re.sub(r"[\s_\-]", "", word).lower()


def grade_names(catalogue: Catalogue, kind: str) -> dict[str, Row]:
    """Spelling without dashes -> row of the grade: `s135` and, for drill pipe, `s`."""
    names: dict[str, Row] = {}
    for row in catalogue.rows["grade"]:
        if row["kind"] != kind:
            continue
        names.setdefault(_bare(row["grade"]), row)
        if kind == "drill_pipe":
            names.setdefault(_bare(row["grade"]).rstrip("0123456789"), row)
    return names


def find_grade(catalogue: Catalogue, kind: str, text: str) -> Row:
    """Row of a grade, for `S-135`, `s135` or `S`."""
    names = grade_names(catalogue, kind)
    row = names.get(_bare(text))
    if row is None:
        known = ", ".join(dict.fromkeys(r["grade"] for r in names.values()))
        raise ReferenceProblem(f"a grade: {known}", "another steel: yield_strength instead of grade")
    return row


def connection_names(catalogue: Catalogue) -> dict[str, str]:
    """Spelling without blanks -> name of the connection in the catalogue: `41/2if` -> NC50."""
    own = [row["connection"] for name in ("tool_joint", "hwdp") for row in catalogue.rows[name]]
    names = {_bare(name): name for name in (*NUMBERED, *OTHER_CONNECTIONS)}
    names |= {_bare(old): new for old, new in INTERCHANGE.items()}
    return names | {_bare(name): name for name in reversed(own)}


def same_connection(catalogue: Catalogue, one: str, other: str) -> bool:
    """Whether two names are names of one connection."""
    names = connection_names(catalogue)
    return names.get(_bare(one), _bare(one)) == names.get(_bare(other), _bare(other))


def find_threads(catalogue: Catalogue, name: str) -> Row | None:
    """Threads of a connection; None if the catalogue has no such name."""
    rows = catalogue.rows["connection"]
    return next((row for row in rows if same_connection(catalogue, name, row["connection"])), None)


def parse(catalogue: Catalogue, text: str) -> Reference:
    """Read a text reference; raises ReferenceProblem."""
    text = _SAID_BY_KIND.sub(" ", text)
    at_start = size_at_start(text.strip())
    if at_start is None or at_start[0] <= 0:
        raise ReferenceProblem("SIZE WEIGHT and further words, such as 5in 19.50 S-135 NC50 premium")
    size, rest = at_start
    match = _WEIGHT.match(rest)
    if match is None:
        raise ReferenceProblem(
            "a nominal weight in lb/ft after the size, such as 5in 19.50 S-135 NC50 premium",
            weights_text(catalogue, size),
        )
    words = _sorted_words(catalogue, size, [w for w in re.split(r"[\s,]+", rest[match.end() :]) if w])
    return Reference(size, float(match[1]), **words)


def _sorted_words(catalogue: Catalogue, size: float, tokens: Sequence[str]) -> dict[str, str]:
    """The words of a reference by their meaning."""
    grades, connections = grade_names(catalogue, "drill_pipe"), connection_names(catalogue)
    meanings: dict[str, tuple[str, str]] = {}
    meanings |= {spelled: ("connection", name) for spelled, name in connections.items()}
    meanings |= {spelled: ("grade", str(row["grade"])) for spelled, row in grades.items()}
    meanings |= {_bare(u): ("upset", u) for u in UPSETS} | {w: ("wear", c) for w, c in CLASSES.items()}
    for short in ("XH", "IF", "FH"):  # 5in ... XH is 5 XH
        name = connections.get(_bare(inch_text(size).removesuffix(" in") + short))
        if name is not None:
            meanings.setdefault(_bare(short), ("connection", name))
    found: dict[str, str] = {}
    i = 0
    while i < len(tokens):
        for count in (3, 2, 1):
            group = tokens[i : i + count]
            meaning = meanings.get(_bare("".join(group))) if len(group) == count else None
            if meaning is not None:
                break
        else:
            raise _unknown(tokens[i], meanings)
        kind, value = meaning
        if found.get(kind, value) != value:
            what = {"wear": "class"}.get(kind, kind)
            raise ReferenceProblem(f"one {what}: {found[kind]} and {value} do not agree")
        found[kind] = value
        i += count
    return found


def _unknown(word: str, meanings: Iterable[str]) -> ReferenceProblem:
    near = difflib.get_close_matches(_bare(word), list(meanings), 3, 0.5)
    if _bare(word).startswith("class") or _bare(word) in ("3", "2"):
        near = ["new", "premium", "class 2"]
    hint = f"near words: {', '.join(n.upper() if n not in CLASSES else n for n in near)}" if near else ""
    want = f"grade, upset (EU, IU, IEU), connection or class (new, premium, class 2) instead of '{word}'"
    return ReferenceProblem(want, hint)


# ---------------------------------------------------------------------- rows
def _of_size(rows: Iterable[Row], size: float, column: str = "size") -> list[Row]:
    """Rows of the size that is nearest to ``size`` [in], within the tolerance."""
    near = [row for row in rows if abs(row[column] - size) <= SIZE_TOLERANCE * row[column]]
    if not near:
        return []
    best = min(abs(row[column] - size) for row in near)
    return [row for row in near if abs(row[column] - size) <= best + 1e-6]


def _names_of(rows: Iterable[Row], weight: str) -> str:
    names = dict.fromkeys(f"{inch_text(row['size'])} {row[weight]:.2f}" for row in rows)
    return "; ".join(names)


def weights_text(catalogue: Catalogue, size: float, table: str = "drill_pipe") -> str:
    """`weights of 5 in: 16.25, 19.50, 25.60 lb/ft`; empty if the size has none."""
    weight = "weight" if table == "hwdp" else "nominal"
    rows = _of_size(catalogue.rows[table], size)
    weights = sorted({float(row[weight]) for row in rows})
    if not weights:
        return ""
    return f"weights of {inch_text(rows[0]['size'])}: {', '.join(f'{w:.2f}' for w in weights)} lb/ft"


def find_tube(catalogue: Catalogue, table: str, size: float, weight: float) -> Row:
    """Row of a tube by size [in] and nominal weight [lb/ft]; raises ReferenceProblem."""
    column = "weight" if table == "hwdp" else "nominal"
    rows = _of_size(catalogue.rows[table], size)
    if not rows:
        nearest = sorted(catalogue.rows[table], key=lambda row: abs(row["size"] - size))[:3]
        raise ReferenceProblem(
            f"a size of the catalogue within {SIZE_TOLERANCE:.1%}: there is no {inch_text(size)}",
            f"nearest rows: {_names_of(nearest, column)}",
        )
    fitting = [row for row in rows if abs(row[column] - weight) <= WEIGHT_TOLERANCE]
    if not fitting:
        raise ReferenceProblem(
            f"a weight that the size has: there is no {inch_text(rows[0]['size'])} {weight:.2f} lb/ft",
            weights_text(catalogue, size, table),
        )
    return min(
        fitting, key=lambda row: abs(row[column] - weight)
    )  # the first of equal ones: the user's before the built-in


def _replaces(earlier: Row, row: Row) -> bool:
    """Whether an earlier row, for instance of the user, is the same tool joint: connection, and upset if it has one."""
    if _bare(earlier["connection"]) != _bare(row["connection"]):
        return False
    return not earlier["upset"] or earlier["upset"].upper() == (row["upset"] or "").upper()


def _joint_text(row: Row) -> str:
    upset = f" {row['upset']}" if row["upset"] else ""
    return f"{row['grade']}{upset} {row['connection']} {inch_text(row['od'])} x {inch_text(row['id'])}"


def _drill_pipe(catalogue: Catalogue, reference: Reference) -> Row:
    """Row of the tube; if only heavy-wall pipe has the size and weight, the hint says so."""
    try:
        return find_tube(catalogue, "drill_pipe", reference.size, reference.weight)
    except ReferenceProblem as problem:
        try:
            find_tube(catalogue, "hwdp", reference.size, reference.weight)
        except ReferenceProblem:
            raise problem from None
        raise ReferenceProblem(problem.want, f"heavy-wall pipe has it: kind: hwdp; {problem.hint}") from None


def find_pipe(
    catalogue: Catalogue,
    text: str | Reference,
    given: Mapping[str, str | None] | None = None,
    joint_needed: bool = True,
) -> PipeChoice:
    """Rows of the drill pipe that a reference names; raises ReferenceProblem.

    given: grade and connection beside the reference, which override its words
    joint_needed: a tool joint must be found; otherwise it may be missing
    """
    reference = parse(catalogue, text) if isinstance(text, str) else text
    given = given or {}
    tube = _drill_pipe(catalogue, reference)
    grade = find_grade(catalogue, "drill_pipe", given.get("grade") or reference.grade or DEFAULT_GRADE)
    connection = given.get("connection") or reference.connection
    size, nominal = tube["size"], tube["nominal"]
    of_tube = [
        row
        for row in _of_size(catalogue.rows["tool_joint"], size)
        if abs(row["nominal"] - nominal) <= WEIGHT_TOLERANCE
    ]
    grades = grade_names(catalogue, "drill_pipe")
    # threads of one maker among many are no guess: they must be named, unless they are the user's own
    by_name = [row for row in Catalogue.built_in().rows["tool_joint"] if row["make_up"] is not None]

    def fits(row: Row) -> bool:
        its, upset = grades.get(_bare(row["grade"])), row["upset"]
        return (
            its is not None
            and its["grade"] == grade["grade"]
            and not (reference.upset and upset and upset.upper() != reference.upset)
            and (
                same_connection(catalogue, connection, row["connection"])
                if connection
                else row not in by_name
            )
        )

    rows: list[Row] = []
    for row in filter(fits, of_tube):
        if not any(_replaces(earlier, row) for earlier in rows):
            rows.append(row)
    if len(rows) != 1 and joint_needed:
        raise _no_single_joint(rows, of_tube, (size, nominal, grade["grade"]), connection, reference.upset)
    return PipeChoice(tube, rows[0] if len(rows) == 1 else None, reference, tuple(of_tube))


def _no_single_joint(
    rows: list[Row],
    of_tube: list[Row],
    pipe: tuple[float, float, str],
    connection: str | None,
    upset: str | None,
) -> ReferenceProblem:
    """The error that ``rows``, of those ``of_tube``, are not one tool joint; pipe: size [m], nominal weight, grade."""
    size, nominal, grade = pipe
    name = f"{inch_text(size)} {nominal:.2f}"
    if rows:
        return ReferenceProblem(
            f"one tool joint; {name} {grade} has {' and '.join(_joint_text(row) for row in rows)}",
            "say the connection" if len({_bare(r["connection"]) for r in rows}) > 1 else "say the upset",
        )
    asked = f" with {connection}" if connection else ""
    asked += f" {upset}" if upset else ""
    others, own = (
        "; ".join(_joint_text(row) for row in of_tube),
        "give tool_joint: {od: .., id: .., length: ..}",
    )
    return ReferenceProblem(
        f"a tool joint in the catalogue for {name}: there is none for {grade}{asked}",
        f"there are {others}; or {own}" if others else own,
    )


def find_heavy_pipe(catalogue: Catalogue, text: str, connection: str | None = None) -> Row:
    """Row of the heavy-wall drill pipe that a reference names; raises ReferenceProblem."""
    reference = parse(catalogue, text)
    for word, what in ((reference.wear, "class"), (reference.upset, "upset"), (reference.grade, "grade")):
        if word is not None:
            raise ReferenceProblem(f"no {what} for heavy-wall drill pipe: SIZE WEIGHT CONNECTION")
    first = find_tube(catalogue, "hwdp", reference.size, reference.weight)
    connection = connection or reference.connection
    rows = [
        row
        for row in _of_size(catalogue.rows["hwdp"], first["size"])
        if abs(row["weight"] - first["weight"]) <= WEIGHT_TOLERANCE
    ]
    fitting: dict[str, Row] = {}
    for row in rows:
        if connection is None or same_connection(catalogue, connection, row["connection"]):
            fitting.setdefault(_bare(row["connection"]), row)
    if not fitting:
        names = ", ".join(row["connection"] for row in rows)
        raise ReferenceProblem(f"a connection of this heavy-wall pipe: {names}")
    if len(fitting) > 1:
        raise ReferenceProblem(
            f"one connection of {', '.join(row['connection'] for row in fitting.values())}",
            "say the connection",
        )
    return next(iter(fitting.values()))
