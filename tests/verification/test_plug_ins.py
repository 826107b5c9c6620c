"""Laws and components in C++ outside the program (manual: sec-plug-ins)."""

from __future__ import annotations

import re
import shutil
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest

from drillpetsc import load_case, run
from drillpetsc.analysis.commands.contract import check_jacobian, check_ranks
from drillpetsc.case.files import own_function
from drillpetsc.errors import CaseError
from drillpetsc.kernels.build import build_plug_in
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from tests.helpers.mpi import have_mpi
from tests.verification.test_own_laws import STUDY, histories, largest_difference

DOCS = Path(__file__).parents[2] / "docs"
LAW = {"kind": "compiled", "function": "weakening.cpp:weakening", "parameters": {"static": 10e3, "dynamic": 5e3, "speed": 0.02}}  # fmt: skip
PIPE = """
string: [{kind: pipe, length: 10, od: 0.127, id: 0.1086, element_length: 5}]
top: free
bottom: free
gravity: [0, 0, 10]
initial: {from: rest, inclination: 0}
time: {end: 0.5}
output: {history_every: 0.05}
components:
  - {function: "damper.py:at_depth", parameters: {at: 5.2, damping: 500}}
"""


def code(page: str, name: str, language: str) -> str:
    """The code block of a page with this name."""
    text = (DOCS / page).read_text()
    found = re.search(rf"```{{code-block}} {language}\n:name: {name}\n\n(.*?)^```", text, re.S | re.M)
    assert found is not None, name
    return found[1]


@pytest.fixture(scope="module")
def law(tmp_path_factory) -> Path:
    """The folder of the law of the page, compiled."""
    folder = tmp_path_factory.mktemp("law")
    shutil.copy(DOCS / "guide" / "plug_in" / "weakening.cpp", folder)
    build_plug_in(folder)
    return folder


@pytest.fixture(scope="module")
def component(tmp_path_factory) -> Path:
    """The folder of the component of the pages, compiled, and a case with it."""
    folder = tmp_path_factory.mktemp("component")
    (folder / "ground_damper.cpp").write_text(
        code("development/add-component.md", "add-component-kernel", "cpp")
    )
    parts = (
        code("development/add-component.md", "add-component", "python"),
        code("guide/plug-ins.md", "plug-in-component", "python"),
    )
    text = parts[0] + "\n\n" + parts[1].replace("from __future__ import annotations\n", "")
    (folder / "damper.py").write_text(text)
    (folder / "case.yaml").write_text(PIPE)
    build_plug_in(folder)
    return folder


# ---------------------------------------------------------------------- laws
def test_a_bit_law_in_c_repeats_stick_slip(law, tmp_path):
    """The same steps as with the built-in law."""
    base = load_case(STUDY).replace({"time.end": 10})
    change = {"formation.bit_law": LAW | {"function": f"{law}/weakening.cpp:weakening"}}
    one, own = histories(base, change, tmp_path)
    assert one["bit_speed [rad/s]"].max() > 15
    assert largest_difference(one, own) < 1e-6


def test_what_is_refused_of_a_compiled_law(law, tmp_path):
    base, function = load_case(STUDY), f"{law}/weakening.cpp:weakening"

    def refused(**keys) -> str:
        with pytest.raises(CaseError) as error:
            build_model(base.replace({"formation.bit_law": LAW | {"function": function} | keys}))
        return str(error.value)

    assert "all parameters of the law, and no others: static, dynamic, speed" in refused(
        parameters={"static": 1.0}
    )
    assert "parameters.arm" in refused(parameters=LAW["parameters"] | {"arm": 1.0})
    assert "the file exports weakening" in refused(function=function.replace(":weakening", ":missing"))
    assert "file.cpp:law" in refused(function=str(law))
    with pytest.raises(CaseError, match="it is exported by DP_BIT_LAW"):
        base.replace({"contact": {"friction_law": LAW | {"function": function}}})
    (tmp_path / "weakening.cpp").write_text((law / "weakening.cpp").read_text())
    message = refused(function=f"{tmp_path}/weakening.cpp:weakening")
    assert "not compiled" in message and f"python -m drillpetsc.kernels build {tmp_path}" in message


def test_a_changed_source_is_built_anew(tmp_path):
    source = (DOCS / "guide" / "plug_in" / "weakening.cpp").read_text()
    (tmp_path / "weakening.cpp").write_text(source)
    first = build_plug_in(tmp_path)
    assert build_plug_in(tmp_path) == first
    (tmp_path / "weakening.cpp").write_text(source.replace("DP_BIT_LAW", "DP_BIT_LAW") + "// changed\n")
    assert build_plug_in(tmp_path) != first
    (tmp_path / "weakening.cpp").write_text(source.replace("+ (p[STATIC]", "+ (p[STATC]"))
    with pytest.raises(RuntimeError, match="STATC"):
        build_plug_in(tmp_path)


