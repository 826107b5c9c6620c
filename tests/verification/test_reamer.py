"""A reamer above a drag bit: shares of weight and torque, depth of cut, and the hole that both make (manual: verif-reamer)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.physics.tools.reamer import Reamer
from tests.helpers.component_models import SHIFT, residual
from tests.helpers.motion import beam
from tests.helpers.tables import each_row

LENGTH, PILOT_LENGTH = 60.0, 6.3


def reaming(
    bit: float,
    reamer: float,
    energy: float,
    ratio: float,
    rpm: float,
    lowering: float,
    wob: float,
    mode: str,
    **more,
) -> dict:
    """A case of pipe, reamer, pipe and sharp drag bit in a vertical hole, without weight of its own."""
    damping = {"stiffness": 1e-3}
    cutting = {"specific_energy": energy, "inclination_ratio": ratio, "blades": 4}
    return {
        "string": [
            beam(
                LENGTH - PILOT_LENGTH - 1.0,
                6,
                4e9,
                1e9,
                1e8,
                160.0,
                0.75,
                od=0.1778,
                id=0.07,
                damping=damping,
            ),
            {"kind": "reamer", "length": 1.0, "od": reamer, "id": 0.07, "mass": 200, **cutting},
            beam(PILOT_LENGTH - 0.3, 2, 4e9, 1e9, 1e8, 160.0, 0.75, od=0.1715, id=0.07, damping=damping),
            {"kind": "bit", "length": 0.3, "od": bit, "mass": 60},
        ],
        "well": {
            "survey": {"md": [0, LENGTH], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [
                {"to": LENGTH - PILOT_LENGTH, "kind": "open_hole", "diameter": reamer, "friction": 0.0},
                {"to": LENGTH, "kind": "open_hole", "diameter": bit, "friction": 0.0},
            ],
        },
        "contact": None,
        "top": {"kind": "top_drive", "rotation": rpm * np.pi / 30, "lowering": lowering},
        "bottom": {"kind": "bit", "stiffness": 1e8},
        "formation": {"bit_law": {"kind": "drag_bit", "wear_flat": 0, **cutting}},
        "gravity": 0.0,
        "initial": {"from": "statics", "wob": wob},
        "time": {"end": 3.0, "mode": mode},
        "output": {"history_every": 0.1},
        **more,
    }


def expected(bit, reamer, energy, ratio, depth):
    """Weights [N] and torques [N m] of bit and reamer at a depth of cut per turn [m] (manual: eq-reamer-law)."""
    a, b = 0.5 * bit, 0.5 * reamer
    return (
        ratio * energy * a * depth,
        ratio * energy * (b - a) * depth,
        0.5 * energy * a**2 * depth,
        0.5 * energy * (b**2 - a**2) * depth,
    )


def test_the_law_is_that_of_the_list():
    """60 kN on both: 24.997 mm per turn, bit share 0.80952, 4369.4 and 2298.1 N m, 179.98 m/h at 120 rpm (C19)."""
    depth = 60e3 / (0.6 * 30e6 * 0.5 * 0.2667)
    bit, ring, torque, ring_torque = expected(0.2159, 0.2667, 30e6, 0.6, depth)
    assert (bit + ring, bit / 60e3) == pytest.approx((60e3, 0.80952), rel=1e-4)
    assert (depth, torque, ring_torque) == pytest.approx((24.997e-3, 4369.4, 2298.1), rel=1e-4)
    assert depth * 2 * 3600 == pytest.approx(179.98, rel=1e-4)


CASES = [(0.2159, 0.2667, 30e6, 0.6, 120.0, 60e3), (0.3112, 0.4064, 50e6, 0.75, 80.0, 45e3)]


@pytest.mark.parametrize("mode", ["dynamic", "quasi_static"])
@pytest.mark.parametrize(("bit", "reamer", "energy", "ratio", "rpm", "both"), CASES)
def test_shares_of_bit_and_reamer_in_steady_cutting(bit, reamer, energy, ratio, rpm, both, mode, tmp_path):
    """Weights and torques within 1e-3, at the rate of penetration that the top gives; the same metres of both."""
    depth = both / (ratio * energy * 0.5 * reamer)
    rate = depth * rpm / 60
    weights = expected(bit, reamer, energy, ratio, depth)
    case = reaming(bit, reamer, energy, ratio, rpm, rate, weights[0], mode, petsc={"ts_rtol": 1e-5})
    history = read_table(run(Case(**case), tmp_path / "run", progress="silent").folder / "history.csv")
    late = history["time [s]"] > 2.0
    names = ("wob [N]", "wob_reamer [N]", "bit_torque [N m]", "torque_reamer [N m]")
    found = [history[name][late].mean() for name in names]
    assert found == pytest.approx(weights, rel=1e-3)
    drilled, reamed = (history[f"hole_depth{q} [m]"][-1] for q in ("", "_reamer"))
    assert drilled - LENGTH == pytest.approx(3.0 * rate, rel=5e-3)
    assert reamed - (LENGTH - PILOT_LENGTH) == pytest.approx(drilled - LENGTH, rel=5e-3)
    assert -history["hook_load [N]"][late].mean() == pytest.approx(both, rel=1e-3)
    if mode == "dynamic":
        work = both * 3.0 * rate + (weights[2] + weights[3]) * rpm * np.pi / 30 * 3.0
        assert np.abs(history["energy_error [J]"]).max() < 0.01 * work


def test_the_static_shares_are_those_of_cutting():
    bit, reamer, energy, ratio, rpm, both = CASES[0]
    model = build_model(Case(**reaming(bit, reamer, energy, ratio, rpm, 0.0, 48e3, "dynamic")))
    find_equilibrium(model)
    weight = model.parts(Reamer)[0].element_results(model.system.assembly)[0]
    assert model.bit.weight_and_torque(model.system.assembly)[0] == pytest.approx(48e3, rel=1e-6)
    deeper = 48e3 / 1e8 + 48e3 * (PILOT_LENGTH - 0.3) / 4e9  # bit into the rock, and pipe compressed between
    assert weight == pytest.approx(1e8 * (reamer - bit) / bit * deeper, rel=1e-3)


@pytest.mark.parametrize("mode", ["motion", "statics", "drilling"])
def test_jacobian_of_the_reamer(mode):
    """Exact against differences of fourth order, in contact, leaning and turning."""
    case = reaming(0.4, 0.6, 2e3, 0.6, 30, 0.0, 100.0, "quasi_static" if mode == "drilling" else "dynamic")
    case["bottom"]["stiffness"] = 1e4
    for item in (case["string"][0], case["string"][2]):
        item |= {"axial_stiffness": 1e3, "bending_stiffness": 1e3, "torsional_stiffness": 1e3}
    model = build_model(Case(**case))
    system, reamer, rng = model.system, model.parts(Reamer)[0], np.random.default_rng(5)
    asm, n = system.assembly, system.layout.size
    system.set_field(
        "string.position", model.position + 0.02 * rng.standard_normal((model.mesh.nodes, 3)) + [0, 0, 0.1]
    )
    system.set_field("string.tangent", model.tangent + 0.05 * rng.standard_normal((model.mesh.nodes, 3)))
    asm.v0[:] = 0.1 * rng.standard_normal(len(asm.v0))
    spin = system.layout.dofs["string.spin"][6]
    if mode != "motion":
        (reamer.impose_sliding_direction if mode == "statics" else reamer.impose_drilling)(0.1, 3.0)
    x0, here = asm.x[:-1].copy(), asm.layout.index(reamer._block)[0]
    if mode == "motion":  # at slip over radius cutters have about 1/sqrt(2) of their torque, backwards none
        rounding = reamer.law.slip / reamer.law.radius
        for speed in (rounding, -rounding):
            asm.v0[spin] = speed
            residual(system, x0, 0.0)
            omega = max(asm.y[spin].item(), 0.0)
            weight, torque = reamer.element_results(asm)[:2]
            whole = weight * reamer.law.torque_cut / reamer.law.cut
            assert torque == pytest.approx(whole * omega / np.hypot(omega, rounding), rel=1e-9)
    asm.v0[spin] = 3.0
    residual(system, x0, 0.0)
    weight, *_, stored, heat = reamer.element_results(asm)
    assert weight > 0
    assert stored == pytest.approx(0.0 if mode == "motion" else 0.5 * weight**2 / reamer.stiffness, rel=1e-9)
    bound = next(b for b in asm.bound_blocks if b.block.name == "reamer")
    if mode == "motion":  # what the leaning string gives, by its slope too, goes into the rock
        assert asm.block_rows(bound, 0.0)[0, :7] @ asm.y[here[:7]] == pytest.approx(heat, rel=1e-9)

    def rows(x):
        asm.x[:n] = x
        asm.condense(SHIFT)
        return asm.block_rows(bound, 0.0)[0].copy()

    asm.jacobian(0.0, (1.0, SHIFT, SHIFT**2), condensed=True)
    K = asm.values[bound.span].reshape(bound.width, bound.width)
    for j, dof in enumerate(here):
        e = np.zeros(n)
        e[dof] = 1e-5
        r = [rows(x0 + k * e) for k in (-2, -1, 1, 2)]
        slope = (r[0] - 8 * r[1] + 8 * r[2] - r[3]) / (12 * 1e-5)
        assert (np.abs(K[:, j] - slope) <= 2e-7 * np.maximum(np.abs(K).max(axis=1), 100.0)).all(), j
    if mode == "motion":  # places along the hole are measured from any point of its axis
        cut = []
        for shift in (0.0, 0.3):
            reamer.params["point"] = reamer.params["point"] + shift * reamer.params["axis"]
            reamer.params["place"] = reamer.params["place"] + shift
            reamer.first_cut(asm)
            cut.append(asm.x[here[8:]].copy())
        assert np.ptp(cut[0]) > 0 and cut[1] == pytest.approx(cut[0], rel=1e-9)


def test_the_hole_has_both_diameters():
    """Reamed above the shoulder, the pilot's below; the shoulder moves down, past the bottom of the old hole, too."""
    bit, reamer, energy, ratio, rpm, _ = CASES[0]
    model = build_model(Case(**reaming(bit, reamer, energy, ratio, rpm, 0.0, 48e3, "dynamic")))
    hole, shoulder = model.bit.hole, LENGTH - PILOT_LENGTH
    start = hole.start_point
    for drilled in np.linspace(0, 9, 91):
        hole.widen_to(0, drilled)
        hole.follow(drilled, start + [0, 0, drilled])
        well = hole.well
        assert well.radius(shoulder + drilled - 0.05) == pytest.approx(0.5 * reamer, rel=1e-9)
        assert well.radius(shoulder + drilled + 0.55) == pytest.approx(0.5 * bit, rel=1e-9)
        assert well.radius(LENGTH + drilled - 0.3) == pytest.approx(0.5 * bit, rel=1e-9)
    saved = hole.get_state()
    other = build_model(Case(**reaming(bit, reamer, energy, ratio, rpm, 0.0, 48e3, "dynamic"))).bit.hole
    other.widen_to(0, 9.0)
    other.set_state(saved)
    assert other.well.section_to == pytest.approx(hole.well.section_to)


