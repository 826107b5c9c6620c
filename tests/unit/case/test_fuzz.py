"""Any content of a case file is read as a case that holds it, or refused with a CaseError that helps.

The cases and mutations are those of scripts/fuzz, which tries very many more.
"""

from __future__ import annotations

import contextlib
import io
import math
import random
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from drillpetsc.case import Case, case_from_data, load_case
from drillpetsc.case.checks.limits import MAX_ELEMENTS
from drillpetsc.case.quantities import OverTime, Quantity, dump_time_function
from drillpetsc.case.writer import case_data
from drillpetsc.cli import main
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.time_function import PiecewiseLinear, Ramp
from drillpetsc.units import DIMENSIONS

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts" / "tools"))
import fuzz  # noqa: E402
from fuzz_cases import valid_case  # noqa: E402
from fuzz_judge import Failure, check_message, check_round_trip, check_visible, guarded  # noqa: E402
from fuzz_mutations import mutate_data, mutate_survey, mutate_text, places, replaced, value_at  # noqa: E402

# the same examples each time: a test suite is no place for surprises; scripts/fuzz --seed looks elsewhere
quick = settings(
    max_examples=150, derandomize=True, database=None, deadline=None, suppress_health_check=list(HealthCheck)
)
slow = settings(quick, max_examples=40)
choices = st.integers(0, 10**9).map(random.Random)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


def read(data: dict[str, Any], file: Path) -> Case | None:
    """The case; None where it was refused with a message that helps."""
    try:
        return guarded(lambda: case_from_data(data, file, {}))
    except CaseError as error:
        check_message(error, (file, file.parent / "survey.csv"), None)
        return None


# ---------------------------------------------------------------------- whole cases
@slow
@given(choices)
def test_a_case_within_the_contract_is_accepted_and_comes_back_from_its_yaml(folder: Path, r: Any) -> None:
    data = valid_case(r)
    case = case_from_data(data, folder / "case.yaml", {})
    held = case_data(case)
    for path in places(data):
        check_visible(case, path, value_at(data, path), held)

    def load(text: str) -> Case:
        (folder / "again.yaml").write_text(text, encoding="utf-8")
        return load_case(folder / "again.yaml")

    check_round_trip(case, load)


@settings(quick, max_examples=600)
@given(choices)
def test_mutated_data_is_a_case_that_holds_it_or_refused(folder: Path, r: Any) -> None:
    data, path = mutate_data(r, valid_case(r))
    case = read(data, folder / "case.yaml")
    if case is not None:
        check_visible(case, path, value_at(data, path))
        assert Case(**case_data(case)) == case


@settings(quick, max_examples=100)
@given(choices, st.deferred(lambda: st.sampled_from(fuzz.seeds())))
def test_a_mutated_text_is_a_case_or_refused(folder: Path, r: Any, seed: fuzz.Seed) -> None:
    file = folder / "text.yaml"
    raw = mutate_text(r, seed.text)
    file.write_bytes(raw)
    try:
        guarded(lambda: load_case(file))
    except CaseError as error:
        check_message(
            error,
            (file,),
            raw.count(b"\n") + raw.count(b"\r") + raw.decode("utf-8", "replace").count("\x85") + 2,
        )


CASE = Case(**valid_case(random.Random(8)))  # with pipe, beam, body, bit, fluid and formation
VALID = case_data(CASE)
BLOCKS = {(): CASE, ("fluid",): CASE.fluid, ("formation",): CASE.formation}
BLOCKS |= {("string", i): item for i, item in enumerate(CASE.string)}
#: places of all keys, of those that the case does not give as well
PLACES = [*places(VALID)] + [
    (*path, field.alias or name)
    for path, block in BLOCKS.items()
    for name, field in type(block).model_fields.items()
    if (field.alias or name) not in value_at(VALID, path)
]
anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=12)
    | st.from_regex(r"-?[0-9.]{1,4} ?(m|deg|rpm|kN|Pa|s|kg)", fullmatch=True),
    lambda inside: st.lists(inside, max_size=4) | st.dictionaries(st.sampled_from(["kind", "time", "value", "ramp",
    "a"]) | st.text(max_size=4), inside, max_size=3),
    max_leaves=6,
)  # fmt: skip


@settings(quick, max_examples=800)
@given(st.sampled_from(PLACES), anything)
def test_anything_anywhere_is_held_or_refused(folder: Path, path: tuple[str | int, ...], value: Any) -> None:
    """Here hypothesis makes the value, so that it shrinks what it finds."""
    assume(value is not None)  # which no YAML value is outside the petsc block: see the texts below
    case = read(replaced(VALID, path, value), folder / "case.yaml")
    if case is not None:
        check_visible(case, path, value)


