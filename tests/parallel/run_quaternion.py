"""A lying, turning quaternion string, fixed steps: prints the motion of its lower end and the reactions at its top (rank 0)."""

import sys

import petsc4py

petsc4py.init([sys.argv[0]])

import numpy as np  # noqa: E402

from drillpetsc.scene import build_scene  # noqa: E402
from drillpetsc.start import find_equilibrium, move_rigidly, release  # noqa: E402
from tests.verify.motion import fixed, integrate  # noqa: E402
from tests.verify.test_quaternion_contact import lying  # noqa: E402

for constraint in ("index3", "stabilized"):
    top = {"kind": "top_drive", "rotation": {"ramp": 0.02, "value": 6.0}, "lowering": 0.1}
    beam = {"formulation": "quaternion", "constraint": constraint}
    scene = build_scene(lying("quaternion", top=top, beam=beam))
    find_equilibrium(scene)
    release(scene)
    move_rigidly(scene)
    integrate(scene.model, 0.04, fixed(2e-3, q_snes_stol=1e-10), breaks=scene.breaks)
    m = scene.model
    reactions = [m.reaction(f"top.{name}") for name in ("axial_reaction", "torque_reaction")]
    energies = m.energies(0.0)
    end = m.gather(np.hstack([scene.beam.columns(m.assembly), m.field("string.multiplier")]))
    if end is not None:
        print("END", constraint, *map(repr, [*end[-1].tolist(), *reactions, energies.kinetic, energies.strain]), flush=True)
