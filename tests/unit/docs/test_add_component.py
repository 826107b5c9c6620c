"""The walk-through "add a component" of the manual: its code is compiled and executed (manual: sec-add-component)."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from drillpetsc import kernels
from drillpetsc.analysis.commands.check import TERMS
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.physics.beam import AncfBeam
from tests.helpers.motion import fixed, integrate
from tests.helpers.uniform_string import uniform_string

PAGE = Path(__file__).parents[3] / "docs" / "development" / "add-component.md"
LENGTH, MASS, DAMPING, GRAVITY = 10.0, 25.0, 500.0, 10.0  # [m, kg/m, N s/m, m/s2]
DOWN = np.array([0.0, 0.0, 1.0])


def code(name: str, language: str) -> str:
    """The code block of the page with this name."""
    found = re.search(
        rf"```{{code-block}} {language}\n:name: {name}\n\n(.*?)^```", PAGE.read_text(), re.S | re.M
    )
    assert found is not None, name
    return found[1]


class Libraries:
    """The kernels of the page, before those of the package."""

    def __init__(self, new: ctypes.CDLL, old: ctypes.CDLL):
        self.new, self.old = new, old

    def __getattr__(self, name: str) -> Any:
        return getattr(self.new if "ground_damper" in name else self.old, name)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of the page's kernel."""
    folder = tmp_path_factory.mktemp("damper")
    source, library = folder / "ground_damper.cpp", folder / "ground_damper.so"
    source.write_text(code("add-component-kernel", "cpp"))
    compiler = next(c for c in ("c++", "g++", "clang++") if shutil.which(c))
    include = Path(kernels.__file__).parent
    flags = ["-O1", "-std=c++17", "-fPIC", "-shared", "-march=native"]
    subprocess.run([compiler, *flags, "-I", str(include), str(source), "-o", str(library)], check=True)
    return library


@pytest.fixture
def damper(compiled: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The class of the page, on its compiled kernel."""
    both = Libraries(ctypes.CDLL(str(compiled)), kernels.library())
    monkeypatch.setattr(kernels, "library", lambda: both)
    names: dict[str, Any] = {}
    exec(compile(code("add-component", "python"), str(PAGE), "exec"), names)
    return names["GroundDamper"]


def falling(component: Any) -> DiscreteSystem:
    """A vertical pipe of two elements, at rest, with the component on its upper node."""
    section = {
        "axial_stiffness": 1e9,
        "bending_stiffness": 1e5,
        "torsional_stiffness": 1e5,
        "mass": MASS,
        "polar_inertia": 1.0,
    }
    mesh = uniform_string(LENGTH, 2, **section)
    position = np.linspace(0, LENGTH, 3)[:, None] * DOWN
    tangent = np.tile(DOWN, (3, 1))
    frames = transported_frames(tangent)
    system = DiscreteSystem(mesh, frames, [AncfBeam(mesh, frames, GRAVITY * DOWN), component])
    system.set_field("string.position", position)
    system.set_field("string.tangent", tangent)
    return system


def test_the_jacobian_is_the_derivative(damper: Any) -> None:
    asm = falling(damper(0, DAMPING)).assembly
    asm.y[: asm.layout.size] = np.random.default_rng(1).standard_normal(asm.layout.size)
    block = next(b for b in asm.bound_blocks if b.block.kernel == "ground_damper")
    rows = asm.block_rows(block, 0.0)[0]
    place = asm.layout.dofs["string.position"][0]
    assert rows[:3] == pytest.approx(DAMPING * asm.y[place]) and not rows[3:].any()
    asm.jacobian(0.0, (0.0, 1.0, 0.0), condensed=False)
    entries = asm.values[block.span].reshape(7, 7)
    assert entries == pytest.approx(DAMPING * np.diag([1, 1, 1, 0, 0, 0, 0]))


def test_a_falling_pipe_reaches_its_terminal_speed(damper: Any) -> None:
    """v = (m g/c)(1 - exp(-c t/m)) of a rigid pipe; the axial waves (2 ms) carry less than 1e-3 of it."""
    component = damper(0, DAMPING)
    system, lost = falling(component), [0.0]

    def after(t: float, dt: float) -> None:
        lost.append(lost[-1] + dt * system.powers(t).dissipated)

    integrate(system, 1.0, fixed(2e-3), after)
    m = MASS * LENGTH
    speed = system.field("string.position", "y")[:, 2].mean()
    assert speed == pytest.approx(m * GRAVITY / DAMPING * (1 - np.exp(-DAMPING * 1.0 / m)), rel=2e-3)
    assert lost[-1] > 0.5 * m * GRAVITY * system.field("string.position")[0, 2] - 0.5 * m * speed**2


def test_the_component_declares_no_hook_of_its_own(damper: Any) -> None:
    from drillpetsc.fem.component import Component

    public = {name for name in vars(damper) if not name.startswith("_")}
    assert public <= set(vars(Component))


def test_the_lines_of_model_and_check(damper: Any) -> None:
    """The line of the model builds a damper at the nearest node; the line of `check` names the component, among pairs of its kind."""
    mesh = falling(damper(0, DAMPING)).mesh
    case = SimpleNamespace(dampers=[SimpleNamespace(at=0.6 * LENGTH, damping=DAMPING)])
    names = {"GroundDamper": damper, "mesh": mesh, "case": case}
    (built,) = eval("(" + code("add-component-model", "python") + ")", names)
    assert (built.node, built.damping) == (1, DAMPING)
    (line,) = eval("(" + code("add-component-check", "python") + ")")
    assert line[0] == damper.name and {type(q) for pair in (line, *TERMS) for q in pair} == {str}
