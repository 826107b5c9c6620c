"""Requirements of every component: exact Jacobian, energy balance, no MPI in physics (manual:
verif-component-contract)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc.fem.bound_parts import ROW_SCALE
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.kernels.parameters import columns
from drillpetsc.physics import beam as beam_physics
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.contact import Contact
from drillpetsc.physics.end_conditions import Loads, NodeLoad
from drillpetsc.physics.top.hoist import FIGURES
from drillpetsc.time_function import Ramp
from tests.helpers.component_models import (
    KINDS,
    SECTION,
    SHIFT,
    both_jacobians,
    build,
    curved_tangents,
    meet_conditions,
    mesh_for,
)
from tests.helpers.tables import each_row

ENDS = "upper", "middle", "lower"


@each_row("kind", KINDS)
def test_condensed_jacobian_matches_central_differences(kind):
    """S = K + shift C + shift^2 M of every kernel, with prescribed rows, against fourth-order differences."""
    system, t = build(kind), 0.4
    asm = system.assembly
    free = meet_conditions(system, t)  # prescribed components are fixed by their rows, for any columns
    J, F = both_jacobians(system, t, 1e-4)
    scale = np.abs(J[np.abs(J) < 1e5]).max()
    assert np.abs((J - F) @ free).max() < 3e-7 * scale
    for f in asm.row_replacements:
        rows = f.D @ J[f.rows]
        assert np.allclose(rows[:, f.rows], ROW_SCALE * f.D)  # D x = value, and nothing else
        assert np.abs(np.delete(rows, f.rows, axis=1)).max() < 1e-9 * scale


@each_row("kind", [k for k in KINDS if k not in ("topdrive", "clamped")])
def test_rows_times_velocity_is_the_change_of_energy(kind):
    """y.R = d(kinetic + strain + potential)/dt + dissipated - supplied along the motion: the semi-discrete
    energy balance."""
    system, t = build(kind), 0.4
    asm = system.assembly
    asm.condense(SHIFT)
    force = np.array([f.does_work for f in system.layout.fields])[system.layout.field_of]
    power = float(asm.residual(t)[:-1][force] @ asm.y[:-1][force])
    powers = system.powers(t)
    x0, y0 = asm.x.copy(), asm.y.copy()
    flow = y0.copy()
    flow[asm.spin_at[:, 0]] -= asm.transport()

    def stored(h):
        asm.x[:], asm.y[:] = x0 + h * flow, y0 + h * asm.a
        # the input of a drive also changes the twist of its spring
        return sum(system.energies(t + h))

    h = 1e-4
    rate = (stored(-2 * h) - 8 * stored(-h) + 8 * stored(h) - stored(2 * h)) / (12 * h)
    assert power - 0.0 == pytest.approx(
        rate + powers.dissipated - powers.supplied, rel=2e-7, abs=1e-6 * (abs(rate) + abs(power))
    )


@each_row("kind", [k for k in KINDS if k.startswith("beam")])
def test_tables_have_the_energies_of_the_balance(kind):
    """Energies of the elements, as written to files, add up to those of the balance, whose sums the test above holds to the rows."""
    system = build(kind)
    asm, beam = system.assembly, system.components[0]
    table, names = beam.element_results(asm), beam_physics.RESULT_NAMES
    of_elements = [table[:, names.index(name)].sum() for name in ("kinetic", "strain", "potential")]
    balance = beam.energies(0.4, asm)
    assert of_elements == pytest.approx([balance.kinetic, balance.strain, balance.potential], rel=1e-12)


def test_axial_forces_have_the_mean_of_the_stretch():
    """Simpson's mean of the forces at both ends and in the middle is EA times the mean stretch of the cubic: the elongation."""
    system = build("beam")
    r, v = (system.field(f"string.{name}") for name in ("position", "tangent"))
    points, weights = np.polynomial.legendre.leggauss(3)
    xi = 0.5 + 0.5 * points[:, None, None]
    slope = 6 * xi * (1 - xi) * np.diff(r, axis=0)  # elements of 1 m
    slope = slope + (1 - xi) * (1 - 3 * xi) * v[:-1] + xi * (3 * xi - 2) * v[1:]
    stretch = 0.5 * weights @ np.linalg.norm(slope, axis=2) - 1
    results = system.components[0].element_results(system.assembly)
    upper, middle, lower = results[:, [beam_physics.RESULT_NAMES.index(f"axial_{name}") for name in ENDS]].T
    assert (upper + 4 * middle + lower) / 6 == pytest.approx(SECTION["axial_stiffness"] * stretch, rel=1e-12)