@quick
@given(choices)
def test_a_mutated_survey_is_a_hole_or_refused(folder: Path, r: Any) -> None:
    raw = mutate_survey(r, "md,inclination,azimuth\n0,0,0\n10,3,20\n20.5,6,30\n30,9,40")
    (folder / "survey.csv").write_bytes(raw)
    hole = [{"to": 30, "kind": "open_hole", "diameter": 0.3}]
    pipe = {"kind": "pipe", "length": 9, "od": 0.1}
    read(
        {"string": [pipe], "top": "pinned", "well": {"survey": "survey.csv", "sections": hole}},
        folder / "case.yaml",
    )


@slow
@given(choices)
def test_a_validated_case_is_built_or_refused(folder: Path, r: Any) -> None:
    case = read(mutate_data(r, valid_case(r))[0], folder / "case.yaml")
    assume(case is not None)
    assert case is not None
    with contextlib.suppress(CaseError):
        guarded(lambda: build_model(case), 20.0)


@slow
@given(choices)
def test_the_command_ends_with_0_or_2(folder: Path, r: Any) -> None:
    file = folder / "command.yaml"
    file.write_bytes(mutate_text(r, fuzz.written(valid_case(r))))
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        status = guarded(lambda: main(["check", str(file)]), 20.0)
    assert (status, bool(out.getvalue()), bool(err.getvalue())) in ((0, True, False), (2, False, True))


def test_the_script_counts_its_mutants(tmp_path: Path) -> None:
    said: list[str] = []
    tally = fuzz.run(60, 7, 0.0, 0, tmp_path / "failures", said.append)
    assert sum(tally.outcomes.values()) == 60
    assert tally.failures == {} and said == [] and not (tmp_path / "failures").exists()
    reported = "\n".join(fuzz.table(tally))
    assert "FAILED" in reported.splitlines()[0] and "data" in reported


def test_the_script_shows_the_smallest_case_that_fails(tmp_path: Path) -> None:
    """A fault put in by hand: friction above 0.4 is a traceback; all that is left of the case is what a pipe
    in a hole needs."""
    m = fuzz.Mutant("data", tmp_path / "case.yaml", valid_case(random.Random(3)))

    def verdict(less: fuzz.Mutant, number: int, tally: object = None, every_stage: bool = False) -> str:
        try:
            case = case_from_data(less.data or {}, less.file, {})
        except CaseError:
            return "refused"
        return "ValueError in checks.py" if case.string_length > 10 else "valid"

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fuzz, "verdict", verdict)
        least = fuzz.smallest(m, 0, "ValueError in checks.py")
    assert least.data is not None and set(least.data) == {"string", "top"} and len(least.data["string"]) == 1


# ---------------------------------------------------------------------- texts that once went wrong, or would
# have
BOMB = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 12)
)
START = "top: clamped\nstring:\n- {kind: pipe, od: 0.1, length: 9}\n"


@pytest.mark.parametrize(
    ("text", "line", "fragment"),
    [
        (BOMB, 6, "300000 values"),  # 10^12 values
        (START + "x: " + "[" * 3000, 4, "at most 40 levels"),
        (START + "x: " + "{a: " * 3000, 4, "at most 40 levels"),
        ("- " * 3000, 1, "at most 40 levels"),
        (START + "? " * 60 + "a", 4, "word as key"),  # 5^60 steps in the YAML reader
        (START + "{" * 30 + "a: 1" + "}: 1" * 30, 4, "word as key"),
        (START + "x: &x {a: *x}", 4, "a value"),
        (START + "x: &x [*x]", 4, "a value"),
        ("%YAML 1.1\n---\n" + START + "hold_string: yes", 1, "YAML 1.2"),
        (START + "title: !!python/object/apply:os.system [ls]", 4, "no YAML tag"),
        (START + "title: !custom {a: 1}", 4, "no YAML tag"),
        (START + 'title: "\\ud800"', 4, "Unicode"),
        (START + "gravity: 1" + "0" * 400, 4, "308 digits"),
        (START + "petsc: {x: 0x" + "F" * 5000 + "}", 4, "308 digits"),
        # would be computed, for years
        (START + "gravity: 9.8 m^9**9**9/s^2", 4, "one number, then its unit"),
        (START + "gravity: 9.8 m/s^2" + "*m/m" * 30, 4, "at most 100 letters"),
        (START + "time: {end: 12:30:45}", 4, "a time"),  # 45045 s in YAML 1.1
        (START + "hold_string: yes", 4, "true or false"),
        (START + "time: {end: 2001-01-01}", 4, "number, text"),
        (START + "gravity: .nan", 4, "finite"),
        (START + "petsc: {x: .nan}", 4, "a number, a word"),
        (START + "top: free", 4, "each key once"),
        (START + "well: {survey: " + "f" * 300 + "}", 4, "survey file that exists"),
        (START + "well: {survey: .}", 4, "survey file"),
        (START + "initial: {from: " + "f" * 300 + "}", 4, "run folder"),
        (START + "'a[b': 1", 4, "one of these keys"),
        (START + "? [a]\n: 1", 4, "word as key"),
        (START + "'': 1", 4, "one of these keys"),
        (START + "\x1b[31m: 1", 4, "YAML 1.2"),
        (START.replace("9}", "9, element_length: 1e-8}"), 3, "elements"),  # 9e8
        (START.replace("9}", "1e-9}"), 3, "length"),
        (START + "time: {end: 1e9}\noutput: {history_every: 1e-3}", 5, "at least 100 s"),
        (START + "time: {end: 1e9}\noutput: {history_every: 1e4, field_every: 1e4, checkpoint_every: 1e-3}", 5, "at least 1000 s"),
        (START + "time: {end: 1e9}", 4, "at most 1e+06 s"),
        (START + "loads: [{at: 1, force: [1, 0, 0], value_over: {ramp: 1 s, value: 1e300}}]", 4, "1e+30, or 0"),
        (START + "loads: [{at: 1, force: [1, 0, 0], value_over: {time: [0, 1e-300], value: [0, 1]}}]", 4, "1e+30 s, or 0"),
    ],
)  # fmt: skip
def test_told_within_a_second_and_with_its_line(tmp_path: Path, text: str, line: int, fragment: str) -> None:
    file = tmp_path / "case.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(CaseError) as caught:
        guarded(lambda: load_case(file), 4.0)
    check_message(caught.value, (file,), None)
    assert fragment in str(caught.value) and caught.value.line == line


