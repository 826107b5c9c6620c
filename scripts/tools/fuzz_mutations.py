"""Mutations of case data and of case texts: what typing, copying, other programs and malice do to a case
file.

Every choice is made by `random`: a random.Random, or anything with its methods (hypothesis puts its own in).
"""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Iterator
from typing import Any

Path = tuple[str | int, ...]

DEEP = "[" * 3000 + "]" * 3000

#: scalars that have broken readers of numbers, of units, of text, of YAML
SCALARS: tuple[Any, ...] = (
    True, False, 0, -0.0, 1, -1, 2, 0.5, 1e300, -1e300, 1e-300, 5e-324, 1e9, 1e-9, math.nan, math.inf, -math.inf, 10**400, 2**63, -(2**64),
    "", " ", "nan", "inf m", "-inf", "1e400 m", "1e-400 m", "1 furlong", "1 m m", "12:30:45", "0x1F", "0o17", "1_000", "yes", "no", "on",
    "off",
    "none", "null", "~", "２ m", "é", "日本 🛢", "\u2028", "\x00", "\x1b[31m", "\ud800", "a" * 5000, "1 " + "m" * 5000, "9" * 5000,
    "9" * 5000 + " m",
    "1" + " m" * 400, "1/0 in", "1/3 in", f"1/{'9' * 400} in", "1 m^9**9**9", "1 m**99999999", "1 9**9**9**9", "1 m^0.5", "1 (((m",
    "1 m)", "%", "1 %",
    "1 m*9**9**9", "1 deg/9**9**9 m", "1 m^n", "1 s^n", "1 lambda", "1 __import__('os')", "1 degC", "20 degF", "1 m/0", "1 0 m",
    "1e999999999 m",
    "../", "/", ".", "..", "/dev/null", "/dev/zero", "/proc/self/mem", "cases", "a/" * 3000, "f" * 300, "statics", "clamped", "bit",
    "free", "pipe",
    "2001-01-01", "1,5 m", "1.5.5 m", "+-1 m", "1 rpm", "80 Hz", "5 kg", "3 Pa", "1 deg/30 m", "25 lbf/100 ft^2", "- 1", "1 µm", "1 m²",
    "1e3", "&a", "*a",
    "{a: b}", "9 5/8 in", "-9 5/8 in", "!!python/object:os.system x",
)  # fmt: skip

BLOCKS: tuple[Any, ...] = (
    [], {}, [[]], [None], [1], [1, 2], [1, 2, 3], ["1 m", True, {}], {"a": 1}, {"kind": []}, {"kind": {}}, {"kind": "pipe"},
    {"kind": "bit"},
    {"kind": "clamped"}, {"kind": None}, {"model": "newtonian"}, {"time": [], "value": []}, {"time": [0, 1], "value": [0, 1]},
    {"time": [0, 1], "value": [0]}, {"time": [1, 0], "value": [0, 1]}, {"time": [0, 0, 0], "value": [0, 1, 2]}, {"time": 0, "value": 1},
    {"time": [0, math.nan], "value": [0, 1]}, {"time": [0, 1e-300], "value": [0, 1e300]},
    {"time": [-1e300, 1e300], "value": [-1e300, 1e300]},
    {"ramp": 1, "value": 1}, {"ramp": 0, "value": 1}, {"ramp": -1, "value": 1}, {"ramp": 1e-300, "value": 1e300}, {"ramp": {}, "value": []},
    {"ramp": 1, "time": [0], "value": 1}, {"ramp": 1}, {"": 1}, {"a.b": 1}, {"a[b": 1}, {"[0]": 1}, {"a:b": 1}, {"[": 1, "]": 2},
    {"x" * 5000: 1},
    {"é": 1}, {"\x00": 1}, {"\ud800": 1}, {"from": 1}, {"from_": 1}, {"self": 1}, {"__class__": 1}, {"model_config": 1}, {"data": 1},
    {"-ts_dt": 1},
    [0] * 300, {str(i): i for i in range(300)},
)  # fmt: skip