def test_a_load_in_the_axes_of_the_section_is_that_in_space():
    """Components along tangent, director 2 and director 3 = tangent x director 2 of an unbent pipe that has not turned."""
    frames = transported_frames(curved_tangents(5))
    t, second = frames.reference[2], frames.second_director[2]
    axes, rows = np.array([t, second, np.cross(t, second)]), []
    force, moment = np.array([4.0, 1.0, -2.0]), np.array([0.3, 2.0, 1.0])
    for load in (
        NodeLoad(2, tuple(force), tuple(moment), section=True),
        NodeLoad(2, tuple(force @ axes), tuple(moment @ axes)),
    ):
        mesh = mesh_for("")
        system = DiscreteSystem(mesh, frames, [AncfBeam(mesh, frames, np.zeros(3)), Loads((load,), frames)])
        system.set_field("string.position", np.cumsum(frames.reference, axis=0))
        system.set_field("string.tangent", frames.reference)
        rows.append(system.assembly.block_rows(system.assembly.bound_blocks[-1], 0.0).copy())
    assert rows[0] == pytest.approx(rows[1], abs=1e-13)


@each_row("kind", ["beam", "beam_damped", "bodies_junction", "curvature"])
def test_free_motion_keeps_momentum_and_angular_momentum(kind):
    """Forces and moments of the free string without gravity sum to zero, with inertia: the residual of a
    rigid virtual motion vanishes for the elastic part. Checked by differences of the residual with and
    without rates."""
    system = build(kind)
    for b in system.assembly.bound_blocks:  # no gravity
        if "gravity" in b.block.named.columns.names:
            b.block.named["gravity"] = 0.0
    asm = system.assembly
    asm.condense(SHIFT)
    asm.a[:] = 0.0
    if "damped" in kind:  # external damping brakes a rigid motion, internal damping does not
        for b in system.assembly.bound_blocks:
            b.block.named["alpha"] = 0.0
    asm.y[:] = 0.0
    asm.residual(0.0)
    r = system.field("string.position")
    v = system.field("string.tangent")
    rows = {k: asm.r[system.layout.dofs[f"string.{k}"]] for k in ("position", "tangent", "spin")}
    assert np.abs(rows["position"].sum(axis=0)).max() < 1e-11 * np.abs(rows["position"]).max()
    n = np.linalg.norm(v, axis=1, keepdims=True)
    moment = np.cross(r, rows["position"]) + np.cross(v, rows["tangent"]) + rows["spin"] * v / n
    assert np.abs(moment.sum(axis=0)).max() < 1e-11 * np.abs(moment).max()


def test_physics_imports_no_mpi():
    """No file of physics/ imports MPI or PETSc."""
    components = Path(__file__).parents[2] / "drillpetsc" / "physics"
    for file in components.rglob("*.py"):
        text = file.read_text()
        assert "mpi4py" not in text and "petsc4py" not in text, file.name


@each_row("kind", [k for k in KINDS if "contact" in k])
def test_contact_detects_a_state_of_nan(kind):
    """A state of nan is not taken for a string without contact."""
    system = build(kind)
    system.assembly.x[system.layout.dofs["string.position"][2, 0]] = np.nan
    place = system.layout.dofs["string.position"][2, 0]
    seen = 0
    for b in system.assembly.bound_blocks:
        if b.block.name.startswith("contact") and b.block.name != "contact_bodies":
            rows = system.assembly.block_rows(b, 0.4)[(b.index == place).any(axis=1)]
            assert np.isnan(rows).any(axis=1).all()
            seen += len(rows)
    assert seen == 2