def test_an_anchor_on_true_is_true(tmp_path: Path) -> None:
    (tmp_path / "case.yaml").write_text(
        START + "bottom: {kind: free, plugged: &yes true}\npetsc: {x: *yes}", encoding="utf-8"
    )
    case = load_case(tmp_path / "case.yaml")
    assert case.bottom.plugged is True and case.petsc == {"x": True}


def test_merge_keys_and_the_numbers_of_yaml_12(tmp_path: Path) -> None:
    """017 is 17 in YAML 1.2 (section 10.3.2), 0o17 is 15."""
    text = "top: clamped\nstring:\n- &p {kind: pipe, od: 0.1, length: 017}\n- {<<: *p, length: 0o17}\n"
    (tmp_path / "case.yaml").write_text(text, encoding="utf-8")
    case = load_case(tmp_path / "case.yaml")
    assert [item.length for item in case.string] == [17.0, 15.0] and case.string[1].od == 0.1


def test_a_file_that_never_ends() -> None:
    with pytest.raises(CaseError, match="at most 50 MB"):
        load_case(Path("/dev/zero"))


def test_as_many_elements_as_are_allowed_are_accepted() -> None:
    pipe = {"kind": "pipe", "od": 0.1, "length": 20, "element_length": 20 / MAX_ELEMENTS}
    Case(top="clamped", string=[pipe])
    with pytest.raises(CaseError) as caught:
        Case(top="clamped", string=[pipe, {**pipe, "length": 0.01}])
    assert caught.value.at == "string[0].element_length" and "200000 elements" in caught.value.want


@pytest.mark.parametrize("depth", [0.0, 12e3])
def test_a_short_item_deep_down_keeps_its_element(depth: float) -> None:
    """5 mm at 12 km is more than rounding: an item has at least one element wherever it hangs."""
    from drillpetsc.model.mesh import build_mesh

    long = [{"kind": "pipe", "od": 0.1, "length": depth, "element_length": 1e3}] if depth else []
    short = {"kind": "pipe", "od": 0.2, "length": 0.005, "element_length": 0.005}
    mesh = build_mesh(Case(top="clamped", string=[*long, short, {**short, "length": 9.0}]))
    assert mesh.outer_diameter[-2 if not long else -1] == 0.2
    assert mesh.lower[-1] == pytest.approx(depth + 9.005, rel=1e-12)
    assert (
        (mesh.lower > mesh.upper).all()
        and mesh.item.max() == 1 + bool(long)
        and set(mesh.item) == set(range(2 + bool(long)))
    )


# ---------------------------------------------------------------------- values
numbers = st.floats(-1e12, 1e12).filter(lambda x: x == 0 or abs(x) > 1e-12)


@given(numbers, st.sampled_from([unit for unit in DIMENSIONS if unit]))
def test_a_quantity_as_read_reads_as_itself(number: float, unit: str) -> None:
    once = Quantity(unit).read(f"{number!r} {unit}")
    assert once == pytest.approx(number, rel=5e-16, abs=0)  # 12 digits where they are as near
    assert Quantity(unit).read(once) == Quantity(unit).read(f"{once!r} {unit}") == once


