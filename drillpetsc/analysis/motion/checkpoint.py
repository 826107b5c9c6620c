"""Checkpoints: the complete state of a run in one file, which is written completely or not at all.

A restarted run continues as an uninterrupted one (manual: sec-time-restart).  The file is HDF5 behind a first
block of 512 bytes (a user block, which HDF5's readers skip).  The block contains the kind, the version and
the SHA-256 of all that follows, which detects incomplete and damaged files before any value is used.
Arrays are in depth order, so that another number of ranks can read them.  Only the entries of the
factorisation are stored by rank (solvers/time/newton.py).
"""

from __future__ import annotations

import hashlib
import io
import json
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.analysis.motion import provenance
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import LONGEST, CaseError
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output import RunFolder, read_summary
from drillpetsc.output.files.atomic import replace_file
from drillpetsc.output.files.run_writer import missing_output
from drillpetsc.output.recorder import Recorder
from drillpetsc.parallel import first_rank_gives
from drillpetsc.solvers.time.time_integrator import TimeIntegrator

VERSION = 7  # another one, too, if a kernel whose parameters a component keeps (annulus_flow) has others
BLOCK = 512  # bytes of the first block, the smallest size of an HDF5 user block
MAGIC = b"drillpetsc checkpoint "
GROUPS = ("fields", "rates", "frames", "recorder", "stepper")  # of arrays by name
WANT = "the checkpoint.h5 of a run"


@dataclass
class Checkpoint:
    """State of a run.

    time: [s].
    fields, rates: by name, (n_nodes, size) unknowns and rates [SI of each field].
    depths: (n_nodes,) measured depths of the nodes [m].
    frames: reference frames (see ``Frames``).
    components: by name, history variables that are the same on all ranks (``Component.get_state``).
    local_components: by name, history variables at each "vertex" (n_nodes, k) or "cell" (n_elements, k)
    (``Component.get_local_state``).
    recorder: state of the recorder; stepper: state of the integrator.
    imperfection: (n_nodes, 3) dead load at the nodes [N], None without one.
    top: anchor of the top end, empty if nothing is prescribed there.
    notes: texts and numbers.
    provenance: case, versions and PETSc options (``provenance.record``).
    """

    time: float
    fields: dict[str, FloatArray]
    rates: dict[str, FloatArray]
    depths: FloatArray
    frames: dict[str, FloatArray]
    components: dict[str, dict[str, FloatArray]] = field(default_factory=dict)
    local_components: dict[str, dict[str, FloatArray]] = field(default_factory=dict)
    recorder: dict[str, FloatArray] = field(default_factory=dict)
    stepper: dict[str, FloatArray] = field(default_factory=dict)
    imperfection: FloatArray | None = None
    top: FloatArray = field(default_factory=lambda: np.empty(0))
    notes: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)


def take(
    model: DrillingModel,
    recorder: Recorder,
    integrator: TimeIntegrator,
    time: float,
    notes: dict[str, Any] | None = None,
) -> Checkpoint | None:
    """Collect the state on rank 0, None elsewhere, without changing it; collective.

    Matrix entries of a run on one rank are the assembly's array, which the next step may overwrite: see ``lasting``.

    It is called after all other work of a step (``TimeIntegrator.on_step_end``).

    time: [s]; notes: texts and numbers to store.
    """
    system = model.system
    components = {c.name: history for c in model.components if (history := c.get_state())}
    local_components = {
        c.name: _gathered(system, local) for c in model.components if (local := c.get_local_state())
    }
    balances, stepper = recorder.get_state(), integrator.get_state()
    names = [f.name for f in system.layout.fields]
    values = system.gather(
        np.hstack([system.field(n) for n in names] + [system.field(n, "y") for n in names])
    )
    dead_load = None
    if system.assembly.dead_load is not None:
        dofs = system.layout.dofs["string.position"]
        dead_load = system.gather(system.assembly.dead_load[dofs])
    if values is None:
        return None
    sizes = [f.size for f in system.layout.fields]
    parts = np.split(values, np.cumsum(sizes + sizes)[:-1], axis=1)
    fields = dict(zip(names, parts[: len(names)], strict=True))
    rates = dict(zip(names, parts[len(names) :], strict=True))
    frames = {
        "reference": system.frames.reference,
        "second": system.frames.second_director,
        "twist0": system.frames.twist0,
    }
    return Checkpoint(
        time,
        fields,
        rates,
        np.asarray(model.mesh.node_depth),
        frames,
        components,
        local_components,
        balances,
        stepper,
        dead_load,
        model.top.anchor,
        notes or {},
        provenance.record(model.case, integrator.user_options),
    )