@each_row("kind", [k for k in KINDS if "contact" in k])
@each_row("what", ["radius of the pipe", "friction of the pipe", "radius of the hole", "stiffness"])
def test_contact_returns_nan_for_nan(kind, what):
    """A nan is not taken for "no clearance", "friction not given" or "no contact" by any comparison."""
    system = build(kind)
    asm, contact = system.assembly, next(r for r in system.components if isinstance(r, Contact))
    blocks = [b for b in asm.bound_blocks if b.block.name.startswith("contact")]
    before = [asm.block_rows(b, 0.4) for b in blocks]
    touching = [(rows != 0).any(axis=1) for rows in before]
    assert (
        np.concatenate(touching).any()
        and np.isfinite(np.concatenate([rows.ravel() for rows in before])).all()
    )
    for b in blocks:
        if what.endswith("of the pipe"):
            b.block.named["radius" if what.startswith("radius") else "friction"] = np.nan
    if what == "radius of the hole":
        contact._packed.setflags(write=True)
        header, node, step = (columns(f"well_{name}") for name in ("header", "node", "step"))
        first = header.width + node.width * int(contact._packed[header["nodes"]])
        steps = contact._packed[first:].reshape(-1, step.width)
        contact._packed[header["radius"]], steps[:, step["radius"]] = np.nan, np.nan
        contact._forget_clearances()
    if what == "stiffness":
        contact.set_stiffness(np.nan)
    for b, touched in zip(blocks, touching, strict=True):
        wrong = np.isnan(asm.block_rows(b, 0.4)).any(axis=1)
        assert wrong[touched if what in ("stiffness", "friction of the pipe") else slice(None)].all()


@each_row(
    ("kind", "limited"),
    [
        ("motor_pi", 0), ("motor_upper", 1), ("motor_lower", 1), ("motor_power", 1), ("motor_rounded", 0),
    ],
)  # fmt: skip
def test_the_motors_of_the_contract_are_at_their_limits(kind, limited):
    """The states above lie where their name says: inside the limits, at one, or within its rounding."""
    from tests.helpers.component_models import RESULTS

    system = build(kind)
    asm, drive = system.assembly, next(c for c in system.components if c.name == "top_motor")
    asm.condense(SHIFT)
    drive.powers(0.4, asm)
    r = drive.results(asm)
    assert r[RESULTS["limited"]] == limited
    if kind == "motor_rounded":
        assert 0 < abs(r[RESULTS["command"]] - r[RESULTS["torque"]]) < 2.5e-3 * abs(r[RESULTS["command"]])


@each_row(("kind", "most"), [("motor_given_lag", np.inf), ("motor_given_rate", 0.5)])
def test_torque_follows_its_command_with_a_lag(kind, most):
    """M' = (command - M)/lag, no faster than the motor's torque may change; the lag is 0.2 s."""
    system = build(kind)
    asm = system.assembly
    ready = next(b for b in asm.bound_blocks if b.block.name == "top_motor")
    place = ready.index[0, 8]  # after position, slope, spin and the integrator
    for torque in (-3.0, 0.75, 5.0):
        asm.x[place] = torque
        wanted = np.clip((Ramp(1.0, 2.0).value(0.4) - torque) / 0.2, -most, most)
        assert asm.block_rows(ready, 0.4)[0, 8] == pytest.approx(asm.y[place] - wanted, rel=1e-12)


@each_row(("kind", "speed"), [("hoist_wob_upper", 0.02), ("hoist_wob_lower", 0.0), ("hoist_wob", None)])
def test_the_drums_of_the_contract_are_at_their_limits(kind, speed):
    """The autodrillers above run at the limit that their name says, or between the limits."""
    system = build(kind)
    asm, hoist = system.assembly, next(c for c in system.components if c.name == "hoist")
    asm.condense(SHIFT)
    drum = hoist.figures(0.4, asm)[FIGURES.index("drum_speed")]
    if speed is None:
        assert 0.1 < abs(drum) < 49
    else:
        assert drum == pytest.approx(speed, abs=1e-12)