#: keys with values that are added to a block; blocks are named by paths without list numbers
EXTRAS: dict[str, tuple[tuple[str, Any], ...]] = {
    "": (
        ("hold_string", True), ("hold_string", False), ("gravity", 5.0), ("title", "t"), ("initial", {"from": "rest"}), ("contact", "none"),
        ("output", {"history_every": 0.5}), ("output", {"history_every": 1e-12}), ("output", {"checkpoint_every": 1e-12}),
        ("top", "pinned"),
        ("fluid", {"density": 1000, "rheology": {"model": "newtonian", "viscosity": 1e-3}}), ("formation", {"drillability": 1e-8}),
        ("contact", {"stiffness": 1e7}), ("loads", [{"at": 1, "force": [1, 0, 0]}]), ("petsc", {"ts_dt": 0.1}), ("time", {"end": 3}),
        ("well", {"survey": {"md": [0, 100], "inclination": [0, 0], "azimuth": [0, 0]},
                  "sections": [{"to": 100, "kind": "open_hole", "diameter": 0.3}]}),
        ("bottom", "bit"), ("bottom", "pinned"), ("material", {"young": 7e10}), ("beam", {"formulation": "ancf"}),
        ("beam", {"formulation": "quaternion"}),
        ("joints", []), ("joints", [{"at": 4, "kind": "universal"}]), ("units", "field"), ("units", "metric"), ("units", "SI"), ("force_unit", "t"),
        ("joints", [{"at": 30, "kind": "slider"}]),
    ),
    "string": (
        ("element_length", 3.0), ("element_length", 1e-9), ("friction", 0.1), ("name", "x"), ("id", 0.01), ("od", 0.1), ("mass", 50.0),
        ("material", {"young": 2e11}), ("material", {"damping": {"mass": 1.0}}), ("bend", {"angle": 0.02}), ("bend", {"angle": 0}),
        ("inertia", {"axial": 2.0}), ("center_of_gravity", 0.3), ("unbalance", 0.1), ("unbalance_angle", 1.0), ("curvature", 1e-3),
        ("curvature_angle", 1.0), ("eccentricity", 1e-3), ("eccentricity_angle", 1.0), ("nozzle_area", 3e-4),
        ("initial", {"imperfection": 0.02}),
        ("damping", {"mass": 1.0}),
    ),
    "well.sections": (("friction", 0.1), ("compliance", {"young": 1e10}), ("to", 3.0), ("roughness", 1e-3)),
    "top": (("lowering", 0.1), ("rotation", "60 rpm"), ("force", 1e4), ("stiffness", 1e7), ("damping", 1.0), ("inertia", 3.0)),
    "bottom": (("stiffness", 1e7), ("friction", 0.1), ("plugged", True), ("force", [1, 2, 3]), ("moment", [1, 2, 3])),
    "loads": (("value_over", 2.0), ("frame", "section"), ("force", [1, 2, 3]), ("moment", [1, 2, 3]), ("to", 3.0), ("at", 3.0)),
    "contact": (
        ("restitution_speed", 2.0), ("stribeck", {"static": 0.9, "speed": 0.5}), ("points_per_element", 4), ("law", "hertz"),
        ("stiffness", 1e7),
        ("slip_velocity", 0.1), ("restitution", 1),
    ),
    "fluid": (
        ("annulus", False), ("annulus", True), ("bit_volume", 1e-2), ("choke", {"area": 1e-3}), ("flow_line", 0.5), ("pump_pressure", 1e5),
        ("outlet_pressure", 1e5), ("clinging", 0.3), ("added_mass", 2.0), ("lateral_damping", 3.0), ("lateral_damping_speed", 3.0),
        ("rotation_drag", True), ("cuttings", "returned"), ("formulation", "hermite"), ("dynamics", "quasi_steady"),
        ("elastic_walls", False),
        ("check_valve", True), ("bulk_modulus", 1e12), ("surface_line", {"case": 3}), ("surface_line", {"length": 3, "id": 0.1}),
        ("surface_line", {"loss": 1e5, "at": 0.03}), ("annulus_rheology", {"pv": 0.02, "yp": 5}), ("rheology", {"pv": 0.02, "yp": 5}),
        ("rheology", {"n": 0.6, "k": 0.5}), ("rheology", {"ty": 3, "n": 0.6, "k": 0.5}), ("rheology", {"dial": {"600": 64, "300": 41, "3": 7}}),
        ("rheology", {"dial": {"600": 64, "300": 41, "100": 22, "3": 7}, "law": "api"}), ("flow_rate", 0.01), ("discharge_coefficient", 0.8),
    ),
    "fluid.rheology": (
        ("dial", {"600": 64, "300": 41}), ("dial", {600: 64, "300": 41, 3: 7}), ("dial", {"600": 1}), ("fit", "api"), ("fit", "least_squares"),
        ("pv", 0.02), ("yp", "18 lbf/100ft2"), ("n", 0.6), ("k", 0.5), ("ty", 3.0),
        ("shear_rate", 3.0), ("law", "exact"), ("law", "api")),
    "formation": (
        ("growth", "post_step"), ("direction", "bit_axis"), ("overgauge", 1e-3), ("walk", 0.1), ("node_spacing", 0.2),
        ("threshold", 10.0),
        ("layers", [{"from": 3}]), ("layers", [{"from": 3, "to": 4}]), ("bit_law", "drag_bit"), ("rock_anisotropy", {"dip": 0.2}),
        ("reference_speed", 9.0), ("reference_weight", 9e4), ("rotary_exponent", 0.5), ("weight_exponent", 1.2), ("drillability", 1e-8),
    ),
    "formation.layers": (("threshold", 10.0), ("rock_anisotropy", {"dip": 0.2}), ("bit_anisotropy", 0.4), ("to", 7.0),
    ("weight_exponent", 1.2)),
    "formation.bit_law": (("stiffness", 1e8), ("stiffness", 2e8), ("blades", 3), ("static", 0.9), ("dynamic", 0.1), ("speed", 2.0)),
    "joints": (("axis", [0, 0, 1]), ("constraint", "stabilised"), ("spring", 1.0), ("damping", 1.0), ("stroke", [-1, 1]),
    ("stop_stiffness", 1e6)),
    "beam": (("formulation", "quaternion"), ("constraint", "index2")),
    "initial": (("wob", "1 kN"), ("imperfection", 0.02), ("inclination", 0.4), ("azimuth", 0.4), ("from", "straight")),
    "time": (("mode", "quasi_static"), ("mode", "dynamic"), ("step", 0.5)),
    "output": (("probes", [1.5]), ("units", "field"), ("units", "SI"), ("checkpoint_every", 0.3), ("field_every", 0.3), ("history_every", 0.3)),
    "petsc": (("ts_dt", 0.1), ("x", None), ("y", True)),
    "material": (("poisson", 0.2), ("density", 7000.0), ("damping", {"mass": 0.2}), ("young", "100 GPa")),
}  # fmt: skip
ALL_EXTRAS = tuple(pair for pairs in EXTRAS.values() for pair in pairs)