@given(numbers, st.sampled_from([("m", "ft", 0.3048), ("m", "in", 0.0254), ("rad", "deg", math.pi / 180), ("rad/s", "rpm", math.pi / 30),
                                 ("N", "lbf", 4.4482216152605), ("Pa", "psi", 4.4482216152605 / 0.0254**2), ("kg", "lb", 0.45359237),
                                 ("m^3/s", "gal/min", 231 * 0.0254**3 / 60),
                                 ("kg/m^3", "lb/gal", 0.45359237 / (231 * 0.0254**3))]))  # fmt: skip
def test_units_of_the_field(number: float, unit: tuple[str, str, float]) -> None:
    """Definitions of foot, inch, pound and gallon (NIST Special Publication 811, appendix B)."""
    si, text, factor = unit
    assert Quantity(si).read(f"{number!r} {text}") == pytest.approx(number * factor, rel=1e-12)


@st.composite
def inputs_over_time(draw: st.DrawFn) -> Any:
    """A value over time as an author may write it: constant, ramp, or a table that may jump."""
    form = draw(st.integers(0, 2))
    if form == 0:
        return draw(numbers)
    if form == 1:
        return {"ramp": draw(st.floats(1e-6, 1e6)), "value": draw(numbers)}
    steps = draw(st.lists(st.floats(1e-6, 1e5), max_size=5))
    times = [draw(st.floats(-1e3, 1e3).map(lambda t: round(t, 9)))]
    for step in steps:
        times += [times[-1] + step] * draw(st.integers(1, 2))
    assume(all(c > a for a, c in zip(times, times[2:], strict=False)))
    return {"time": times, "value": [draw(numbers) for _ in times]}


@given(inputs_over_time())
def test_an_input_over_time_is_written_as_it_is_read(given_: Any) -> None:
    function = OverTime("N").read(given_)
    assert OverTime("N").read(dump_time_function(function)) == function


@given(inputs_over_time(), st.floats(-1e4, 1e6), st.floats(0.0, 1e4))
def test_value_rate_and_integral_agree(given_: Any, t: float, later: float) -> None:
    """Between breaks a constant or straight line is exact by the middle; a ramp lies within its value and its
    largest rate."""
    function = OverTime("N").read(given_)
    breaks = function.breaks()
    ends = [t, *(b for b in breaks if t < b < t + later), t + later]
    size = max(
        map(
            abs, getattr(function, "values", [getattr(function, "final", getattr(function, "constant", 0.0))])
        )
    )
    area = 0.0
    for a, b in zip(ends, ends[1:], strict=False):
        first, last, middle = function.value(a), function.value(b, before=True), function.value((a + b) / 2)
        rounding = 1e-9 * size
        if isinstance(function, Ramp):
            assert (
                abs(last - first)
                <= abs(function.final) * math.pi / 2 * (b - a) / function.duration * (1 + 1e-9) + rounding
            )
            assert min(first, last) - rounding <= middle <= max(first, last) + rounding
            area = math.nan
            continue
        slope = function.rate((a + b) / 2)
        near = rounding + 1e-9 * abs(slope) * max(abs(a), abs(b), 1.0)
        assert last - first == pytest.approx(slope * (b - a), abs=near)
        assert middle == pytest.approx((first + last) / 2, abs=near)
        area += (first + last) / 2 * (b - a)
    whole = function.integral(t + later) - function.integral(t)
    if isinstance(function, Ramp):
        assert abs(whole) <= abs(function.final) * later * (1 + 1e-9) + 1e-9 * size * 1e6
    else:
        assert whole == pytest.approx(area, abs=1e-9 * size * (abs(t) + later + 1e6))


@given(inputs_over_time())
def test_a_value_jumps_at_its_jumps_alone(given_: Any) -> None:
    function = OverTime("N").read(given_)
    times = (
        function.times if isinstance(function, PiecewiseLinear) else (0.0, getattr(function, "duration", 1.0))
    )
    for t in times:
        assert (function.value(t) != function.value(t, before=True)) == (t in function.jumps())


def test_a_change_too_small_to_see_is_still_a_change(tmp_path: Path) -> None:
    """The judge of this file itself: a value dropped or replaced is found."""
    pipe = {"kind": "pipe", "length": 9.0, "od": 0.1}
    case = Case(top="clamped", string=[pipe])
    check_visible(case, ("string", 0, "length"), "900 cm")
    with pytest.raises(Failure, match="changed"):
        check_visible(case, ("string", 0, "length"), "900.000001 cm")
    with pytest.raises(Failure, match="not in the case"):
        check_visible(case, ("string", 0, "colour"), "red")
    assert replaced({"a": [1, {"b": 2}]}, ("a", 1, "b"), 3) == {"a": [1, {"b": 3}]}
