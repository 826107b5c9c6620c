"""Absent physics has no unknowns, no log events, no columns and no arrays: a table of models (manual:
verif-component-contract)."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.motion.summary import field_counts
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.case import Case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.measured.field_output import FieldOutput
from drillpetsc.output.recorder import Recorder
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

PIPE = {"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1086}
COLLAR = {"kind": "pipe", "length": 20, "od": 0.1778, "id": 0.0714}
SIDE = {"kind": "stabilizer", "length": 0, "od": 0.2, "mass": 0, "nozzle_area": 1e-4}
BIT = {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 60}
WELL = simple_well(60, 0.2159, 0.1, kind="casing", friction=0.2)
DRIVE = {"kind": "top_drive", "rotation": 1.0}
DAMPED = {"damping": {"stiffness": 1e-4}}

BASE = {"time", "bit_speed", "bit_depth", "kinetic_energy", "strain_energy", "energy_error", "step", "newton"}
HELD = {"hook_load", "surface_torque"}
BOTTOM = {"wob", "bit_torque", "hole_depth"}

# model: (case, unknowns per ordinary node, extra unknowns, log events, history columns, point arrays beyond
# the usual)
MODELS = {
    "free pipe": ({"string": [PIPE], "top": "free"}, 7, 0, {"beam"}, BASE, set()),
    "hung pipe": ({"string": [PIPE], "top": DRIVE}, 7, 0, {"beam"}, BASE | HELD, set()),
    "damped": (
        {"string": [PIPE], "top": DRIVE, "material": DAMPED}, 7, 0, {"beam_damped"}, BASE | HELD, set(),
    ),
    "section change": (
        {"string": [PIPE, COLLAR], "top": DRIVE}, 7, 1, {"beam", "beam_junction"}, BASE | HELD, set(),
    ),
    "unbalanced": (
        {"string": [{**PIPE, "eccentricity": 0.002}], "top": DRIVE}, 7, 0, {"beam", "eccentric"}, BASE | HELD,
        set(),
    ),
    "bent": (
        {"string": [{**PIPE, "curvature": 1e-4}], "top": DRIVE}, 7, 0, {"beam", "curvature"}, BASE | HELD,
        set(),
    ),
    "loaded": (
        {"string": [PIPE], "top": DRIVE, "loads": [{"at": 30, "force": [1, 0, 0]}]}, 7, 0, {"beam", "loads"},
        BASE | HELD, set(),
    ),
    "driven": (
        {"string": [PIPE], "top": {"kind": "driven", "stiffness": 1e3}}, 7, 0, {"beam", "drive"}, BASE | HELD,
        set(),
    ),
    "in a hole": (
        {"string": [PIPE], "top": DRIVE, "well": WELL}, 7, 0, {"beam", "contact", "contact_below"},
        BASE | HELD, {"contact_force [N/m]", "hole_radius [m]"},
    ),
    "hole without contact": (
        {"string": [PIPE], "top": DRIVE, "well": WELL, "contact": "none"}, 7, 0, {"beam"}, BASE | HELD,
        {"hole_radius [m]"},
    ),
    "bit on bottom": (
        {"string": [PIPE, BIT], "top": DRIVE, "well": WELL, "bottom": "bit"}, 7, 0,
        {"beam", "bodies", "contact", "contact_bodies", "bit_bottom"}, BASE | HELD | BOTTOM,
        {"contact_force [N/m]", "hole_radius [m]"},
    ),
}  # fmt: skip
MUD = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}}
HOLE = {"contact_force [N/m]", "hole_radius [m]"}
INSIDE, AROUND = (
    {f"{side}_{what}" for what in ("pressure [Pa]", "flow [m3/s]", "speed [m/s]")}
    for side in ("internal", "annulus")
)
PUMPED = {"pump_pressure", "bit_pressure", "outlet_flow", "pump_flow", "bit_flow"}
# with mud: unknowns per node 7 of the string, 2 of each channel; a flow rate less than nodes, one more for
# the link at the bit
WET = {
    "pipe with flow": (
        {"string": [PIPE], "top": DRIVE, "fluid": MUD}, 9, 0, {"beam", "bore_flow", "pump", "bit_flow"},
        BASE | HELD | PUMPED, INSIDE,
    ),
    "coupled": (
        {"string": [PIPE, BIT], "top": DRIVE, "well": WELL, "bottom": "bit", "fluid": MUD},
        11,
        -1,
        {
            "beam", "bodies", "contact", "contact_bodies", "bit_bottom", "bore_flow", "pump", "annulus_flow",
            "annulus_top", "bit_flow", "mud_items",
        },
        BASE | HELD | BOTTOM | PUMPED,
        HOLE | INSIDE | AROUND,
    ),
    "coupled, section change": (
        {"string": [PIPE, COLLAR], "top": DRIVE, "well": WELL, "fluid": MUD},
        11,
        0,
        {
            "beam", "beam_junction", "contact", "contact_junction_above", "contact_below", "bore_flow",
            "bore_flow_junction", "pump", "annulus_flow", "annulus_flow_junction", "annulus_top", "bit_flow",
        },
        BASE | HELD | PUMPED,
        HOLE | INSIDE | AROUND,
    ),
    "mud in the bore only": (
        {"string": [PIPE], "top": DRIVE, "well": WELL, "fluid": {**MUD, "annulus": False}}, 9, 0,
        {"beam", "contact", "contact_below", "bore_flow", "pump", "bit_flow"}, BASE | HELD | PUMPED,
        HOLE | INSIDE,
    ),
    "nozzles above the bit": (
        {"string": [PIPE, SIDE, COLLAR], "hold_string": True, "well": WELL, "fluid": MUD}, 4, 0,
        {"bore_flow", "pump", "annulus_flow", "bit_flow", "side_nozzles"},
        (BASE - {"bit_speed", "bit_depth"}) | PUMPED | {"side_flow"}, {"hole_radius [m]"} | INSIDE | AROUND,
    ),
    "plugged and empty": (
        {
            "string": [PIPE],
            "top": DRIVE,
            "well": WELL,
            "bottom": {"kind": "free", "plugged": True},
            "fluid": MUD,
        },
        9,
        -1,
        {"beam", "contact", "contact_below", "annulus_flow", "annulus_top", "bit_flow"},
        BASE | HELD | {"bit_pressure", "outlet_flow"},
        HOLE | AROUND,
    ),
    "held": (
        {"string": [PIPE], "hold_string": True, "well": WELL, "fluid": MUD}, 4, -1,
        {"bore_flow", "pump", "annulus_flow", "bit_flow"}, (BASE - {"bit_speed", "bit_depth"}) | PUMPED,
        {"hole_radius [m]"} | INSIDE | AROUND,
    ),
    "with a choke": (
        {"string": [PIPE], "hold_string": True, "well": WELL, "fluid": {**MUD, "choke": {"area": 3e-4}}}, 4,
        -1, {"bore_flow", "pump", "annulus_flow", "choke", "bit_flow"},
        (BASE - {"bit_speed", "bit_depth"}) | PUMPED, {"hole_radius [m]"} | INSIDE | AROUND,
    ),
    "held, bore only": (
        {"string": [PIPE], "hold_string": True, "fluid": MUD}, 2, 0, {"bore_flow", "pump", "bit_flow"},
        (BASE - {"bit_speed", "bit_depth"}) | PUMPED, INSIDE,
    ),
}  # fmt: skip
USUAL = {
    "md [m]", "slope [-]", "displacement [m]", "velocity [m/s]", "spin [rad/s]", "spin_angle [rad]", "offset_x [m]",
    "offset_y [m]", "axial_force [N]", "torque [N m]", "bending_moment [N m]", "bending_moment_x [N m]",
    "bending_moment_y [N m]", "shear_force [N]", "shear_force_x [N]", "shear_force_y [N]", "outer_radius [m]",
    "stress [Pa]",
}  # fmt: skip


@each_row("name", [*MODELS, *WET])
def test_model_has_the_parts_of_its_physics_only(name):
    keys, per_node, extra, events, columns, arrays = (MODELS | WET)[name]
    model = build_model(Case(**keys))
    system, nodes = model.system, model.mesh.nodes
    assert system.layout.size == per_node * nodes + extra
    string = (
        0
        if "hold_string" in keys
        else 7 * nodes + sum(n for f, n in field_counts(system) if f.region == "junction")
    )
    assert system.new_state().getSize() == system.layout.size + string  # of the string, rates too
    assert {b.block.name for b in system.assembly.bound_blocks} == events
    assert len(system.assembly.values) == sum(
        b.count * b.width**2 for b in system.assembly.bound_blocks
    ) + 49 * len(system.assembly.row_replacements)
    recorder = Recorder(model)
    assert {c for c, _ in recorder.columns} == columns
    place_along_hole(model)
    points, data = FieldOutput(model).fields(0.0)
    usual = USUAL | ({"effective_tension [N]"} if "fluid" in keys else set())
    assert set(data) == ({"md [m]", "outer_radius [m]"} if "hold_string" in keys else usual) | arrays
    assert all(np.isfinite(v).all() for v in data.values()) and len(points) == nodes


def test_without_contact_the_newton_line_search_is_the_plain_one():
    """Without contact the line search has no extra cost."""
    from drillpetsc.solvers.time.time_integrator import TimeIntegrator

    for name, kind in (("hung pipe", "basic"), ("in a hole", "cp")):
        model = build_model(Case(**MODELS[name][0]))
        newton = TimeIntegrator(model.system).newton
        assert newton.line_search == kind