# ---------------------------------------------------------------------- places
def places(data: Any, at: Path = (), levels: int = 12) -> Iterator[Path]:
    """Paths of all values below `data`, to a limited depth."""
    parts = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for step, part in parts if levels else ():
        yield (*at, step)
        yield from places(part, (*at, step), levels - 1)


def value_at(data: Any, path: Path) -> Any:
    for step in path:
        data = data[step]
    return data


def replaced(data: Any, path: Path, value: Any) -> Any:
    """A copy with the value at the path; only the containers along the path are copied."""
    if not path:
        return value
    twin = dict(data) if isinstance(data, dict) else list(data)
    twin[path[0]] = replaced(twin[path[0]], path[1:], value) if len(path) > 1 else value  # type: ignore[call-overload, index]
    return twin


def without(data: Any, path: Path) -> Any:
    holder = value_at(data, path[:-1])
    twin: Any = dict(holder) if isinstance(holder, dict) else list(holder)
    del twin[path[-1]]
    return replaced(data, path[:-1], twin) if len(path) > 1 else twin


# ---------------------------------------------------------------------- data
def _new_scalar(random: Any, data: Any, old: Any) -> Any:
    return random.choice(SCALARS)


def _new_block(random: Any, data: Any, old: Any) -> Any:
    return copy.deepcopy(random.choice(BLOCKS))


