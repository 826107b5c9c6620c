"""What a run measures: figures after every step, rows of the history and of the probes, fields along the
string."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.fem.component import FloatArray
from drillpetsc.geometry.frames import high_side
from drillpetsc.model.drilling_model import DrillingModel, is_quasi_static
from drillpetsc.output.bending import bending_moments
from drillpetsc.output.flow_recorder import FlowRecorder
from drillpetsc.physics.beam import REPORT, Beam
from drillpetsc.physics.joints import REPORT as JOINT_REPORT
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.quaternion.ends import ConstrainedEnd

Column = tuple[str, str]
#: in a sample: hook load, surface torque, weight on bit, bit torque, bit speed, the bit's face (3), powers
#: (2), drilled, rate; probes
FIRST_PROBE = 12
#: what history.csv tells of each joint: name, unit, column of the room's report
JOINT_COLUMNS = (
    ("force", "N", "tension"),
    ("side_force", "N", "side_force"),
    ("torque", "N m", "torque"),
    ("bending_moment", "N m", "bending"),
    ("angle", "rad", "angle"),
    ("travel", "m", "travel"),
)


@dataclass(frozen=True)
class _Probe:
    depth: float
    cell: int  # number of the element from the top
    place: float  # 0..1 in the element


class Recorder:
    """Samples a scene; every rank calls it, rank 0 gets the values.

    A sample is one vector, summed over ranks: what a rank does not own is zero.  ``columns`` are those of
    history.csv.
    """

    def __init__(self, model: DrillingModel):
        self.model, self.system = model, model.system
        self.comm = self.system.comm.tompi4py()
        mesh = model.mesh
        self.flow = FlowRecorder(model.system, model.fluid) if model.fluid is not None else None
        self.probes = (
            [self._locate(depth) for depth in model.case.output.probes] if model.beam is not None else []
        )
        self.joints = mesh.joints if model.beam is not None else ()
        self._face = mesh.total_length - mesh.node_depth[-1]
        self.has_energies = not is_quasi_static(
            model.case
        )  # without inertia, work goes into motion that is not computed
        self.columns = self._columns()
        self.probe_columns: list[Column] = [("time", "s")]
        for p in self.probes:
            tag = f"{p.depth:g}"
            self.probe_columns += [(f"x_{tag}", "m"), (f"y_{tag}", "m"), (f"spin_{tag}", "rad/s")]
            if model.contact is not None:
                self.probe_columns.append((f"contact_{tag}", "N"))
        self._joints_at = FIRST_PROBE + 5 * len(self.probes)
        self._width = (
            self._joints_at
            + len(JOINT_COLUMNS) * len(self.joints)
            + (FlowRecorder.SIZE if self.flow is not None else 0)
        )
        self._samples: deque[tuple[float, FloatArray]] = deque(maxlen=3)
        self.dissipated = self.supplied = self.start_energy = 0.0
        self._powers: tuple[float, ...] = (0.0, 0.0)
        self.peak_exchange = self._before_jump = 0.0
        self.audited_error = self.gained = (
            0.0  # energy error at the last audit, and its largest value since the start [J]
        )
        self._first_energies = self.energies = np.zeros(3)
        local = {int(v): i for i, v in enumerate(self.system.chain.vertices)}
        self._last = local.get(mesh.nodes - 1, -1)
        if self._last >= 0 and not self.system.chain.owned[self._last]:
            self._last = -1
        self._cell = {int(c): i for i, c in enumerate(self.system.chain.cells)}

    def _locate(self, depth: float) -> _Probe:
        mesh = self.model.mesh
        cell = int(np.clip(np.searchsorted(mesh.lower, depth), 0, len(mesh.lower) - 1))
        if mesh.is_joint[cell]:  # in a rigid item above a joint
            return _Probe(depth, cell - 1, 1.0) if cell else _Probe(depth, 1, 0.0)
        return _Probe(depth, cell, float(np.clip((depth - mesh.upper[cell]) / mesh.length[cell], 0.0, 1.0)))

    def _columns(self) -> list[Column]:
        model = self.model
        out: list[Column] = [("time", "s")]
        if model.beam is not None and (model.top is not None or model.case.top.force is not None):
            out += [("hook_load", "N"), ("surface_torque", "N m")]
        if model.bit is not None:
            out += [("wob", "N"), ("bit_torque", "N m")]
        if model.beam is not None:
            out += [("bit_speed", "rad/s"), ("bit_depth", "m")]
        if model.bit is not None:
            out.append(("hole_depth", "m"))
        if model.drilling is not None:
            out.append(("rop", "m/s"))
        if self.flow is not None:
            out += self.flow.columns
        out += [(f"joint_{j.depth:g}_{name}", unit) for j in self.joints for name, unit, _ in JOINT_COLUMNS]
        energies: list[Column] = (
            [("kinetic_energy", "J"), ("strain_energy", "J"), ("energy_error", "J")]
            if self.has_energies
            else []
        )
        return [*out, *energies, ("step", "s"), ("newton", "-")]

    # ------------------------------------------------------------------ sampling
    def sample(self, t: float) -> FloatArray:
        """All figures at the assembly's state: reactions, bit, probes, powers; (m,), the same on all
        ranks."""
        model, system = self.model, self.system
        asm = system.assembly
        v = np.zeros(self._width)
        for f in asm.row_replacements:
            if f.owned and f.condition.vertex == 0:
                names = f.condition.names
                v[0] = (
                    -f.reaction[names.index("top.axial_reaction")] if "top.axial_reaction" in names else 0.0
                )
                v[1] = (
                    f.reaction[names.index("top.torque_reaction")] if "top.torque_reaction" in names else 0.0
                )
        if isinstance(model.top, ConstrainedEnd):
            v[0] = -model.top.reaction("top.axial_reaction", asm)
            v[1] = model.top.reaction("top.torque_reaction", asm)
        if model.drive is not None:
            v[1] += model.drive.torque(t, asm)
        if model.bit is not None:
            v[2:4] = model.bit.weight_and_torque(asm)
        if model.drilling is not None:
            v[10:12] = model.drilling.progress(asm)
        if self._last >= 0 and model.beam is not None:
            end, slope, v[4] = model.beam.section(asm, self._last)
            v[5:8] = end + self._face * slope / np.linalg.norm(slope)
        for k, p in enumerate(self.probes):
            if p.cell in self._cell:
                v[FIRST_PROBE + 5 * k : FIRST_PROBE + 5 + 5 * k] = self._probe(p)
        if self.joints:
            figures = next(
                component for component in model.components if isinstance(component, Joints)
            ).report(asm)
            chosen = figures[:, [JOINT_REPORT.index(name) for _, _, name in JOINT_COLUMNS]].ravel()
            v[self._joints_at : self._joints_at + len(chosen)] = chosen
        if self.flow is None:
            v[8:10] = self.system.own_powers(t)
        else:
            with self.flow.taken():
                v[8:10] = self.system.own_powers(t)
                v[-FlowRecorder.SIZE :] = self.flow.sample(t)
        if system.comm.size > 1:
            v = self.comm.allreduce(v)
        force = model.case.top.force
        if force is not None:
            v[0] = force.value(t)
        return v

    def _probe(self, p: _Probe) -> FloatArray:
        system, mesh, e, contact = self.system, self.model.mesh, self._cell[p.cell], self.model.contact
        asm, layout = system.assembly, system.layout
        a, b = system.chain.ends[e]
        place = layout.dofs
        assert self.model.beam is not None
        r, v, spins = map(list, zip(*(self.model.beam.section(asm, i) for i in (a, b)), strict=True))
        if "string.ratio" in place and place["string.ratio"][a, 0] >= 0:
            r[0] = r[0] + mesh.rigid_above[p.cell] * v[0] / np.linalg.norm(v[0])
            v[0] = v[0] * asm.x[place["string.ratio"][a, 0]]
        s, L = p.place, mesh.length[p.cell]
        x = (
            (1 - 3 * s**2 + 2 * s**3) * r[0]
            + L * (s - 2 * s**2 + s**3) * v[0]
            + (3 * s**2 - 2 * s**3) * r[1]
            + L * (s**3 - s**2) * v[1]
        )
        spin = (1 - s) * spins[0] + s * spins[1]
        return np.array([*x, spin, contact.normal_force(e) if contact is not None else 0.0])

    def begin(self, t: float) -> None:
        """Open the books at the present state."""
        self._samples.append((t, self.sample(t)))
        self._powers = tuple(self._samples[-1][1][8:10])
        if self.flow is not None:
            self.flow.begin(self._samples[-1][1][-FlowRecorder.SIZE :])
        self.energies = np.array(self.system.energies(t))
        self._first_energies = self.energies.copy()
        self.start_energy = float(self.energies.sum())

    def get_state(self) -> dict[str, FloatArray]:
        """What a continued run needs to keep counting; the same on all ranks."""
        sums = [
            self.dissipated,
            self.supplied,
            self.start_energy,
            self.peak_exchange,
            self._before_jump,
            self.gained,
            self.audited_error,
            *self._powers,
        ]
        samples = np.array([[t, *v] for t, v in self._samples])
        flow = self.flow.get_state() if self.flow is not None else {}
        return {
            "sums": np.array(sums),
            "first_energies": self._first_energies,
            "energies": self.energies,
            "samples": samples,
        } | flow

    def set_state(self, memory: dict[str, FloatArray]) -> None:
        """Go on from a checkpoint's memory; raises CaseError when the run that left it had other probes."""
        if memory["samples"].shape[1] != 1 + self._width:
            raise CaseError(at="output.probes", want="the probes of the run that is continued")
        sums = list(map(float, memory["sums"]))
        (
            self.dissipated,
            self.supplied,
            self.start_energy,
            self.peak_exchange,
            self._before_jump,
            self.gained,
            self.audited_error,
        ) = sums[:7]
        self._powers = tuple(sums[7:])
        self._first_energies, self.energies = np.array(memory["first_energies"]), np.array(memory["energies"])
        self._samples.extend((float(row[0]), np.array(row[1:])) for row in memory["samples"])
        if self.flow is not None:
            self.flow.set_state(memory)

    def step(
        self, t: float, dt: float, next_row: float, inputs_at: float | None = None, fresh: bool = False
    ) -> None:
        """Add up the work of an accepted step; take all its figures only when a row, due at ``next_row`` [s],
        may need them.

        inputs_at: time at which the step saw its inputs (just before a jump where it ends on one).  fresh:
        the first step of the time formula after a start.  The time integrator at most doubles a step, so the
        step before the one that passes ``next_row`` is among them.
        """
        seen = t if inputs_at is None else inputs_at
        if t + 3.0 * dt >= next_row or self.flow is not None:
            v = self.sample(seen)
            powers = float(v[8]), float(v[9])
            self._samples.append((t, v))
            if self.flow is not None:
                self.flow.step(v[-FlowRecorder.SIZE :], dt, fresh)
        else:
            powers = self.system.powers(seen)
        self.dissipated += 0.5 * dt * (self._powers[0] + powers[0])
        self.supplied += 0.5 * dt * (self._powers[1] + powers[1])
        self._powers = powers

    def audit(self, t: float) -> FloatArray:
        """Energies at the present state; keeps their largest change since the start."""
        self.energies = np.array(self.system.energies(t))
        change = np.abs((self.energies - self._first_energies)[:2]).sum()
        self.peak_exchange = max(self.peak_exchange, float(change))
        self.audited_error = self.energy_error
        self.gained = max(self.gained, self.audited_error)
        return self.energies

    def at_jump(self, t: float) -> None:
        """Note the books just before a prescribed motion changes its rate at once."""
        self.audit(t)
        self._before_jump = self.energy_error

    def add_impulse_work(self, t: float) -> None:
        """Book the work of the impulse that a jump of rate gives: what the energies gained in the steps whose
        formula reaches over it.

        Neither reaction nor rate have a value of their own at the jump, so no sum over these steps stands for
        their product.
        """
        self.audit(t)
        self.supplied += self.energy_error - self._before_jump

    @property
    def exchanged(self) -> float:
        """What an energy error is measured by [J]: the larger of work supplied and peak change of kinetic and
        strain energy, and never so little that rounding would count."""
        return max(abs(self.supplied), self.peak_exchange, 1e-9 * float(np.abs(self.energies).sum()), 1e-300)

    @property
    def energy_error(self) -> float:
        """Stored energy gained + dissipated - supplied since the start [J]: what the time integration made or
        lost."""
        return float(self.energies.sum() - self.start_energy + self.dissipated - self.supplied)

    def mass_balance(self) -> dict[str, float]:
        """Volumes of mud since the start, at the last sample (with a fluid)."""
        assert self.flow is not None
        return self.flow.balance(self._samples[-1][1][-FlowRecorder.SIZE :])

    # ------------------------------------------------------------------ rows
    def at(self, t: float) -> FloatArray:
        """Sample at an output time within the last step: motion by a parabola through three steps, forces by
        a straight line."""
        times = [q[0] for q in self._samples]
        if len(times) == 1 or t >= times[-1]:
            return self._samples[-1][1]
        (t0, v0), (t1, v1) = self._samples[-2], self._samples[-1]
        w = (t - t0) / (t1 - t0)
        out = (1 - w) * v0 + w * v1
        if len(times) == 3:
            ta, va = self._samples[0]
            second = ((v1 - v0) / (t1 - t0) - (v0 - va) / (t0 - ta)) / (t1 - ta)
            bend = (t - t0) * (t - t1) * second
            motion = [4, 5, 6, 7, 10]
            for k in range(len(self.probes)):
                motion += [FIRST_PROBE + 5 * k + i for i in range(4)]
            out[motion] += bend[motion]
        return out

    def history_row(self, t: float, step: float, newton: float) -> list[float]:
        v, model = self.at(t), self.model
        row = [t]
        names = [c[0] for c in self.columns]
        if "hook_load" in names:
            row += [v[0], v[1]]
        if model.bit is not None:
            row += [v[2], v[3]]
        if model.beam is not None:
            row += [v[4], self._depth_of(v[5:8])]
        if model.bit is not None:
            from drillpetsc.model.drilling_model import hole_depth

            row.append(hole_depth(model.case) + v[10])
        if model.drilling is not None:
            row.append(v[11])
        if self.flow is not None:
            row += self.flow.row(v[-FlowRecorder.SIZE :])
        row += v[self._joints_at : self._joints_at + len(JOINT_COLUMNS) * len(self.joints)].tolist()
        energies = [self.energies[0], self.energies[1], self.energy_error] if self.has_energies else []
        return [*row, *energies, step, newton]

    def _depth_of(self, point: FloatArray) -> float:
        if self.model.well is not None:
            return float(self.model.well.project(point[None, :]).md[0])
        return float((point - self.model.position[0]) @ self.model.tangent[0])

    def probe_row(self, t: float) -> list[float]:
        v, row = self.at(t), [t]
        for k, p in enumerate(self.probes):
            x = v[FIRST_PROBE + 5 * k : FIRST_PROBE + 3 + 5 * k]
            row += [*self.offset(x[None, :], p.depth)[0], v[FIRST_PROBE + 3 + 5 * k]]
            if self.model.contact is not None:
                row.append(v[FIRST_PROBE + 4 + 5 * k])
        return row

    def offset(self, points: FloatArray, depth: float | FloatArray) -> FloatArray:
        """(k, 2) offset of ``points`` (k, 3) from the hole's axis: towards the high side (north in a vertical
        hole), and to the right of it looking down (east); without a hole, from the straight string."""
        if self.model.well is not None:
            foot = self.model.well.project(points)
            tangent, offset = foot.tangent, foot.offset
        else:
            tangent = np.tile(self.model.tangent[0], (len(points), 1))
            d = points - self.model.position[0]
            offset = d - tangent * np.sum(d * tangent, axis=1, keepdims=True)
        out = np.empty((len(points), 2))
        for i in range(len(points)):
            x = high_side(tangent[i])
            out[i] = offset[i] @ x, offset[i] @ np.cross(tangent[i], x)
        return out

    # ------------------------------------------------------------------ fields
    def fields(self, t: float) -> tuple[FloatArray, dict[str, FloatArray]] | None:
        """Points (n, 3) [m] and point data of the deformed string in depth order, on rank 0; None
        elsewhere."""
        system, model, mesh = self.system, self.model, self.model.mesh
        asm = system.assembly
        parts: dict[str, FloatArray] = {}
        columns: dict[str, FloatArray] = {}
        if model.beam is not None:
            parts["string"] = model.beam.columns(asm)
            columns["beam"] = model.beam.report(system.layout, asm.x, asm.y)
            if self.flow is not None:
                ends = [REPORT.index("axial_upper"), REPORT.index("axial_lower")]
                columns["beam"][:, ends] += self.flow.wall_tension()
                columns["pressure"] = self.flow.pressure_force()
            if mesh.curvature.any() and isinstance(model.beam, Beam):
                first = REPORT.index("bending_upper")
                columns["beam"][:, first : first + 2] = bending_moments(model)
        if model.contact is not None:
            reports, _ = model.contact.report(asm)
            columns["contact"] = reports[:, :1] / mesh.divisor[system.chain.cells][:, None]
        if self.flow is not None:
            parts |= {name: values[:, None] for name, values in self.flow.nodal().items()}
            columns |= {name: values[:, None] for name, values in self.flow.cellwise().items()}
        node, cell = self._gathered(parts, "vertex"), self._gathered(columns, "cell")
        if node is None or cell is None:
            return None
        return self._point_data(node, cell)

    def _gathered(self, parts: dict[str, FloatArray], on: str) -> dict[str, FloatArray] | None:
        """The named columns (k, m) collected in depth order on rank 0; None elsewhere."""
        whole = self.system.gather(np.hstack(list(parts.values())), on)
        if whole is None:
            return None
        ends = np.cumsum([p.shape[1] for p in parts.values()])
        return dict(zip(parts, np.split(whole, ends[:-1], axis=1), strict=True))

    def _point_data(
        self, node: dict[str, FloatArray], cell: dict[str, FloatArray]
    ) -> tuple[FloatArray, dict[str, FloatArray]]:
        model, mesh = self.model, self.model.mesh
        element = ~mesh.is_joint

        def at_nodes(upper: FloatArray, lower: FloatArray) -> FloatArray:
            count = np.zeros(mesh.nodes)
            total = np.zeros(mesh.nodes)
            total[:-1] += upper * element
            total[1:] += lower * element
            count[:-1] += element
            count[1:] += element
            return total / np.maximum(count, 1)  # no element at all meets a rigid item between joints

        data = {
            "md [m]": mesh.node_depth,
            "outer_radius [m]": at_nodes(0.5 * mesh.outer_diameter, 0.5 * mesh.outer_diameter),
        }
        points = model.position
        if "string" in node:
            points = node["string"][:, :3]
            data |= self._string_data(node["string"], cell["beam"], at_nodes)
        if "pressure" in cell:
            data["effective_tension [N]"] = data["axial_force [N]"] + at_nodes(*cell["pressure"].T)
        if "contact" in cell:
            data["contact_force [N/m]"] = at_nodes(cell["contact"][:, 0], cell["contact"][:, 0])
        if model.well is not None:
            data["hole_radius [m]"] = model.well.project(points).radius  # where the node is now
        data |= {name: values[:, 0] for name, values in node.items() if name != "string"}
        data |= {
            name: at_nodes(values[:, 0], values[:, 0])
            for name, values in cell.items()
            if name not in ("beam", "contact", "pressure")
        }
        return points, data

    def _string_data(self, node: FloatArray, cell: FloatArray, at_nodes) -> dict[str, FloatArray]:
        model, mesh = self.model, self.model.mesh
        column = {name: i for i, name in enumerate(REPORT)}

        def from_cells(name: str, other: str | None = None) -> FloatArray:
            return at_nodes(cell[:, column[name]], cell[:, column[other or name]])

        offset = self.offset(node[:, :3], mesh.node_depth)
        data = {
            "displacement [m]": node[:, :3] - model.position,
            "velocity [m/s]": node[:, 3:6],
            "spin [rad/s]": node[:, 6],
            "spin_angle [rad]": node[:, 7],
            "offset_x [m]": offset[:, 0],
            "offset_y [m]": offset[:, 1],
            "axial_force [N]": from_cells("axial_upper", "axial_lower"),
            "torque [N m]": -from_cells("torque"),  # positive as the surface torque: the top turns the string
            "bending_moment [N m]": from_cells("bending_upper", "bending_lower"),
        }
        tube = mesh.outer_diameter > 0
        if tube.all():
            area = np.pi / 4 * (mesh.outer_diameter**2 - mesh.inner_diameter**2)
            modulus = np.pi / 32 * (mesh.outer_diameter**4 - mesh.inner_diameter**4) / mesh.outer_diameter
            stress = [
                np.abs(cell[:, column[f"axial_{e}"]]) / area + cell[:, column[f"bending_{e}"]] / modulus
                for e in ("upper", "lower")
            ]
            data["stress [Pa]"] = at_nodes(*stress)  # largest normal stress of the section, axial and bending
        return data