def _gathered(system: DiscreteSystem, state: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Collect values at local vertices and cells on rank 0, in depth order; empty elsewhere; collective."""
    gathered = {on: system.gather(values, on) for on, values in state.items()}
    return {on: values for on, values in gathered.items() if values is not None}


def lasting(c: Checkpoint) -> Checkpoint:
    """The checkpoint with copies of the arrays that the next step may overwrite."""
    return replace(c, stepper={name: np.array(values) for name, values in c.stepper.items()})


# ---------------------------------------------------------------------- files
def write(path: Path, c: Checkpoint) -> None:
    """Write ``c`` to ``path``; the previous file remains until the new one is on the disk."""
    import h5py

    tree: dict[str, dict[str, FloatArray]] = {
        **{name: getattr(c, name) for name in GROUPS},
        **{f"components/{name}": state for name, state in c.components.items()},
        **{f"places/{name}": state for name, state in c.local_components.items()},
    }
    single_arrays = {"depths": c.depths, "imperfection": c.imperfection, "top": c.top}
    # in memory, since HDF5 does not recover cleanly when the disk becomes full
    image = io.BytesIO()
    with h5py.File(image, "w", userblock_size=BLOCK) as file:
        file.attrs["time"], file.attrs["notes"] = c.time, json.dumps(c.notes)
        # a dataset, since an attribute holds 64 kB at most
        file["provenance"] = np.frombuffer(json.dumps(c.provenance).encode(), dtype=np.uint8)
        for group, arrays in tree.items():
            place = file.require_group(group)
            for name, values in arrays.items():
                place[name] = values
        for name, single in single_arrays.items():
            if single is not None:
                file[name] = single
    body = image.getbuffer()[BLOCK:]
    first = MAGIC + f"{VERSION} sha256 {hashlib.sha256(body).hexdigest()}\n".encode()

    def put(target: Path) -> None:
        with target.open("wb") as out:  # in two parts: together they would be one more copy
            out.write(first.ljust(BLOCK, b"\0"))
            out.write(body)

    replace_file(path, put, lasting=True)


def read(path: str | Path) -> Checkpoint:
    """Read the checkpoint at ``path``.

    Raises CaseError if it is missing, incomplete, damaged or of another kind or version.
    """
    import h5py

    if not Path(path).is_file():
        raise CaseError(
            file=path,
            got="no such file",
            want="a run folder with a checkpoint.h5",
            hint="was the run stopped before its first checkpoint?",
        )
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise CaseError(got=str(path), want="a file that can be read", hint=str(error)) from None
    _inspect(path, data)
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            components, local_components = (
                {name: _arrays(group) for name, group in file[kind].items()} if kind in file else {}
                for kind in ("components", "places")
            )
            return Checkpoint(
                time=float(file.attrs["time"]),
                depths=np.array(file["depths"]),
                components=components,
                local_components=local_components,
                imperfection=np.array(file["imperfection"]) if "imperfection" in file else None,
                top=np.array(file["top"]),
                notes=json.loads(file.attrs["notes"]),
                provenance=json.loads(np.array(file["provenance"]).tobytes()),
                **{name: _arrays(file[name]) for name in GROUPS},
            )
    except (OSError, KeyError, ValueError, TypeError, RuntimeError) as error:  # complete, with other contents
        hint = f"it was written by another version of drillpetsc ({error})"
        raise CaseError(file=path, want=WANT, hint=hint) from None


def _arrays(group) -> dict[str, FloatArray]:
    return {name: np.array(values) for name, values in group.items()}


def _inspect(path: str | Path, data: bytes) -> None:
    """Raise CaseError unless the file is complete, undamaged and of this version."""
    if not data.startswith(MAGIC):
        raise CaseError(
            file=path, got=f"{len(data)} bytes of something else" if data else "an empty file", want=WANT
        )
    words = data[len(MAGIC) : BLOCK].split(b"\n")[0].split()
    if len(words) != 3 or not words[0].isdigit():
        raise CaseError(file=path, got="a damaged first block", want=WANT)
    if int(words[0]) != VERSION:
        raise CaseError(
            file=path,
            got=f"checkpoint version {int(words[0])}",
            want=f"version {VERSION}",
            hint="it was written by another version of drillpetsc: continue the run with that version, or start it again",
        )
    if hashlib.sha256(data[BLOCK:]).hexdigest().encode() != words[2]:
        raise CaseError(
            file=path,
            got="a file that was cut short or damaged (its checksum is wrong)",
            want=WANT,
            hint="take it from a copy of the run folder, or start the run again with --overwrite",
        )


# ---------------------------------------------------------------------- back into a model
def restore(model: DrillingModel, c: Checkpoint, at: str = "--restart") -> None:
    """Load the state of checkpoint ``c`` into the model.

    at: key for the error message.
    Raises CaseError if the checkpoint is of another string.
    """
    system = model.system
    for f in system.layout.fields:
        values = c.fields.get(f.name)
        if values is None or values.shape != (system.mesh.nodes, f.size):
            raise CaseError(
                at=at, want=f"a checkpoint of the same string ({system.mesh.nodes} nodes with {f.name})"
            )
    if not np.allclose(c.depths, model.mesh.node_depth, rtol=0, atol=1e-6):
        raise CaseError(
            at=at, want="a checkpoint of the same string", hint="its nodes have other measured depths"
        )
    for f in system.layout.fields:
        system.set_field(f.name, c.fields[f.name])
        system.set_field(f.name, c.rates[f.name], "y")
    system.frames.reference[:], system.frames.second_director[:] = c.frames["reference"], c.frames["second"]
    system.frames.twist0[:] = c.frames["twist0"]
    system.assembly.reference[:] = system.frames.reference[system.chain.vertices]
    for component in system.components:
        component.update_reference_frames()
    if c.imperfection is not None:
        dead_load, dofs = np.zeros(system.layout.size), system.layout.dofs["string.position"]
        owned = system.chain.owned
        dead_load[dofs[owned]] = c.imperfection[system.chain.vertices[owned]]
        system.assembly.dead_load = dead_load
    if len(c.top) and model.top.prescribes:  # a changed case may have another kind of top
        model.top.anchor[:] = c.top
    for component in model.components:
        if component.name in c.components:
            component.set_state(c.components[component.name])
        if component.name in c.local_components:
            local_numbers = {"vertex": system.chain.vertices, "cell": system.chain.cells}
            component.set_local_state(
                {on: values[local_numbers[on]] for on, values in c.local_components[component.name].items()}
            )


ROUNDING = 1e-9  # output times closer than this fraction of the end time are one


def saved_state(comm, folder: RunFolder, restart: bool) -> Checkpoint | None:
    """The checkpoint that a restart continues; None at a start, or if the folder has none yet; collective.

    Raises CaseError if the checkpoint cannot be read, or is missing in the folder of a run that has reached its end.
    """
    if not restart:
        return None

    def found() -> Checkpoint | None:
        if folder.checkpoint.exists():
            return read(folder.checkpoint)
        if folder.summary.exists() and read_summary(folder.summary).get("status") == "done":
            want = "the checkpoint of the run, which is continued"
            hint = "take the file from a copy of the run folder, or start the run again with --overwrite"
            raise CaseError(file=folder.checkpoint, got="no such file", want=want, hint=hint)
        return None

    saved: Checkpoint | None = first_rank_gives(comm.tompi4py(), found)
    return saved


def check_restart(
    comm,
    saved: Checkpoint | None,
    folder: RunFolder,
    case: Case,
    recorder: Recorder,
    integrator: TimeIntegrator,
    accept_changes: bool,
) -> list[str]:
    """Raise CaseError, on all ranks, where ``saved`` cannot be continued; returns accepted changes; collective."""
    if saved is None:
        if accept_changes:
            raise CaseError(at="--accept-changes", want="--restart of a run with a checkpoint")
        return []
    assert case.time is not None
    early: CaseError | None = None
    if case.time.end < saved.time * (1 - ROUNDING):
        early = CaseError(
            at="time.end",
            got=f"{case.time.end:.9g} s",
            want=f"at least {saved.time:.9g} s, the time of the checkpoint",
            hint=f"the run in {folder.path} has already passed this time",
        )
    changes = provenance.changes(saved.provenance, case, integrator.user_options)
    if changes and not accept_changes:
        raise CaseError(
            file=folder.checkpoint,
            got="changed since the checkpoint (numbers in SI units): " + provenance.listed(changes),
            want="the case, the PETSc options and the drillpetsc of the run; "
            f"only {', '.join(provenance.FREE_KEYS)} may change",
            hint="--accept-changes continues nevertheless; --overwrite begins anew"
            if early is None
            else "--overwrite begins anew",
            longest=LONGEST,
            also=[] if early is None else [early],
        )
    if early is not None:
        raise early

    def refuse_missing_output() -> None:
        notes = saved.notes
        refusal = missing_output(folder, recorder, saved.time, notes["last_row"], notes["tables"])
        if refusal is not None:
            raise refusal

    first_rank_gives(comm.tompi4py(), refuse_missing_output)
    return changes


def is_finished(time: float, end: float) -> bool:
    """Whether a run that has reached ``time`` [s] is at its ``end`` [s]."""
    return time >= end * (1 - ROUNDING)