def _deep(random: Any, data: Any, old: Any) -> Any:
    for _ in range(random.choice([1, 1, 2, 3, 30, 300])):
        old = [old] if random.randint(0, 1) else {"kind": old}
    return old


def _scaled(random: Any, data: Any, old: Any) -> Any:
    near = [0.1, 10, 0.5, 2, 0.9, 1.1, 0.99, 1.01, 0.3, 3, 0, -1]
    factor = random.choice(
        [*near, *near, 1e3, 1e-3, 1e6, 1e-6, 1e12, 1e-12, 1e20, 1e-20, 1e-40, 1e100, 1e-100]
    )
    if isinstance(old, str):
        match = re.match(r"[-+\d.eE]+", old)
        try:
            return f"{float(match.group()) * factor!r}{old[match.end() :]}" if match else old * 2
        except ValueError:
            return old * 2
    if not isinstance(old, (int, float)) or isinstance(old, bool):
        return random.choice(SCALARS)
    try:
        return old * factor
    except OverflowError:  # a number of hundreds of digits, of an earlier mutation
        return old


def _respelt(random: Any, data: Any, old: Any) -> Any:
    """Another unit, or none, or a typing error in the text."""
    if not isinstance(old, str):
        return f"{old!r}{random.choice([' m', ' mm', ' kg', ' rpm', ' Pa', ' kN', ' s', '', ' %', ',0'])}"
    if shift := random.randint(0, 2):  # a letter more, or another one
        k = random.randint(0, len(old))
        letter = random.choice(list("0123456789eE.-+/^*( )mksNPa\t°²µ,_x'\""))
        return old[:k] + letter + old[k + shift - 1 :]
    return re.split(r"(?<=\d)\s*(?=[A-Za-z])", old)[0] + random.choice(
        ["", " m", " kg", " deg", " Pa s", "mm", " in"]
    )


def _elsewhere(random: Any, data: Any, old: Any) -> Any:
    return value_at(data, random.choice(list(places(data))))  # not copied: nothing is changed in place


NEW_VALUES = (
    _new_scalar,
    _new_scalar,
    _new_block,
    *[_scaled] * 9,
    *[_respelt] * 3,
    _elsewhere,
    _elsewhere,
    _deep,
)


def mutate_data(random: Any, data: dict[str, Any]) -> tuple[dict[str, Any], Path]:
    """The data with one change, and the path of a new value; () if something was removed or renamed."""
    spots = list(places(data))
    if not spots:
        return {random.choice(["string", "top", ""]): random.choice(SCALARS)}, ()
    path = random.choice(spots)
    what = random.randint(0, 19)
    if what < 12:
        new = random.choice(NEW_VALUES)(random, data, value_at(data, path))
        return replaced(data, path, new), path
    if what < 14:
        return without(data, path), ()
    if what < 15:
        return _renamed(random, data, path), ()
    if what < 16:
        return _repeated(data, path), ()
    blocks = [(), *(p for p in spots if isinstance(value_at(data, p), dict))]
    block = random.choice(blocks)
    name = ".".join(step for step in block if isinstance(step, str))
    key, value = random.choice(EXTRAS[name] if name in EXTRAS and random.randint(0, 9) else ALL_EXTRAS)
    path = (*block, key)
    return replaced(data, path, copy.deepcopy(value)) if block else {**data, key: copy.deepcopy(value)}, path


def _renamed(random: Any, data: Any, path: Path) -> Any:
    holder = value_at(data, path[:-1])
    if not isinstance(holder, dict):
        return without(data, path)
    old = str(path[-1])
    new = random.choice(
        [
            old + "s",
            old.upper(),
            old[1:],
            old[::-1],
            old + "_",
            "-" + old,
            "",
            old + "." + old,
            old + "[0]",
            "π",
            "a" * 2000,
        ]
    )
    twin = {new if key == path[-1] else key: value for key, value in holder.items()}
    return replaced(data, path[:-1], twin) if len(path) > 1 else twin


