"""The contract of a component, for plug-ins: exact Jacobian, finite rows, equal results on one and two ranks (manual: sec-plug-ins)."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from drillpetsc.case.case import Case
from drillpetsc.fem.assembly import Assembly
from drillpetsc.fem.bound_parts import BoundBlock
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output.files.tables import read_table

WEIGHTS = (1.0, 0.7, 0.3)  # of dR/dx, dR/dy and dR/da in the Jacobian that is compared
STEPS = ((-2, 1 / 12), (-1, -2 / 3), (1, 2 / 3), (2, -1 / 12))  # fourth-order differences
OF_STEPS = ("step", "newton", "energy_error")  # columns of the history about the computation


def check_jacobian(
    case: Case, names: Sequence[str], seed: int = 1, size: float = 1e-4, tolerance: float = 1e-6
) -> None:
    """Assert that the rows of components are finite and that their Jacobian is the derivative of the rows.

    case: of a small model; names: of the components, whose blocks are looked at one element at a time.
    seed: of a random state about the string at the start; size: of the differences, over the usual sizes of the unknowns.
    tolerance: over the largest entry of a block.
    """
    model = build_model(case)
    asm = _random_state(model, seed)
    owners = zip(asm.bound_blocks, model.system.component_of, strict=True)
    blocks = [b for b, component in owners if component.name in names and b.count]
    assert blocks, (
        f"no component named {', '.join(names)} has an element: {[c.name for c in model.components]}"
    )
    for b in blocks:
        rows = asm.block_rows(b, 0.0)
        assert rows.shape == (b.count, b.width) and np.isfinite(rows).all(), f"{b.block.name}: rows {rows}"
        asm.jacobian(0.0, WEIGHTS, condensed=False)
        exact = asm.values[b.span].reshape(b.count, b.width, b.width).copy()
        scale = max(np.abs(exact).max(), 1e-300)
        for e in range(b.count):
            found = _differences(asm, b, e, size)
            worst = np.abs(found - exact[e]).max()
            assert worst <= tolerance * scale, (
                f"{b.block.name}, element {e}: Jacobian {worst:.3g} off, entries {scale:.3g}"
            )


def check_ranks(file: str | Path, launch: Sequence[str], tolerance: float = 1e-6) -> None:
    """Assert that the run of a case file has the same history on one and on two ranks.

    launch: words that start two ranks, such as ``["mpirun", "-n", "2"]``; tolerance: over the largest value of a column.
    """
    with TemporaryDirectory() as folder:
        histories = []
        for name, words in (("one", ()), ("two", tuple(launch))):
            out = Path(folder) / name
            command = [*words, sys.executable, "-m", "drillpetsc", "run", str(file), "--out", str(out)]
            done = subprocess.run(command, capture_output=True, text=True, env=_without_mpi())
            assert done.returncode == 0, done.stdout + done.stderr
            histories.append(read_table(out / "history.csv"))
    one, two = histories
    for name, values in one.items():
        if not name.startswith(OF_STEPS):
            worst = np.abs(two[name] - values).max()
            assert worst <= tolerance * max(np.abs(values).max(), 1e-9), (
                f"{name}: {worst:.3g} apart on two ranks"
            )


def _without_mpi() -> dict[str, str]:
    """The environment without what MPI has set in this process, which a new job must not inherit."""
    own = ("PMIX", "PMI_", "PRTE_", "OMPI_")
    kept = ("OMPI_ALLOW", "OMPI_MCA_rmaps")
    return {key: text for key, text in os.environ.items() if key.startswith(kept) or not key.startswith(own)}


def _random_state(model: DrillingModel, seed: int) -> Assembly:
    """The string at the start, with random displacements and rates of the usual sizes of the unknowns."""
    asm, random = model.system.assembly, np.random.default_rng(seed)
    model.system.set_field("string.position", model.position)
    model.system.set_field("string.tangent", model.tangent)
    scale = _scales(asm)
    for values in (asm.x, asm.y, asm.a):
        values[: len(scale)] += scale * random.standard_normal(len(scale))
    return asm


def _scales(asm: Assembly) -> np.ndarray:
    """(n,) usual size of each local unknown."""
    layout = asm.layout
    return 1e-2 * np.array([layout.fields[k].scale for k in layout.field_of])


def _differences(asm: Assembly, b: BoundBlock, e: int, size: float) -> np.ndarray:
    """(width, width) differences of the rows of an element by its unknowns, as ``WEIGHTS`` combine them."""
    out, scale = np.zeros((b.width, b.width)), _scales(asm)
    for j, place in enumerate(b.index[e]):
        if place >= len(scale):  # an unknown that the node does not have
            continue
        h = size * scale[place]
        kept = [values[place] for values in (asm.x, asm.y, asm.a)]
        for k, share in STEPS:
            for values, before, weight in zip((asm.x, asm.y, asm.a), kept, WEIGHTS, strict=True):
                values[place] = before + k * h * weight
            out[:, j] += share / h * asm.block_rows(b, 0.0)[e]
        for values, before in zip((asm.x, asm.y, asm.a), kept, strict=True):
            values[place] = before
    return out
