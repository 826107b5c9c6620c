"""The page docs/development/add-output.md: its output exists after its code, and has the right value."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from drillpetsc import load_case, run
from drillpetsc.analysis.motion import checkpoint
from drillpetsc.fem.quantity import quantities_of
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import catalogue, read_table
from drillpetsc.physics import quantities

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "development" / "add-output.md"
TITLE = "wall_friction_power [W]"


@pytest.fixture
def extended(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    """The page's declaration, as if it stood at the end of physics/quantities.csv and physics/quantities.py."""
    row, declaration = (
        re.findall(rf"^```{kind}\n(.*?)^```$", PAGE.read_text(), re.MULTILINE | re.DOTALL)[0]
        for kind in ("text", "python")
    )
    table = tmp_path / "quantities.csv"
    table.write_text(Path(quantities.__file__).with_suffix(".csv").read_text() + row)
    monkeypatch.setattr(quantities, "quantity", quantities_of(table))
    monkeypatch.setattr(quantities, "CONTACT", quantities.CONTACT)  # the old tuple comes back after the test
    monkeypatch.setattr(quantities, "_wall_friction_power", None, raising=False)
    exec(declaration, vars(quantities))
    _forget()
    yield
    _forget()


def _forget() -> None:
    """Let the catalogue read the declarations again."""
    for known in (
        catalogue.listed_by_file,
        catalogue.outputs_by_file,
        catalogue.all_quantities,
        catalogue.find,
    ):
        known.cache_clear()


def test_the_new_column_is_the_power_of_friction(extended: None, tmp_path: Path) -> None:
    """At the end of 0.1 s, a string that lies and turns: what the components turn into heat in the restored state,
    less the damping of beam and contact; friction is nearly all of it."""
    data = load_case(ROOT / "cases" / "lying-string.yaml")
    case = data.model_copy(update={"time": data.time.model_copy(update={"end": 0.1})})
    result = run(case, tmp_path / "run", progress="silent")
    history = read_table(tmp_path / "run" / "history.csv")
    assert history["time [s]"][-1] == pytest.approx(0.1)
    model = build_model(case)
    checkpoint.restore(model, checkpoint.read(tmp_path / "run" / "checkpoint.h5"))
    state = model.system.assembly
    elements, items = model.contact.element_results(state)
    damping = model.contact.RESULTS["damping_power"]
    heat = model.contact.powers(0.1, state).dissipated - elements[:, damping].sum() - items[:, damping].sum()
    assert heat > 100.0
    assert history[TITLE][-1] == pytest.approx(heat, rel=1e-9)
    assert result.summary["final"][TITLE] == history[TITLE][-1]


def test_plots_and_catalogue_know_the_new_output(extended: None) -> None:
    found = catalogue.find("wall_friction_power")
    assert found is not None and found.title == TITLE
    names = [q.name for q in catalogue.outputs_by_file()["history.csv"]]
    assert (
        names.index("joint_NNN_travel") < names.index("wall_friction_power") < names.index("kinetic_energy")
    )
    assert catalogue.label("wall_friction_power") == "Power of wall friction"


def test_without_the_page_there_is_no_such_output() -> None:
    assert catalogue.find("wall_friction_power") is None