def _repeated(data: Any, path: Path) -> Any:
    """Repeat a list entry; any other value becomes a list of it."""
    holder = value_at(data, path[:-1])
    if isinstance(holder, list):
        twin = [*holder[: int(path[-1])], holder[int(path[-1])], *holder[int(path[-1]) :]]
        return replaced(data, path[:-1], twin)
    return replaced(data, path, [value_at(data, path)] * 2)


# ---------------------------------------------------------------------- text
PIECES: tuple[str, ...] = (
    "!!python/object/apply:os.system [ls]", "!!binary aGFsbG8=", "!!set {a, b}", "!!omap [a: 1]", "!!timestamp 2001-01-01", "!!float 1",
    "!!int '3'",
    "!!str 5", "!own x", "!<tag:yaml.org,2002:str> 5", "&a", "*a", "*nowhere", "<<: *a", "<<: {a: 1}", "<<: 5", "<<: [1]", "? [a]\n: b",
    "? a", ": b", "? ",
    "---", "...", "%YAML 1.1\n---", "%YAML 9.9\n---", "%TAG ! tag:x,2000:\n---", "%", "12:30:45", "0o17", "017", "0b101", "0x1F", "1_000",
    "yes", "no", "on", "off", "Yes",
    "~", "null", ".inf", "-.inf", ".nan", ".NaN", "2001-01-01", "2001-01-01T10:00:00Z", "2001-99-99", "1e400", "9" * 5000,
    "0x" + "F" * 5000, "1e99999999999", "|", ">",
    "|\n  x", ">-", "|99", "'", '"', '"\\q"', '"\\ud800"', '"\\x00"', '"\\u0000"', "\x00", "\x07", "\x1b", "\x85", "\u2028", "\ufeff",
    "\ufffe", "\t", "\r", "\r\n", "\n\n", "#", " #", "{",
    "}", "[", "]", ",", ":", "{{", "[[[[", DEEP, "{a: " * 400, "- " * 400, "? " * 400, "a" * 20000, "k: 1\n" * 50, "title: x\ntitle: y",
    "string: []", "é", "日本", "🛢",
    "x: &x [*x]", "x: &x {a: *x}",
    "a: &a [1,1,1,1,1,1,1,1,1,1]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a,*a,*a]\nc: &c [*b,*b,*b,*b,*b,*b,*b,*b,*b,*b]\n"
    "d: &d [*c,*c,*c,*c,*c,*c,*c,*c,*c,*c]\ne: &e [*d,*d,*d,*d,*d,*d,*d,*d,*d,*d]\nf: &f [*e,*e,*e,*e,*e,*e,*e,*e,*e,*e]\n"
    "g: &g [*f,*f,*f,*f,*f,*f,*f,*f,*f,*f]\nh: &h [*g,*g,*g,*g,*g,*g,*g,*g,*g,*g]\ni: &i [*h,*h,*h,*h,*h,*h,*h,*h,*h,*h]",
    "x: &x {a: 1}\ny: {<<: *x, <<: *x}", "x: &x {a: 1}\ny: {<<: [*x, *x], a: 2}", "1: 2", "1.5: 2", "true: 2", "null: 2", "[a]: 2",
    "{a: b}: 2", "'': 2", "2001-01-01: 2",
)  # fmt: skip


def mutate_text(random: Any, text: str) -> bytes:
    """The text with one to three places corrupted, as bytes that may not be UTF-8."""
    for _ in range(random.choice([1, 1, 1, 2, 3])):
        text = random.choice(TEXT_CHANGES)(random, text)
    raw = text.encode("utf-8", "surrogatepass")
    if random.randint(0, 19) == 0:
        k = random.randint(0, len(raw))
        spoilt = random.choice([b"\xff", b"\xfe\xff", b"\xc3", b"\xed\xa0\x80", b"\x00", b"\xef\xbb\xbf"])
        raw = random.choice(
            [
                raw[:k] + spoilt + raw[k:],
                raw[:k],
                text.encode("utf-16", "replace"),
                text.encode("latin-1", "replace"),
            ]
        )
    return raw


