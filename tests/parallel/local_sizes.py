"""Print what each rank holds of a scene, one JSON object a rank."""

import json
import sys

import petsc4py

petsc4py.init(["local_sizes"])
from petsc4py import PETSc  # noqa: E402

from drillpetsc.case import load_case  # noqa: E402
from drillpetsc.model.drilling_model import build_scene  # noqa: E402
from drillpetsc.solvers.newton import chain_factor  # noqa: E402

case = load_case(sys.argv[1])
whole = build_scene(case, PETSc.COMM_SELF)
part = build_scene(case, PETSc.COMM_WORLD)
line = json.dumps({
    "unknowns": part.model.layout.size, "all_unknowns": whole.model.layout.size,
    "elements": len(part.model.line.cells), "all_elements": len(whole.model.line.cells),
    "values": len(part.model.assembly.values), "all_values": len(whole.model.assembly.values),
    "factor_flops": chain_factor(part.model).factor_flops, "serial_flops": chain_factor(whole.model).factor_flops,
})
sys.stdout.write(line + "\n")  # in one piece: the lines of two ranks must not mix
sys.stdout.flush()
