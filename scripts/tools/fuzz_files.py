"""Fuzz test of the readers of surveys and XML documents: right stations, or a message that helps.

A survey is written in a random dialect from known stations. Unchanged, it must be read as these stations. With one cell
changed, all other stations must stay, and the changed one must be what the cell says, left out with a remark, or refused.
With its text corrupted, every depth and angle that is read must stand in the file.
"""

from __future__ import annotations

import math
import random
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fuzz_judge import Failure, guarded
from fuzz_mutations import CELLS, TEXT_CHANGES, mutate_text

from drillpetsc.case.files.survey_file import read_survey
from drillpetsc.case.importers.fragment import fragment
from drillpetsc.case.importers.stations import Rules, Stations
from drillpetsc.errors import CaseError

UNITS = {"m": 1.0, "ft": 0.3048, "deg": math.pi / 180, "rad": 1.0}
HEADS = {
    "md": ("MD", "Measured Depth", "Depth", "md", "DEPT", "Meas. Depth", "Survey Depth"),
    "inclination": ("Inc", "Incl.", "inclination", "DEV", "Drift", "Angle"),
    "azimuth": ("Azi", "Azimuth", "AZIM", "hazi", "Azi Grid", "bearing"),
    "other": ("TVD RKB", "Remark", "Tool", "GR"),
}
BAD_CELLS = (
    *CELLS, "N23E", "S 45 W", "10 30", "10°30'", "1,234.5", "1.234,5", "12,5", "-999.25", "-9999", "+5", "5.", ".5", "1e2", "1E-3", "5e", "--5", "5-",
    "½", "٣", "−5", "5 deg", "#5", "5;6", "5|6", "NULL", "N/A", "-", "1/2", "0x1F", "True", "5,", ",5", "1 234", "1'234", "1e5000", "45.0.0",
)  # fmt: skip
NUMBER = re.compile(r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")


@dataclass(frozen=True)
class Dialect:
    """How a survey is written.

    separator, decimal: between cells; in numbers
    depth, angle: units
    """

    separator: str
    decimal: str
    depth: str
    angle: str


@dataclass
class Tally:
    """Outcomes by kind of mutant, and the first file of each distinct failure."""

    outcomes: Counter[tuple[str, str]] = field(default_factory=Counter)
    failures: dict[str, tuple[int, bytes]] = field(default_factory=dict)


# ---------------------------------------------------------------------- surveys
def stations(r: random.Random) -> list[tuple[float, float, float]]:
    """Stations [m, deg, deg] of a hole without sharp bends, from 0 or from a vertical one below."""
    md, inclination, azimuth = r.choice([0.0, 0.0, 29.9]), 0.0, round(r.uniform(0, 359), 1)
    out = [(md, inclination, azimuth)]
    for _ in range(r.randint(2, 8)):
        md += round(r.uniform(25, 400), 2)
        inclination = round(min(max(inclination + r.uniform(-4, 8), 1.0), 95), 2)
        azimuth = round((azimuth + r.uniform(-5, 5)) % 360, 2)
        out.append((round(md, 2), inclination, azimuth))
    return out


def written(
    r: random.Random, path: list[tuple[float, float, float]]
) -> tuple[list[list[str]], list[str], Dialect, list[int]]:
    """(rows of cells with the header first, lines before them, dialect, columns of md, inclination, azimuth)."""
    separator = r.choice([",", ",", ";", "\t", "  "])
    dialect = Dialect(
        separator,
        "," if separator == ";" and r.random() < 0.5 else ".",
        r.choice(["m", "ft"]),
        r.choice(["deg", "deg", "rad"]),
    )
    columns = ["md", "inclination", "azimuth", *(["other"] if r.random() < 0.4 and separator != "  " else [])]
    r.shuffle(columns)
    form = r.choice([" [{}]", " ({})", "({})", "{{{}}}", "/{}"])
    heads = []
    for column in columns:
        name = r.choice(HEADS[column])
        unit = {"md": dialect.depth, "other": ""}.get(column, dialect.angle)
        if separator == "  ":
            name, form = name.replace(" ", "_"), "[{}]"
        heads.append(name + (form.format(unit) if unit else ""))
    rows = [heads]
    for md, inclination, azimuth in path:
        values = {
            "md": f"{md / UNITS[dialect.depth]:.9f}",
            "inclination": f"{math.radians(inclination) / UNITS[dialect.angle]:.9f}",
            "azimuth": f"{math.radians(azimuth) / UNITS[dialect.angle]:.9f}",
            "other": r.choice(["", "ok", "17.5"]),
        }
        rows.append([values[c].replace(".", dialect.decimal) if c != "other" else values[c] for c in columns])
    before = r.choice(
        [[], ["# a comment"], ["! Well X", "", "// from a program"], ["Company ACME", "Well X-1", ""]]
    )
    return rows, before, dialect, [columns.index(c) for c in ("md", "inclination", "azimuth")]


def as_text(rows: list[list[str]], before: list[str], dialect: Dialect, end: str) -> str:
    lines = [
        dialect.separator.join(
            f'"{c}"' if dialect.separator in c and "\n" not in c and '"' not in c else c for c in row
        )
        for row in rows
    ]
    return end.join([*before, *lines]) + end


def degrees_of(found: Stations) -> list[tuple[float, float, float]]:
    return [
        (md, math.degrees(inclination), math.degrees(azimuth))
        for md, inclination, azimuth in zip(found.md, found.inclination, found.azimuth, strict=True)
    ]


def near(a: tuple[float, float, float], b: tuple[float, float, float]) -> bool:
    """Whether two stations are the same, but for the azimuth of a vertical one."""
    return (
        abs(a[0] - b[0]) < 1e-5
        and abs(a[1] - b[1]) < 1e-6
        and (min(a[1], b[1]) < 0.5 or abs(math.remainder(a[2] - b[2], 360)) < 1e-6)
    )


def survey_mutant(r: random.Random) -> tuple[bytes, Callable[[Stations], None], str]:
    """(file, check of what is read, kind of mutant)."""
    path = stations(r)
    rows, before, dialect, places = written(r, path)
    end = r.choice(["\n", "\n", "\r\n"])
    kind = r.choice(["plain", "cell", "cell", "cell", "text", "text", "bytes"])
    expected = path if path[0][0] == 0 else [(0.0, 0.0, path[0][2]), *path]
    if kind == "plain":
        raw = as_text(rows, before, dialect, end).encode(r.choice(["utf-8", "utf-8-sig", "utf-16"]))

        def check(found: Stations) -> None:
            got = degrees_of(found)
            if len(got) != len(expected) or not all(map(near, got, expected)):
                raise Failure("stations of an unchanged survey differ")

        return raw, check, kind
    if kind == "cell":
        k = r.randint(1, len(path))
        column = r.randint(0, 2)
        cell = r.choice(BAD_CELLS)
        if len(cell) > 50:
            cell = cell[:50]
        rows[k][places[column]] = cell
        raw = as_text(rows, before, dialect, end).encode("utf-8", "surrogatepass")
        others = [station for i, station in enumerate(path, 1) if i != k]

        def check_cell(found: Stations) -> None:
            got = degrees_of(found)
            lost = [station for station in others if not any(near(station, one) for one in got)]
            if lost:
                raise Failure(f"stations beside a changed cell are lost: {cell!r}")
            new = [one for one in got if one[0] > 0 and not any(near(one, station) for station in others)]
            if len(new) > 1:
                raise Failure(f"a changed cell makes two stations: {cell!r}")
            if not new:
                told = any(
                    "missing" in remark or "repeated" in remark or "inserted" in remark
                    for remark in found.remarks
                )
                comment = places[column] == 0 and cell.lstrip().startswith(("#", "!", "//", ";"))
                if not told and not comment and len(got) < len(others) + 1:
                    raise Failure(f"a station is left out without a remark: {cell!r}")
                return
            unit = UNITS[dialect.depth if column == 0 else dialect.angle] * (
                1 if column == 0 else 180 / math.pi
            )
            if column == 2 and new[0][1] < 0.5:
                return
            if not any(
                abs(value * unit - new[0][column]) < 1e-6 * max(1, abs(new[0][column]))
                for value in readings(cell)
            ):
                raise Failure(f"the cell {cell!r} was read as {new[0][column] / unit:g}")

        return raw, check_cell, kind
    text = as_text(rows, before, dialect, end)
    if kind == "text":
        for _ in range(r.choice([1, 1, 2])):
            text = r.choice(TEXT_CHANGES)(r, text)
        raw = text.encode("utf-8", "surrogatepass")
    else:
        raw = mutate_text(r, text)
    return raw, lambda found: _in_file(found, raw), kind


def readings(cell: str) -> list[float]:
    """Numbers that a cell may be: with a decimal point, a decimal comma, or commas between thousands."""
    out = []
    for text in (
        cell,
        cell.replace(",", "."),
        cell.replace(",", ""),
        cell.replace(".", "").replace(",", "."),
    ):
        try:
            out.append(float(text.strip().strip("\"'")))
        except ValueError:
            continue
    return out


def _in_file(found: Stations, raw: bytes) -> None:
    """Raise Failure where a depth or an inclination that was read does not stand in the file, in any unit."""
    wide = raw[:2] in (b"\xff\xfe", b"\xfe\xff")
    text = raw.decode("utf-16" if wide else "utf-8", "replace")
    numbers: set[float] = {0.0}
    for variant in (
        text,
        text.replace(",", "."),
        text.replace(",", ""),
        text.replace(".", "").replace(",", "."),
    ):
        for match in NUMBER.findall(variant):
            try:
                numbers.add(abs(float(match)))
            except (ValueError, OverflowError):
                continue
    for values, units in (
        (found.md, (1.0, 0.3048, 1200 / 3937, 0.0254, 1e-3, 1e-2, 1e3)),
        (found.inclination, (1.0, math.pi / 180)),
    ):
        for value in values:
            if not any(
                abs(number * unit - value) <= 1e-9 * max(1.0, value) for unit in units for number in numbers
            ):
                raise Failure("a value that was read does not stand in the file")


# ---------------------------------------------------------------------- XML
SPACE = 'xmlns="http://www.witsml.org/schemas/1series" version="1.4.1.1"'
UOMS = (
    "m",
    "ft",
    "ftUS",
    "in",
    "mm",
    "dega",
    "rad",
    "kg/m",
    "lbm/ft",
    "in2",
    "",
    "kN",
    "°",
    "furlong",
    "9**9",
    "m/(",
    "M",
    "FT",
)
WORDS = (
    "", "0", "-1", "1e400", "nan", "inf", "12OO", "1,5", "9" * 400, "drill pipe", "bit PDC", "casing", "open hole", "&lt;", "&amp;", "&#0;", "&#x41;",
    "&unknown;", "<![CDATA[5]]>", "<!-- 5 -->", "5<b/>5", "５", "0.0001", "1e-300", "1e30", "45", "181",
)  # fmt: skip
PARTS = (
    '<!DOCTYPE a [<!ENTITY x "y">]>', '<?xml version="1.1"?>', '<?xml version="1.0" encoding="cp037"?>', '<?xml version="1.0" encoding="nothing"?>',
    "<a>" * 100, "</a>", "<md uom='ft'>5</md>", "<![CDATA[", "<!--", "&x;", "<", ">", "\x00", "\ufeff", "<?pi?>", "<tubularComponent/>",
    "<wbGeometrySection/>", "<trajectoryStation/>", "<sequence>1</sequence>",
)  # fmt: skip


def _value(r: random.Random, name: str, number: float, uom: str) -> str:
    return f'<{name} uom="{uom}">{number:.6g}</{name}>'


def document(r: random.Random) -> str:
    """A valid WITSML document: a trajectory, a tubular or the geometry of a wellbore."""
    kind = r.choice(["trajectory", "tubular", "wbGeometry"])
    if kind == "trajectory":
        uom = r.choice(["m", "ft"])
        parts = [
            f"<trajectoryStation>{_value(r, 'md', md / UNITS[uom], uom)}{_value(r, 'incl', inclination, 'dega')}"
            f"{_value(r, 'azi', azimuth, 'dega')}{_value(r, 'tvd', md, 'm') if r.random() < 0.2 else ''}</trajectoryStation>"
            for md, inclination, azimuth in stations(r)
        ]
        r.shuffle(parts)
    elif kind == "tubular":
        kinds = [
            "bit PDC",
            *r.choices(
                ["drill pipe", "drill collar", "stabilizer", "sub-MWD", "heavy weight drill pipe"],
                k=r.randint(1, 5),
            ),
        ]
        parts = []
        for i, name in enumerate(kinds, 1):
            od = r.uniform(0.1, 0.2)
            sizes = (
                _value(r, "id", od / 2 * 1e3, "mm")
                + _value(r, "od", od / 0.0254, "in")
                + _value(r, "len", r.uniform(1, 190), "m")
            )
            weight = (
                _value(r, "wtPerLen", r.uniform(0.7, 1.2) * 7850 * math.pi / 4 * od**2 * 0.75, "kg/m")
                if r.random() < 0.6
                else ""
            )
            blade = (
                f"<stabilizer>{_value(r, 'odBladeMx', od * 1.3, 'm')}</stabilizer>"
                if name == "stabilizer"
                else ""
            )
            nozzle = f"<nozzle>{_value(r, 'diaNozzle', 10, 'mm')}</nozzle>" if i == 1 else ""
            order = f"<sequence>{i}</sequence>"
            parts.append(
                f"<tubularComponent>{order}<typeTubularComp>{name}</typeTubularComp>{sizes}{weight}{blade}{nozzle}</tubularComponent>"
            )
    else:
        top, parts = 0.0, []
        for name in [*["casing"] * r.randint(0, 2), "open hole"]:
            bottom = top + r.uniform(50, 900)
            sizes = (
                _value(r, "mdTop", top, "m")
                + _value(r, "mdBottom", bottom, "m")
                + _value(r, "idSection", r.uniform(6, 20), "in")
            )
            friction = "<factFric>0.25</factFric>" if r.random() < 0.5 else ""
            parts.append(
                f"<wbGeometrySection><typeHoleCasing>{name}</typeHoleCasing>{sizes}{friction}</wbGeometrySection>"
            )
            top = float(f"{bottom:.6g}")
    body = "\n".join(parts)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n<{kind}s {SPACE}><{kind}><nameWell>W</nameWell>\n{body}\n</{kind}></{kind}s>\n'


def xml_mutant(r: random.Random) -> tuple[bytes, str]:
    """(file, kind of mutant)."""
    text = document(r)
    kind = r.choice(["plain", "value", "value", "element", "element", "part", "text", "bytes"])
    if kind == "plain":
        return text.encode(r.choice(["utf-8", "utf-8-sig"])), kind
    if kind == "value":
        spots = list(re.finditer(r'(?<=>)[^<>\n]+(?=<)|(?<=uom=")[^"]*', text))
        spot = r.choice(spots)
        new = r.choice(UOMS if text[spot.start() - 1] == '"' else WORDS)
        text = text[: spot.start()] + new + text[spot.end() :]
    elif kind == "element":
        spots = list(re.finditer(r"<(\w+)[^<>]*>[^<>]*</\1>|<(\w+)>", text))
        spot = r.choice(spots)
        new = r.choice(
            [
                "",
                spot.group() * 2,
                spot.group().upper(),
                spot.group().replace("<", "<x:", 1),
                spot.group()[:-1],
            ]
        )
        text = text[: spot.start()] + new + text[spot.end() :]
    elif kind == "part":
        k = r.choice([0, r.randint(0, len(text)), text.find("?>") + 2])
        text = text[:k] + r.choice(PARTS) + text[k:]
    elif kind == "text":
        text = r.choice(TEXT_CHANGES)(r, text)
    else:
        return mutate_text(r, text), kind
    return text.encode("utf-8", "surrogatepass"), kind


# ---------------------------------------------------------------------- judging
def check_refusal(error: CaseError, file: Path) -> None:
    """Raise Failure unless the message names the file, a line and what is allowed, in printable lines."""
    for each in (error, *error.also):
        if (
            not each.want
            or each.file is None
            or Path(each.file) != file
            or (each.line is None and "UTF-8" not in each.want)
        ):
            raise Failure(f"message without file, line or what is allowed: {each.want[:40]}")
        if any(not letter.isprintable() and letter != "\n" for letter in str(each)):
            raise Failure("message with unprintable letters")
    if len(error.also) > 9:
        raise Failure("more than ten errors at once")


def judge(number: int, seed: int, folder: Path) -> tuple[str, str, bytes]:
    """(kind of mutant, outcome, file) of a mutant: `read`, `refused` or the name of a failure."""
    r = random.Random(f"{seed} file {number}")
    name, raw, kind = "", b"", ""
    try:
        if number % 2:
            raw, check, how = survey_mutant(r)
            name, kind = "well.csv", f"survey {how}"
            file = folder / name
            file.write_bytes(raw)
            found = guarded(lambda: read_survey(str(file), Rules()))
            guarded(lambda: check(found))
            _possible(found)
        else:
            raw, how = xml_mutant(r)
            name, kind = "well.xml", f"xml {how}"
            file = folder / name
            file.write_bytes(raw)
            guarded(lambda: fragment([file], folder))
    except CaseError as error:
        try:
            check_refusal(error, folder / name)
        except Failure as failure:
            return kind, str(failure), raw
        return kind, "REFUSED UNCHANGED" if kind.endswith("plain") and not _fair(error) else "refused", raw
    except Failure as failure:
        return kind, str(failure), raw
    return kind, "read", raw


def _fair(error: CaseError) -> bool:
    """Whether an unchanged file may be refused: a comma that may be either."""
    return "show what the comma is" in error.want


def _possible(found: Stations) -> None:
    """Raise Failure unless the stations are those of a hole."""
    rising = all(a < b for a, b in zip(found.md, found.md[1:], strict=False))
    if not rising or found.md[0] != 0 or not all(0 <= angle <= math.pi + 1e-9 for angle in found.inclination):
        raise Failure("stations that are no hole")
    if not all(
        math.isfinite(value) for values in (found.md, found.inclination, found.azimuth) for value in values
    ):
        raise Failure("stations that are not finite")


def run(count: int, seed: int, folder: Path, keep: Path, say: Any) -> Tally:
    """Test so many mutants; the first file of each failure goes to the folder `keep`."""
    tally = Tally()
    for number in range(1, count + 1):
        kind, outcome, raw = judge(number, seed, folder)
        failed = outcome not in ("read", "refused")
        tally.outcomes[kind, "FAILED" if failed else outcome] += 1
        if failed and outcome not in tally.failures:
            tally.failures[outcome] = number, raw
            keep.mkdir(parents=True, exist_ok=True)
            (keep / f"file-{number}{'.csv' if number % 2 else '.xml'}").write_bytes(raw)
            say(f"file {number} ({kind}): {outcome}")
    return tally


def table(tally: Tally) -> list[str]:
    """The outcomes by kind of mutant."""
    rows = [f"{'file changed as':<16}" + "".join(f"{end:>10}" for end in ("read", "refused", "FAILED"))]
    for kind in sorted({kind for kind, _ in tally.outcomes}):
        rows.append(
            f"{kind:<16}"
            + "".join(f"{tally.outcomes[kind, end]:>10}" for end in ("read", "refused", "FAILED"))
        )
    return rows
