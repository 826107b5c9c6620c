"""Table of the cases of the robustness suite: the runs of each case and its criteria."""

from __future__ import annotations

from dataclasses import dataclass

from tests.robustness.contact import (
    fixed_steps,
    friction,
    in_the_wall,
    stiff_contact,
    tight_clearance,
    unbalance,
    washout,
)
from tests.robustness.criteria import Check
from tests.robustness.drilling import off_bottom, reverse, rock_extremes, stick_slip
from tests.robustness.mud import (
    deep_mud,
    hour,
    pump_trip,
    soft_mud,
    stiff_mud,
    surge,
    thick_and_thin,
    tiny_elements,
)
from tests.robustness.run import Part
from tests.robustness.string import (
    deep_well,
    dogleg,
    dropped_bit,
    few_elements,
    helix,
    inextensible,
    lock_up,
    pull_free,
    tripping,
)


@dataclass(frozen=True)
class RobustnessCase:
    """A case of the robustness suite: its parts, and the criteria, which get the runs by the names of the
    parts."""

    number: str
    title: str
    parts: tuple[Part, ...]
    check: Check


def _runs(*names: str) -> tuple[Part, ...]:
    return tuple(Part(name, name) for name in names)


LOADS = (4e3, 8e3, 12e3, 17e3, 25e3, 42e3, 60e3, 85e3)  # weights on bit of X22 [N]

CASES: tuple[RobustnessCase, ...] = (
    RobustnessCase(
        "X01",
        "12 km S-well",
        (Part("x01-statics", "x01-deep-well", "statics"), *_runs("x01-deep-well")),
        deep_well,
    ),
    RobustnessCase("X02", "contact of 1e10 N/m2", _runs("x02-stiff-contact"), stiff_contact),
    RobustnessCase("X03", "dropped bit, 200 t", _runs("x03-dropped-bit"), dropped_bit),
    RobustnessCase("X04", "stick-slip at 5 rpm", _runs("x04-stick-slip"), stick_slip),
    RobustnessCase(
        "X05", "mass offset of 50 mm at 300 rpm", _runs("x05-unbalance-1e8", "x05-unbalance-1e10"), unbalance
    ),
    RobustnessCase(
        "X06",
        "clearance 1 mm to 0",
        _runs("x06-clearance-1mm", "x06-clearance-100um", "x06-clearance-zero", "x06-casing-in-hole"),
        tight_clearance,
    ),
    RobustnessCase(
        "X07", "thin and thick mud", _runs("x07-mud-default", "x07-mud-thin", "x07-mud-thick"), thick_and_thin
    ),
    RobustnessCase("X08", "pump trip", _runs("x08-pump-trip", "x08-pump-trip-viscous"), pump_trip),
    RobustnessCase(
        "X09",
        "tripping at 2 m/s",
        (
            Part("x09-hoist", "x09-trip-fast", "statics", "hoist"),
            Part("x09-rotate", "x09-trip-fast", "statics", "rotate"),
            *_runs("x09-trip-fast"),
        ),
        tripping,
    ),
    RobustnessCase(
        "X10",
        "dogleg of 30 deg in 30 m",
        (
            Part("x10-statics", "x10-dogleg", "statics"),
            Part("x10-fine-statics", "x10-dogleg-fine", "statics"),
            *_runs("x10-dogleg"),
        ),
        dogleg,
    ),
    RobustnessCase("X11", "lock-up of coiled tubing", _runs("x11-lock-up"), lock_up),
    RobustnessCase("X12", "pull-free snap", _runs("x12-pull-free"), pull_free),
    RobustnessCase(
        "X13", "nearly inextensible tubing", _runs("x13-coiled-tubing", "x13-inextensible"), inextensible
    ),
    RobustnessCase(
        "X14",
        "one and two elements",
        _runs("x14-one-element-10m", "x14-one-element-1000m", "x14-two-elements-bend"),
        few_elements,
    ),
    RobustnessCase(
        "X15",
        "fixed long steps",
        _runs("x15-bdf1-50ms", "x15-bdf1-500ms", "x15-bdf2-50ms", "x15-bdf2-500ms"),
        fixed_steps,
    ),
    RobustnessCase(
        "X16",
        "start inside the wall",
        (Part("x16-pressed", "x16-start-in-the-wall", "wall"), *_runs("x16-start-in-the-wall")),
        in_the_wall,
    ),
    RobustnessCase("X17", "off bottom and back", _runs("x17-off-bottom"), off_bottom),
    RobustnessCase("X18", "reverse and no rotation", _runs("x18-reverse", "x18-zero-rotation"), reverse),
    RobustnessCase(
        "X19",
        "friction 0, 1 and a jump",
        _runs("x19-friction-zero", "x19-friction-one", "x19-friction-jump"),
        friction,
    ),
    RobustnessCase("X20", "washout", _runs("x20-washout"), washout),
    RobustnessCase(
        "X21", "drillability 1e-5 and 1e-12", _runs("x21-soft-rock", "x21-undrillable"), rock_extremes
    ),
    RobustnessCase(
        "X22",
        "buckling to ten critical loads",
        (
            *_runs("x22-helix"),
            *(Part(f"x22-wob-{w / 1e3:02.0f}kN", "x22-helix", "statics", None, w) for w in LOADS),
        ),
        helix,
    ),
    RobustnessCase("Y01", "12 km S-well with mud", _runs("y01-deep-well-mud"), deep_mud),
    RobustnessCase("Y02", "surge near the speed of sound", _runs("y02-surge-near-sonic"), surge),
    RobustnessCase("Y03", "bulk modulus 1e12 Pa", _runs("y03-incompressible-mud"), stiff_mud),
    RobustnessCase("Y04", "bulk modulus 1e7 Pa", _runs("y04-gas-like-mud"), soft_mud),
    RobustnessCase("Y05", "3000 elements on 30 m", _runs("y05-3000-elements-on-30m"), tiny_elements),
    RobustnessCase("Y06", "an hour at 120 rpm", _runs("y06-hour"), hour),
)


def chosen(numbers: list[str]) -> list[RobustnessCase]:
    """Cases of these numbers, or all for an empty list; ValueError for an unknown number."""
    known = {case.number: case for case in CASES}
    wanted = [n.upper() for n in numbers] or list(known)
    if missing := [n for n in wanted if n not in known]:
        raise ValueError(f"no robustness case {', '.join(missing)}; there are {', '.join(known)}")
    return [known[n] for n in wanted]
