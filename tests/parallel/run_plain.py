"""A rotating pendulum with other integrators: prints position and spin of its lower end (rank 0)."""

import sys

import petsc4py

petsc4py.init([sys.argv[0]])

import numpy as np  # noqa: E402

from tests.helpers.motion import beam, fixed, integrate, straight  # noqa: E402

for kind in sys.argv[1:]:
    model = straight(
        string=[beam(0.5, 4, 2000.0, 6.667e-4, 1e-3, 0.02, 1.7e-7)],
        top={"kind": "top_drive", "rotation": {"ramp": 0.2, "value": 10.0}},
        gravity=[3.0, 0, 9.81],
        initial={"inclination": 1.0},
    )
    options = {"snes_type": "newtonls"} if kind == "bdf" else {"ts_type": kind}
    integrate(model.system, 0.1, fixed(1e-3, snes_rtol=1e-11, **options), breaks=model.breaks)
    end = model.system.gather(
        np.hstack([model.system.field("string.position"), model.system.field("string.spin")])
    )
    if end is not None:
        print("END", kind, *map(repr, end[-1].tolist()), flush=True)