@each_row(
    ("change", "words"),
    [
        ({"od": 0.2159}, ("od", "more than")),
        ({"pilot": 0.2}, ("pilot", "0.2159")),
        ({"stiff": False, "body_od": 0.2, "blade_length": 0.4}, ("stiff",)),
        ({"length": 1.5}, ("cutters", "reamed hole")),
        ({"od": 0.3}, ("pilot hole",)),
    ],
)
def test_bad_reamers_are_refused(change, words):
    case = reaming(0.2159, 0.2667, 30e6, 0.6, 120, 0.0, 48e3, "dynamic")
    case["string"][1] |= change
    if "length" in change:
        case["string"][0]["length"] -= 0.5
        case["string"][2]["length"] -= 0.7
    if change.get("stiff") is False:
        del case["string"][1]["mass"]
    with pytest.raises(CaseError) as error:
        Case(**case)
    for word in words:
        assert word in str(error.value)


def statics_hole(sections: list[tuple[float, float]], **reamer) -> dict:
    """The case of ``reaming`` without a formation, with contact; sections: (end, diameter) [m]."""
    case = reaming(0.2159, 0.2667, 30e6, 0.6, 120, 0.0, 48e3, "dynamic", contact={})
    del case["formation"]
    case["string"][1] |= reamer
    case["well"]["sections"] = [
        {"to": to, "kind": "open_hole", "diameter": diameter, "friction": 0.0} for to, diameter in sections
    ]
    return case


