"""Checkpoints: everything a run needs to go on as if it had never stopped, in one file that is whole or not
there.

The file is HDF5 behind a first block of 512 bytes (a user block, which HDF5's readers pass over) with the
kind, the version and the SHA-256 of all that follows: what is cut short or damaged is refused before anything
is believed of it.  Arrays are in depth order, so another number of ranks can read them; only what cannot
matter there is kept by ranks (solvers/newton.py).
"""

from __future__ import annotations

import hashlib
import io
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.files.atomic import replace_file
from drillpetsc.output.recorder import Recorder
from drillpetsc.solvers.time_integrator import TimeIntegrator

VERSION = 3
BLOCK = 512  # bytes of the first block, the least that HDF5 takes
MAGIC, OLD_MAGIC = b"drillpetsc checkpoint ", b"\x89HDF\r\n\x1a\n"  # version 1 was plain HDF5
WANT = "the checkpoint.h5 of a run"


@dataclass
class Checkpoint:
    """State of a run at ``time`` [s].

    fields, rates: name -> (n_nodes, size), unknowns and rates; depths: (n_nodes,) of the nodes [m]; frames:
    reference frames; components: their history variables by name (the same on all ranks);
    places: what they carry at each "vertex" or "cell" (``get_local_state``, (n_nodes, k) or (n_elements, k)
    here); recorder: of the recorder; stepper: of the integrator; notes: plain words and numbers.
    """

    time: float
    fields: dict[str, FloatArray]
    rates: dict[str, FloatArray]
    depths: FloatArray
    frames: dict[str, FloatArray]
    components: dict[str, dict[str, FloatArray]] = field(default_factory=dict)
    places: dict[str, dict[str, FloatArray]] = field(default_factory=dict)
    recorder: dict[str, FloatArray] = field(default_factory=dict)
    stepper: dict[str, FloatArray] = field(default_factory=dict)
    imperfection: FloatArray | None = None
    top: FloatArray | None = None
    notes: dict[str, Any] = field(default_factory=dict)


def take(
    model: DrillingModel,
    recorder: Recorder,
    integrator: TimeIntegrator,
    time: float,
    notes: dict[str, Any] | None = None,
) -> Checkpoint | None:
    """Collect the state on rank 0 (None elsewhere), changing nothing; collective, after a step is done with
    (TimeIntegrator.at_rest)."""
    system = model.system
    components = {c.name: history for c in model.components if (history := c.get_state())}
    places = {c.name: _gathered(system, local) for c in model.components if (local := c.get_local_state())}
    balances, stepper = recorder.get_state(), integrator.get_state()
    names = [f.name for f in system.layout.fields]
    values = system.gather(
        np.hstack([system.field(n) for n in names] + [system.field(n, "y") for n in names])
    )
    dead = None
    if system.assembly.dead_load is not None:
        place = system.layout.dofs["string.position"]
        dead = system.gather(system.assembly.dead_load[place])
    if values is None:
        return None
    sizes = [f.size for f in system.layout.fields]
    parts = np.split(values, np.cumsum(sizes + sizes)[:-1], axis=1)
    fields = dict(zip(names, parts[: len(names)], strict=True))
    rates = dict(zip(names, parts[len(names) :], strict=True))
    frames = {
        "reference": system.frames.reference,
        "second": system.frames.second,
        "twist0": system.frames.twist0,
    }
    top = model.top.anchor if model.top is not None else None
    return Checkpoint(
        time,
        fields,
        rates,
        np.asarray(model.mesh.node_depth),
        frames,
        components,
        places,
        balances,
        stepper,
        dead,
        top,
        notes or {},
    )