def _insert(random: Any, text: str) -> str:
    k = random.randint(0, len(text))
    return text[:k] + random.choice(PIECES) + text[k:]


def _insert_line(random: Any, text: str) -> str:
    lines = text.split("\n")
    k = random.randint(0, len(lines))
    indent = " " * random.choice([0, 0, 1, 2, 4, 5])
    return "\n".join([*lines[:k], indent + random.choice(PIECES), *lines[k:]])


def _insert_value(random: Any, text: str) -> str:
    """Replace the value after one of the colons."""
    ends = [match.end() for match in re.finditer(r": ", text)]
    if not ends:
        return _insert(random, text)
    k = random.choice(ends)
    length = random.choice([0, len(re.split(r"[,}\]\n]", text[k:], maxsplit=1)[0])])
    return text[:k] + random.choice(PIECES) + (" " if not length else "") + text[k + length :]


def _delete(random: Any, text: str) -> str:
    k = random.randint(0, len(text))
    return text[:k] + text[k + random.choice([1, 1, 2, 5, 50]) :]


def _letter(random: Any, text: str) -> str:
    k = random.randint(0, len(text))
    return text[:k] + random.choice(list("{}[]:,-#&*!|>'\"%@`\t \n\\0aeE.")) + text[k + 1 :]


def _line_moved(random: Any, text: str) -> str:
    lines = text.split("\n")
    line = lines[random.randint(0, len(lines) - 1)]
    k = random.randint(0, len(lines))
    return "\n".join([*lines[:k], random.choice(["", " ", "  ", "- ", "\t"]) + line, *lines[k:]])


def _doubled(random: Any, text: str) -> str:
    a, b = sorted((random.randint(0, len(text)), random.randint(0, len(text))))
    return text[:b] + text[a:b] * random.choice([1, 1, 20]) + text[b:]


TEXT_CHANGES = (
    _insert,
    _insert_line,
    _insert_value,
    _insert_value,
    _delete,
    _letter,
    _letter,
    _line_moved,
    _doubled,
)


# ---------------------------------------------------------------------- surveys
CELLS = (
    "",
    " ",
    "nan",
    "inf",
    "-1",
    "1e400",
    "1e300",
    "1e-300",
    "abc",
    "1,5",
    "1_0",
    "９",
    "0x10",
    "1 m",
    "'0'",
    '"',
    "=1+1",
    "\x00",
    "9" * 5000,
    "-0.0",
    "360",
    "181",
    "1e5",
)


def mutate_survey(random: Any, text: str) -> bytes:
    """A survey in CSV, with or without errors."""
    rows = [row.split(",") for row in text.split("\n")]
    what = random.randint(0, 9)
    k = random.randint(0, len(rows) - 1)
    if what < 4:
        rows[k][random.randint(0, len(rows[k]) - 1)] = random.choice(CELLS)
    elif what == 4:
        rows[0] = random.choice([["MD", "Incl", "Az"], ["md [kg]", "inclination", "azimuth"], ["md [", "inclination", "azimuth"],
        ["md (ft)", "inclination [rad]", "azimuth"],
                                 ["md", "md", "inclination", "azimuth"], ["md [9**9**9]", "inclination", "azimuth"], [""]])  # fmt: skip
    elif what == 5:
        rows.insert(k, random.choice([["# note"], ["\t"], ["x" * 200000], rows[k], ['"' + "x" * 200000], []]))
    elif what == 6:
        del rows[k]
    elif what == 7:
        rows[k] = rows[k][:-1]
    mark = random.choice([",", ",", ",", ";", "\t", "|", " "])
    raw = (
        random.choice(["\n", "\n", "\r\n", "\r"])
        .join(mark.join(row) for row in rows)
        .encode("utf-8", "surrogatepass")
    )
    return random.choice(
        [raw, raw, raw, raw, b"\xef\xbb\xbf" + raw, raw.decode().encode("utf-16"), raw + b"\xff", b""]
    )