# ---------------------------------------------------------------------- components
def test_a_component_of_a_folder_takes_part_in_a_run(component, tmp_path):
    """The pipe falls against its damper: v = (m g/c)(1 - exp(-c t/m)), and the energy balance closes within 0.2 %, as the default tolerance
    has it; without the damper's power it would miss c v^2 t, a half."""
    run(component / "case.yaml", out=tmp_path / "run", progress="silent")
    history = read_table(tmp_path / "run" / "history.csv")
    mass = 7850 * np.pi / 4 * (0.127**2 - 0.1086**2) * 10
    speed = mass * 10 / 500 * (1 - np.exp(-500 * history["time [s]"] / mass))
    assert 0.5 * mass * speed[-1] ** 2 == pytest.approx(history["kinetic_energy [J]"][-1], rel=5e-3)
    assert abs(history["energy_error [J]"][-1]) < 2e-3 * history["kinetic_energy [J]"][-1]


def test_the_component_keeps_the_contract(component):
    check_jacobian(load_case(component / "case.yaml"), ["ground_damper"])
    with pytest.raises(AssertionError, match="no component named other"):
        check_jacobian(load_case(component / "case.yaml"), ["other"])


@pytest.mark.parallel
@pytest.mark.skipif(not have_mpi(), reason="no mpirun")
def test_the_component_on_two_ranks(component):
    check_ranks(component / "case.yaml", ["mpirun", "-n", "2"])


def test_a_wrong_jacobian_is_found(component, tmp_path):
    """A kernel whose Jacobian is twice the derivative of its rows."""
    kernel = (component / "ground_damper.cpp").read_text().replace("ground_damper", "wrong_damper")
    wrong = """
inline void run_wrong(int n, const int* idx, const int* nodes, const double* par, void* ctx, const double* c, const double* spin, const double* x,
                      const double* y, const double* a, double* K) {
    dp::run_jacobian<dp::GroundDamper>(n, idx, nodes, par, ctx, c, spin, x, y, a, K);
    for (int i = 0; i < 49 * n; ++i) K[i] *= 2;
}
DP_RESIDUAL(wrong_damper, dp::GroundDamper)
DP_JACOBIAN(wrong_damper, dp::GroundDamper, run_wrong)
"""
    (tmp_path / "kernel.cpp").write_text(kernel.replace("DP_ENTRY(wrong_damper, dp::GroundDamper)", wrong))
    (tmp_path / "damper.py").write_text(
        (component / "damper.py").read_text().replace('"ground_damper"', '"wrong_damper"')
    )
    (tmp_path / "case.yaml").write_text(PIPE)
    build_plug_in(tmp_path)
    with pytest.raises(AssertionError, match="Jacobian"):
        check_jacobian(load_case(tmp_path / "case.yaml"), ["wrong_damper"])


def test_an_installed_component_is_found_by_its_name(component, monkeypatch, tmp_path):
    """Entry point of the group drillpetsc.components."""
    monkeypatch.syspath_prepend(str(component))
    point = EntryPoint("falls", "damper:at_depth", own_function.INSTALLED)
    monkeypatch.setattr(
        own_function, "entry_points", lambda group: [point] if group == own_function.INSTALLED else []
    )
    (tmp_path / "case.yaml").write_text(PIPE.replace('"damper.py:at_depth"', "falls"))
    case = load_case(tmp_path / "case.yaml")
    assert case.components[0].call.__module__ == "damper"
    sys.modules.pop("damper")


BUILDERS = [
    ("def f(site):\n    return 1 / 0\n", "ZeroDivisionError: division by zero ("),
    ("def f(site):\n    return 5\n", "returned 5"),
    ("from drillpetsc.fem.component import Component\ndef f(site):\n    return Component()\n", "a name that no other has"),
    ("from drillpetsc.fem.component import Component\nclass C(Component):\n    name = 'beam'\ndef f(site):\n    return C()\n", "a name that no other has"),
]  # fmt: skip


def test_components_need_a_string_of_ancf_elements(component):
    base = load_case(component / "case.yaml")
    with pytest.raises(CaseError, match="no components of the user"):
        build_model(base.replace({"beam": {"formulation": "quaternion"}}))


@pytest.mark.parametrize(("text", "message"), BUILDERS)
def test_a_builder_that_fails_is_refused(text, message, tmp_path):
    (tmp_path / "own.py").write_text(text)
    (tmp_path / "case.yaml").write_text(re.sub(r"- \{.*\}", '- {function: "own.py:f"}', PIPE))
    with pytest.raises(CaseError) as error:
        build_model(load_case(tmp_path / "case.yaml"))
    assert message in str(error.value) and "components[0].function" in str(error.value)