def _gathered(system: DiscreteSystem, memory: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Values at local vertices and cells, in depth order; whole on rank 0."""
    whole = {on: system.gather(values, on) for on, values in memory.items()}
    return {on: values for on, values in whole.items() if values is not None}


# ---------------------------------------------------------------------- files
def write(path: Path, c: Checkpoint) -> None:
    """Write ``c``; the file before it stays until the disk has the new one."""
    import h5py

    tree = {
        "fields": c.fields,
        "rates": c.rates,
        "frames": c.frames,
        "recorder": c.recorder,
        "stepper": c.stepper,
        **{f"components/{name}": memory for name, memory in c.components.items()},
        **{f"places/{name}": memory for name, memory in c.places.items()},
    }
    rest: dict[str, FloatArray | None] = {"depths": c.depths, "imperfection": c.imperfection, "top": c.top}
    # in memory: HDF5 that meets a full disk half-way is hard to leave in good order
    with h5py.File("checkpoint", "w", driver="core", backing_store=False, userblock_size=BLOCK) as file:
        file.attrs["time"], file.attrs["notes"] = c.time, json.dumps(c.notes)
        for group, arrays in tree.items():
            file.require_group(group)
            for name, values in arrays.items():
                file[f"{group}/{name}"] = values
        for name, single in rest.items():
            if single is not None:
                file[name] = single
        file.flush()
        body = file.id.get_file_image()  # without the first block
    first = MAGIC + f"{VERSION} sha256 {hashlib.sha256(body).hexdigest()}\n".encode()
    replace_file(path, lambda target: target.write_bytes(first.ljust(BLOCK, b"\0") + body), lasting=True)


def read(path: str | Path) -> Checkpoint:
    """Read a checkpoint; raises CaseError when there is none, or it is cut short, damaged or of another
    kind."""
    import h5py

    if not Path(path).is_file():
        raise CaseError(
            got=str(path),
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
            groups = {g: _arrays(file[g]) for g in ("fields", "rates", "frames", "recorder", "stepper")}
            components, places = (
                {name: _arrays(group) for name, group in file[kind].items()} if kind in file else {}
                for kind in ("components", "places")
            )
            imperfection, top = (
                np.array(file[name]) if name in file else None for name in ("imperfection", "top")
            )
            return Checkpoint(
                float(file.attrs["time"]),
                groups["fields"],
                groups["rates"],
                np.array(file["depths"]),
                groups["frames"],
                components,
                places,
                groups["recorder"],
                groups["stepper"],
                imperfection,
                top,
                json.loads(file.attrs["notes"]),
            )
    except (
        OSError,
        KeyError,
        ValueError,
        TypeError,
        RuntimeError,
    ) as error:  # whole, and yet not what version 3 holds
        raise CaseError(
            file=path, want=WANT, hint=f"it was written by another version of drillpetsc ({error})"
        ) from None


def _arrays(group) -> dict[str, FloatArray]:
    return {name: np.array(values) for name, values in group.items()}


def _inspect(path: str | Path, data: bytes) -> None:
    """Raise CaseError unless the file is whole and of this version."""
    if data.startswith(OLD_MAGIC):
        raise CaseError(
            file=path,
            got="checkpoint version 1",
            want=f"version {VERSION}",
            hint="it was written by an older drillpetsc: finish the run with that, or start it again",
        )
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
            hint="it was written by another drillpetsc: continue the run with that, or start it again",
        )
    if hashlib.sha256(data[BLOCK:]).hexdigest().encode() != words[2]:
        raise CaseError(
            file=path,
            got="a file that was cut short or damaged (its checksum is wrong)",
            want=WANT,
            hint="take it from a copy of the run folder, or start the run again with --overwrite",
        )


# ---------------------------------------------------------------------- back into a scene
def restore(model: DrillingModel, c: Checkpoint, at: str = "--restart") -> None:
    """Put a checkpoint's state into the scene's model; raises CaseError, for the key ``at``, when it is of
    another string."""
    system = model.system
    for f in system.layout.fields:
        values = c.fields.get(f.name)
        if values is None or values.shape != (system.mesh.nodes, f.size):
            raise CaseError(
                at=at, want=f"a checkpoint of the same string ({system.mesh.nodes} nodes with {f.name})"
            )
    if not np.allclose(c.depths, model.mesh.node_depth, rtol=0, atol=1e-6):
        raise CaseError(
            at=at, want="a checkpoint of the same string", hint="its nodes are elsewhere along the string"
        )
    for f in system.layout.fields:
        system.set_field(f.name, c.fields[f.name])
        system.set_field(f.name, c.rates[f.name], "y")
    system.frames.reference[:], system.frames.second[:] = c.frames["reference"], c.frames["second"]
    system.frames.twist0[:] = c.frames["twist0"]
    system.assembly.reference[:] = system.frames.reference[system.chain.vertices]
    for component in system.components:
        component.update_reference_frames()
    if c.imperfection is not None:
        dead, place = np.zeros(system.layout.size), system.layout.dofs["string.position"]
        owned = system.chain.owned
        dead[place[owned]] = c.imperfection[system.chain.vertices[owned]]
        system.assembly.dead_load = dead
    if c.top is not None and model.top is not None:
        model.top.anchor[:] = c.top
    for component in model.components:
        if component.name in c.components:
            component.set_state(c.components[component.name])
        if component.name in c.places:
            here = {"vertex": system.chain.vertices, "cell": system.chain.cells}
            component.set_local_state(
                {on: values[here[on]] for on, values in c.places[component.name].items()}
            )


def start_clock_anew(model: DrillingModel, c: Checkpoint) -> None:
    """Time begins at 0 again with the state of ``c``: the top goes on from the place and the angle that it
    has there."""
    if model.top is None:
        return
    model.top.align(*(c.fields[f"string.{name}"][0] for name in ("position", "tangent", "spin")))
