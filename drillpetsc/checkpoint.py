"""Checkpoints: everything a run needs to go on, independent of the number of ranks, written atomically."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.field import FloatArray
from drillpetsc.output.atomic import replace_file
from drillpetsc.recorder import Recorder
from drillpetsc.scene import Scene

VERSION = 1


@dataclass
class Checkpoint:
    """State of a run at ``time`` [s]; fields: name -> (n_nodes, size), unknowns and rates, in depth order."""

    time: float
    step: float
    fields: dict[str, FloatArray]
    rates: dict[str, FloatArray]
    frames: dict[str, FloatArray]
    imperfection: FloatArray | None
    top: FloatArray | None
    books: FloatArray


def take(scene: Scene, recorder: Recorder, time: float, step: float) -> Checkpoint | None:
    """Collect the state on rank 0 (None elsewhere); collective."""
    model = scene.model
    books = recorder.books(time)
    names = [f.name for f in model.layout.fields]
    values = model.gather(np.hstack([model.field(n) for n in names] + [model.field(n, "y") for n in names]))
    dead = None
    if model.assembly.dead is not None:
        place = model.layout.place["string.position"]
        dead = model.gather(model.assembly.dead[place])
    if values is None:
        return None
    sizes = [f.size for f in model.layout.fields]
    parts = np.split(values, np.cumsum(sizes + sizes)[:-1], axis=1)
    fields = dict(zip(names, parts[: len(names)], strict=True))
    rates = dict(zip(names, parts[len(names) :], strict=True))
    frames = {"gauge": model.frames.gauge, "second": model.frames.second, "twist0": model.frames.twist0}
    top = scene.top.anchor if scene.top is not None else None
    return Checkpoint(time, step, fields, rates, frames, dead, top, books)


def write(path: Path, c: Checkpoint) -> None:
    """Write ``c`` to an HDF5 file, whole or not at all."""
    import h5py

    def fill(target: Path) -> None:
        with h5py.File(target, "w") as file:
            file.attrs["version"], file.attrs["time"], file.attrs["step"] = VERSION, c.time, c.step
            for group, arrays in (("fields", c.fields), ("rates", c.rates), ("frames", c.frames)):
                for name, values in arrays.items():
                    file[f"{group}/{name}"] = values
            file["books"] = c.books
            if c.imperfection is not None:
                file["imperfection"] = c.imperfection
            if c.top is not None:
                file["top"] = c.top

    replace_file(path, fill)


def read(path: Path) -> Checkpoint:
    """Read a checkpoint; raises CaseError when there is none or it is of another kind."""
    import h5py

    if not Path(path).is_file():
        raise CaseError(got=str(path), want="a run folder with a checkpoint.h5", hint="was the run stopped before its first checkpoint?")
    with h5py.File(path, "r") as file:
        if file.attrs.get("version") != VERSION:
            raise CaseError(got=f"checkpoint version {file.attrs.get('version')}", want=f"version {VERSION}", file=path)
        groups = {g: {k: np.array(v) for k, v in file[g].items()} for g in ("fields", "rates", "frames")}
        return Checkpoint(float(file.attrs["time"]), float(file.attrs["step"]), groups["fields"], groups["rates"], groups["frames"],
                          np.array(file["imperfection"]) if "imperfection" in file else None,
                          np.array(file["top"]) if "top" in file else None, np.array(file["books"]))


def restore(scene: Scene, c: Checkpoint) -> None:
    """Put a checkpoint's state into the scene's model; raises CaseError when the meshes differ."""
    model = scene.model
    for f in model.layout.fields:
        if f.name not in c.fields or len(c.fields[f.name]) != model.mesh.nodes:
            raise CaseError(at="initial.from", want=f"a checkpoint of the same string ({model.mesh.nodes} nodes with {f.name})")
        model.set_field(f.name, c.fields[f.name])
        model.set_field(f.name, c.rates[f.name], "y")
    model.frames.gauge[:], model.frames.second[:] = c.frames["gauge"], c.frames["second"]
    model.frames.twist0[:] = c.frames["twist0"]
    model.assembly.gauge[:] = model.frames.gauge[model.line.vertices]
    for room in model.rooms:
        room.refresh_gauges()
    if c.imperfection is not None:
        dead, place = np.zeros(model.layout.size), model.layout.place["string.position"]
        owned = model.line.owned
        dead[place[owned]] = c.imperfection[model.line.vertices[owned]]
        model.assembly.dead = dead
    if c.top is not None and scene.top is not None:
        scene.top.anchor[:] = c.top
