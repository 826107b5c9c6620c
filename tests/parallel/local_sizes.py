"""Print the local sizes of each rank for a case, one JSON object per rank."""

import json
import sys

import petsc4py

petsc4py.init(["local_sizes"])
from petsc4py import PETSc  # noqa: E402

from drillpetsc.case import load_case  # noqa: E402
from drillpetsc.model.drilling_model import build_model  # noqa: E402
from drillpetsc.solvers.time.newton import chain_factor  # noqa: E402

case = load_case(sys.argv[1])
whole = build_model(case, PETSc.COMM_SELF)
part = build_model(case, PETSc.COMM_WORLD)
line = json.dumps(
    {
        "unknowns": part.system.layout.size,
        "all_unknowns": whole.system.layout.size,
        "elements": len(part.system.chain.cells),
        "all_elements": len(whole.system.chain.cells),
        "values": len(part.system.assembly.values),
        "all_values": len(whole.system.assembly.values),
        "factor_flops": chain_factor(part.system).factor_flops,
        "serial_flops": chain_factor(whole.system).factor_flops,
    }
)
sys.stdout.write(line + "\n")  # one write, so that the lines of two ranks do not mix
sys.stdout.flush()