@each_row(
    ("sections", "reamer", "words"),
    [
        ([(53.7, 0.2667), (60, 0.2159)], {}, ()),
        # cutters open below a narrower casing, and worn blades may be 1/16 in above the hole
        ([(40, 0.24), (53.7, 0.2667), (60, 0.2159)], {"body_od": 0.2}, ()),
        ([(53.7, 0.2667 - 1.5e-3), (60, 0.2159)], {}, ()),
        (
            [(60, 0.2159)],
            {},
            ("string[1].od", "1/16 in above the diameter of the open hole", "well.sections[0]"),
        ),
        ([(53.0, 0.2667), (60, 0.2159)], {}, ("string[1].od", "at 53 m", "well.sections[1]")),
        (
            [(40, 0.22), (53.7, 0.2667), (60, 0.2159)],
            {"body_od": 0.23},
            ("string[1].body_od", "0.22 m", "body passes"),
        ),
    ],
)
def test_a_reamer_in_a_hole_narrower_than_itself(sections, reamer, words):
    """Refused where the body has passed, and where the blades stand."""
    case = statics_hole(sections, **reamer)
    if "body_od" in reamer:
        del case["string"][1]["mass"]
        case["string"][1]["blade_length"] = 0.4
        case["string"][1]["blade_position"] = 0.2
    if not words:
        Case(**case)
        return
    with pytest.raises(CaseError) as error:
        Case(**case)
    for word in words:
        assert word in str(error.value)
