"""A quaternion string on the wall, and one with mud and a bit, with fixed steps: prints motion and reactions
(rank 0)."""

import sys

import petsc4py

petsc4py.init([sys.argv[0]])

import numpy as np  # noqa: E402

from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium  # noqa: E402
from drillpetsc.analysis.statics.placement import find_reactions, move_rigidly, release  # noqa: E402
from drillpetsc.model.drilling_model import build_model  # noqa: E402
from drillpetsc.output.recorder import Recorder  # noqa: E402
from tests.helpers.motion import fixed, integrate  # noqa: E402
from tests.verification.test_quaternion_contact import lying  # noqa: E402
from tests.verification.test_quaternion_models import model as with_everything  # noqa: E402
from tests.verification.test_quaternion_scenes import JOINT, MUD, scene  # noqa: E402

for constraint in ("index3", "stabilized"):
    top = {"kind": "top_drive", "rotation": {"ramp": 0.02, "value": 6.0}, "lowering": 0.1}
    beam = {"formulation": "quaternion", "constraint": constraint}
    model = build_model(lying("quaternion", top=top, beam=beam))
    find_equilibrium(model)
    release(model)
    move_rigidly(model)
    integrate(model.system, 0.04, fixed(2e-3, q_snes_stol=1e-10), breaks=model.breaks)
    m = model.system
    reactions = [m.reaction(f"top.{name}") for name in ("axial_reaction", "torque_reaction")]
    energies = m.energies(0.0)
    end = m.gather(np.hstack([model.beam.columns(m.assembly), m.field("string.multiplier")]))
    if end is not None:
        print(
            "END",
            constraint,
            *map(repr, [*end[-1].tolist(), *reactions, energies.kinetic, energies.strain]),
            flush=True,
        )

for name, more in (("ITEMS", {"joints": [JOINT]}), ("HERMITE", {"fluid": MUD | {"formulation": "hermite"}})):
    model = build_model(scene("quaternion", **more))
    find_equilibrium(model)
    release(model)
    move_rigidly(model)
    integrate(model.system, 0.02, fixed(2e-3, q_snes_stol=1e-11), breaks=model.breaks)
    m = model.system
    m.assembly.a[:] = 0.0
    find_reactions(model)
    reactions = [m.reaction(f"top.{name}") for name in ("axial_reaction", "torque_reaction")]
    end = m.gather(np.hstack([model.beam.columns(m.assembly), m.field("string.multiplier")]))
    if end is not None:
        print(name, *map(repr, [*end[18].tolist(), *end[-1].tolist(), *reactions]), flush=True)

model = build_model(with_everything("quaternion"))
find_equilibrium(model)
release(model)
move_rigidly(model)
recorder = Recorder(model)
recorder.start(0.0)
integrate(model.system, 0.04, fixed(2e-3, q_snes_stol=1e-11), breaks=model.breaks)
figures = recorder.sample(0.04)
names = [
    "hook_load", "surface_torque", "wob", "bit_torque", "pump_pressure", "bit_pressure", "hole_depth",
    "bit_speed",
]  # fmt: skip
row = recorder.history_row(0.04, 0.0, 0.0)
if model.system.comm.rank == 0:
    place = [name for name, _ in recorder.columns]
    print("MUD", *(repr(float(row[place.index(name)])) for name in names), flush=True)
