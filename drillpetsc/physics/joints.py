"""Joints in the string: constraints with multipliers between the two nodes of a cell without length.

Kernel: kernels/joints/joints.hpp.  Manual: sec-joints.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.component import Component, ElementBlock, Energies, Field, Powers, VelocityStabilization
from drillpetsc.fem.quantity import Quantity
from drillpetsc.fem.string_mesh import StringJoint, StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, Table, columns
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.beam import SLOTS
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, end_frames, local_vertices
from drillpetsc.physics.tools.jar import LATCHED, Jar

_directions = function("joint_directions", "ipppp")

KINDS = columns("joint_kind").names
RESULT_NAMES = columns("joint_results").names
# multipliers are in units of this [N, N m], so that their rows and columns are of the size of a pipe's
# stiffness
SCALE = 1.0e6
STOP_ROUNDING = 1.0e-4  # length over which the force of a stop sets in [m]


class Joints(Component):
    """All joints of a string.

    Fields: ``joint.load`` (6) at the node below, force and moment of the joint in units of SCALE (manual:
    eq-joint-loads).  A stabilised joint has ``joint.correction`` (6) [m/s, rad/s] at the node above (manual:
    eq-joint-ggl).
    """

    name = "joints"
    RESULTS = RESULT_NAMES  # columns of ``element_results``

    def __init__(self, mesh: StringMesh, frames: Frames):
        self.mesh, self.frames, self.joints = mesh, frames, mesh.joints
        self._stabilised = np.array([j.stabilised for j in self.joints], dtype=bool)
        self._cells = np.array([j.cell for j in self.joints], dtype=int)
        #: jars from the top, and the numbers of their joints
        self.jars = [Jar(j.jar) for j in self.joints if j.jar is not None]
        self._jar_joints = [k for k, j in enumerate(self.joints) if j.jar is not None]
        self.has_events = bool(self.jars)
        #: number of multipliers; a stable equilibrium has exactly as many negative eigenvalues
        self.multipliers = 6 * len(self.joints) + 6 * int(self._stabilised.sum())

    def regions(self) -> dict[str, np.ndarray]:
        """Nodes with the fields of this component."""
        below, above = np.zeros(self.mesh.nodes, dtype=bool), np.zeros(self.mesh.nodes, dtype=bool)
        below[self._cells + 1] = True
        above[self._cells[self._stabilised]] = True
        return {"joint": below, "stabilised_joint": above}

    def fields(self) -> tuple[Field, ...]:
        load, correction = (
            Field(
                name,
                6,
                physics="joint",
                region=region,
                second_order=False,
                differential=False,
                multiplier=True,
            )
            for name, region in (("joint.load", "joint"), ("joint.correction", "stabilised_joint"))
        )
        return (load, correction) if self._stabilised.any() else (load,)

    # ------------------------------------------------------------------ blocks
    def _parameters(self, kernel: str, joints: list[StringJoint], cells: np.ndarray) -> FloatArray:
        strokes = [(0.0, 0.0) if j.stroke is None else j.stroke for j in joints]
        return Parameters(
            kernel,
            len(joints),
            kind=[KINDS.index(j.kind) for j in joints],
            rigid=self.mesh.rigid_above[cells],
            axes=_axes(joints),
            spring=[j.spring for j in joints],
            damper=[j.damping for j in joints],
            preload=[j.preload for j in joints],
            torsion=[j.torsion_spring for j in joints],
            stop_in=[stroke[0] for stroke in strokes],
            stop_out=[stroke[1] for stroke in strokes],
            stop_stiffness=[0.0 if j.stroke is None else j.stop_stiffness for j in joints],
            stop_rounding=[STOP_ROUNDING if j.stop_rounding is None else j.stop_rounding for j in joints],
            scale=SCALE,
            **end_frames(self.frames, cells),
        ).array

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        self._blocks: list[ElementBlock] = []
        self._chosen: list[np.ndarray] = []
        self._part = part
        place = {int(c): i for i, c in enumerate(part.cells)}
        for stabilised in (False, True):
            if not (self._stabilised == stabilised).any():
                continue
            chosen = np.array(
                [k for k, j in enumerate(self.joints) if j.stabilised == stabilised and j.cell in place],
                dtype=int,
            )
            cells = self._cells[chosen]
            slots = (*SLOTS, ("joint.load", 1), *((("joint.correction", 0),) if stabilised else ()))
            points = np.array([place[int(c)] for c in cells], dtype=np.int32)
            name, kernel = ("joints_stabilised", "joint_stabilised") if stabilised else ("joints", "joint")
            params = self._parameters(kernel, [self.joints[k] for k in chosen], cells)
            self._blocks.append(ElementBlock(name, kernel, "cell", points, slots, (0, 1), params))
            self._chosen.append(chosen)
        self._set_jar()
        loose = self.mesh.free_slope_nodes
        extra: tuple[ElementBlock, ...] = ()
        if len(loose):
            _, vertices = local_vertices(part, loose)
            extra = (
                ElementBlock(
                    "rigid_nodes",
                    "unit_slope",
                    "vertex",
                    vertices,
                    VERTEX_SLOTS,
                    (0,),
                    Parameters("unit_slope", len(vertices), stiffness=SCALE).array,
                ),
            )
        return (*self._blocks, *extra)

    def velocity_stabilization(self, part) -> VelocityStabilization | None:
        """Velocity correction of the stabilised joints, on every rank with a node above one.

        Manual: eq-joint-directions.
        """
        if not self._stabilised.any():
            return None
        local = {int(v): i for i, v in enumerate(part.vertices)}
        self._corrected = [k for k in np.flatnonzero(self._stabilised) if int(self._cells[k]) in local]
        points = np.array([local[int(self._cells[k])] for k in self._corrected], dtype=np.int32)
        self._correction_params = self._correction_rows()
        return VelocityStabilization("joint.correction", points, self._directions)

    def _directions(self, rows: IntArray, x: FloatArray) -> FloatArray:
        out = np.zeros((len(rows), 7, 6))
        _directions(len(out), pointer(rows), pointer(self._correction_params), pointer(x), pointer(out))
        return out

    def _correction_rows(self) -> FloatArray:
        nodes = self._cells[self._corrected]
        joints = [self.joints[k] for k in self._corrected]
        return Table(
            columns("joint_directions_parameters"),
            len(joints),
            kind=[KINDS.index(j.kind) for j in joints],
            reference=self.frames.reference[nodes],
            second=self.frames.second_director[nodes],
            axes=_axes(joints),
        ).array

    def update_reference_frames(self) -> None:
        for b, chosen in zip(self._blocks, self._chosen, strict=True):
            b.named.update(end_frames(self.frames, self._cells[chosen]))
        if self._stabilised.any():
            self._correction_params[:] = self._correction_rows()

    def lock(self, cell: int, locked: bool) -> None:
        """Hold all motions in the joint of a ``cell``, or let it move as its kind does."""
        for b, chosen in zip(self._blocks, self._chosen, strict=True):
            for row, k in enumerate(chosen):
                joint = self.joints[k]
                if joint.cell == cell:
                    b.named["kind"][row] = KINDS.index("fixed" if locked else joint.kind)

    # ------------------------------------------------------------------ jars
    def balance(self, state) -> str:
        return "the jar stays as it is at the start: its latch is a spring" if self.jars else ""

    def _set_jar(self) -> None:
        """Put the laws of the jars' states into the parameters of their sliders, if this rank has them."""
        self._has_jar = np.zeros(len(self.jars), dtype=bool)
        for b, chosen in zip(self._blocks, self._chosen, strict=True):
            for i, (jar, joint) in enumerate(zip(self.jars, self._jar_joints, strict=True)):
                for row in np.flatnonzero(chosen == joint):
                    self._has_jar[i] = True
                    for name, value in jar.slider().items():
                        b.named[name][row] = value

    def event_numbers(self, state) -> FloatArray:
        """(3 k,) travel [m], speed [m/s] and force [N] of each jar."""
        if not self.jars:
            return np.zeros(0)
        rows = self.element_results(state)[self._jar_joints]
        return rows[:, [RESULT_NAMES.index(name) for name in ("travel", "speed", "tension")]].ravel()

    def _passed(self, numbers: FloatArray) -> list[tuple[Jar, FloatArray]]:
        """Jars whose state has ended, with their numbers (3,)."""
        each = zip(self.jars, np.reshape(numbers, (-1, 3)), strict=True)
        return [(jar, own) for jar, own in each if jar.passed(*own)]

    def event_passed(self, numbers: FloatArray) -> bool:
        return bool(self._passed(numbers))

    def change_law(self, numbers: FloatArray) -> None:
        for jar, own in self._passed(numbers):
            jar.switch(*own)
        self._set_jar()

    def event_distance(self, passed: FloatArray, numbers: FloatArray, leader: Joints) -> float:
        ends = [jar.ends(*own) for jar, own in zip(leader.jars, np.reshape(passed, (-1, 3)), strict=True)]
        which = int(np.argmax([max(q) for q in ends]))
        own = np.reshape(numbers, (-1, 3))[which]
        return self.jars[which].ends(*own)[int(np.argmax(ends[which]))]

    def follow_law(self, leader: Joints, numbers: FloatArray) -> None:
        for jar, theirs, own in zip(self.jars, leader.jars, np.reshape(numbers, (-1, 3)), strict=True):
            jar.follow(theirs, float(own[0]))
        self._set_jar()

    def jars_beyond_latch(self, state) -> list[tuple[int, float, bool]]:
        """(item, load [N], whether it meters first) of the latched jars on this rank whose load lies beyond their latch."""
        rows = self.event_numbers(state).reshape(-1, 3)
        return [
            (jar.law.item, float(own[2]), jar.law.resistance > 0 and jar.law.metering > 0)
            for jar, here, own in zip(self.jars, self._has_jar, rows, strict=True)
            if here and jar.mode == LATCHED and jar.passed(*own)
        ]

    def get_state(self) -> dict[str, FloatArray]:
        return {"jar": np.concatenate([jar.numbers() for jar in self.jars])} if self.jars else {}

    def set_state(self, state: dict[str, FloatArray]) -> None:
        if self.jars and "jar" in state:
            for jar, numbers in zip(self.jars, np.reshape(state["jar"], (len(self.jars), -1)), strict=True):
                jar.set_numbers(numbers)
            self._set_jar()

    def jar_figures(self, state) -> FloatArray:
        """(4 k,) state, travel [m], force of the stops [N] and number of shots of each jar, zero on ranks without it."""
        rows = self.element_results(state)[self._jar_joints]
        travel, stops = (rows[:, RESULT_NAMES.index(name)] for name in ("travel", "stop"))
        modes, shots = ([getattr(jar, key) for jar in self.jars] for key in ("mode", "fired"))
        return np.asarray(
            np.column_stack([modes, travel, abs(stops), shots]) * self._has_jar[:, None]
        ).ravel()

    # ------------------------------------------------------------------ results
    def element_results(self, state) -> FloatArray:
        """(joints, 12) results of all joints, zero on ranks without the joint: the columns of
        ``RESULT_NAMES``."""
        out = np.zeros((len(self.joints), len(RESULT_NAMES)))
        for b, chosen in zip(self._blocks, self._chosen, strict=True):
            out[chosen] = state.evaluated(b, "joint_results", len(RESULT_NAMES)).table
        return out

    def energies(self, t: float, state) -> Energies:
        results = self.element_results(state)
        strain = float(results[:, RESULT_NAMES.index("stored")].sum())
        for jar, joint, here in zip(self.jars, self._jar_joints, self._has_jar, strict=True):
            if jar.brake:  # of a constant force, which does not give it back
                strain -= jar.brake * float(results[joint, RESULT_NAMES.index("travel")])
            strain += jar.at_latch if here else 0.0
        return Energies(strain=strain)

    def powers(self, t: float, state) -> Powers:
        results = self.element_results(state)
        lost = float(results[:, RESULT_NAMES.index("damping_power")].sum())
        for jar, joint in zip(self.jars, self._jar_joints, strict=True):
            if jar.brake:
                lost += jar.brake * float(results[joint, RESULT_NAMES.index("speed")])
        return Powers(dissipated=lost)

    def quantities(self) -> tuple[Quantity, ...]:
        jars = (declared.jar(number) for number in range(1, len(self.jars) + 1))
        return (*declared.JOINTS, *(q for each in jars for q in each))


def _axes(joints: list[StringJoint]) -> FloatArray:
    """(n, 9) axes of joints, row by row."""
    return np.array([np.ravel(j.axes) for j in joints]).reshape(-1, 9)
