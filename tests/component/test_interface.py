"""The interface of components: public methods are declared or documented, hooks keep their arguments and do no harm."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from types import SimpleNamespace

import numpy as np
import pytest

import drillpetsc.physics
from drillpetsc.fem.component import Component
from drillpetsc.physics import interfaces
from drillpetsc.solvers.time.consistent_start import ConsistentStart
from tests.helpers.component_models import SHIFT, build
from tests.helpers.tables import each_row

for found in pkgutil.walk_packages(drillpetsc.physics.__path__, "drillpetsc.physics."):
    importlib.import_module(found.name)


def all_components() -> list[type[Component]]:
    """Every component class of the package, interfaces apart."""
    classes, open_ = [], [Component]
    while open_:
        for kind in open_.pop().__subclasses__():
            open_.append(kind)
            if kind.__module__.startswith("drillpetsc.physics.") and kind.__module__ != interfaces.__name__:
                classes.append(kind)
    return sorted(set(classes), key=lambda kind: (kind.__module__, kind.__name__))


def declared(kind: type[Component]) -> set[str]:
    """Names that the base class and the interfaces above ``kind`` declare."""
    above = [base for base in kind.__mro__ if base is Component or base.__module__ == interfaces.__name__]
    return {name for base in above for name in (*vars(base), *getattr(base, "__annotations__", {}))}


@each_row("kind", all_components(), ids=lambda kind: f"{kind.__module__[19:]}.{kind.__name__}")
def test_public_methods_are_declared_or_documented(kind: type[Component]) -> None:
    """A method that no interface declares is one that only its own class has: its docstring is the one description of it."""
    for base in kind.__mro__:
        if not base.__module__.startswith("drillpetsc.physics.") or base.__module__ == interfaces.__name__:
            continue
        for name, value in vars(base).items():
            public = inspect.isfunction(value) or isinstance(value, property | classmethod | staticmethod)
            if public and not name.startswith("_") and name not in declared(kind):
                assert inspect.getdoc(getattr(base, name)), f"{base.__name__}.{name}"


@each_row("kind", all_components(), ids=lambda kind: f"{kind.__module__[19:]}.{kind.__name__}")
def test_hooks_keep_the_arguments_of_the_declaration(kind: type[Component]) -> None:
    """Who calls a hook by the interface reaches every component with the same arguments."""
    for name, value in vars(kind).items():
        base = next(
            (b for b in kind.__mro__[1:] if name in vars(b) and b.__module__.startswith("drillpetsc.")), None
        )
        if (
            name.startswith("_")
            or not inspect.isfunction(value)
            or base is None
            or not inspect.isfunction(vars(base)[name])
        ):
            continue
        here, there = (list(inspect.signature(f).parameters.values())[1:] for f in (value, vars(base)[name]))
        assert len(here) >= len(there), name
        assert all(p.default is not p.empty for p in here[len(there) :]), name


def test_every_hook_has_a_docstring() -> None:
    declared_there = (
        c for _, c in inspect.getmembers(interfaces, inspect.isclass) if c.__module__ == interfaces.__name__
    )
    for base in (Component, *declared_there):
        for name, value in vars(base).items():
            if inspect.isfunction(value) and not name.startswith("_"):
                assert inspect.getdoc(value), f"{base.__name__}.{name}"


def test_defaults_do_no_harm() -> None:
    """A component that implements nothing has no unknowns, no energy, no state."""

    class Nothing(Component):
        name = "nothing"

    nothing, state = Nothing(), None
    assert nothing.fields() == nothing.blocks(None) == nothing.prescribed() == nothing.breaks() == ()
    assert nothing.energies(0.0, state) == (0, 0, 0) and nothing.powers(0.0, state) == (0, 0)
    assert nothing.get_state() == nothing.get_local_state() == {} and nothing.regions() == {}
    assert nothing.local_update(state).shape == (0,) and not nothing.renew_reference_frames(None)
    assert (
        nothing.conservative
        and not nothing.has_contact
        and np.isclose(nothing.reaction("top.axial_reaction", state), 0.0)
    )


@each_row("kind", all_components(), ids=lambda kind: f"{kind.__module__[19:]}.{kind.__name__}")
def test_energies_and_powers_have_one_home(kind: type[Component]) -> None:
    """A class has them for one state or for several steps: a second form could differ from the first without a word."""
    for name in ("energies", "powers"):
        own = [n for n in (name, f"{name}_of") if getattr(kind, n) is not getattr(Component, n)]
        assert len(own) < 2


def test_the_second_derivative_of_the_unknowns_is_that_of_their_rates() -> None:
    """Of spin angles, too, whose rate is the spin rate without the transport of the tangent: along the motion of a bent string."""
    system = build("beam")
    asm, n = system.assembly, system.layout.size
    asm.condense(SHIFT)
    start = ConsistentStart(SimpleNamespace(system=system))  # type: ignore[arg-type]
    x, y, h = asm.x.copy(), asm.y.copy(), 1e-5
    second, rate, sides = start.second_derivative(), start.rate_of_unknowns(), []
    for step in (-h, h):
        asm.x[:n], asm.y[:n] = x[:n] + step * rate, y[:n] + step * asm.a[:n]
        sides.append(start.rate_of_unknowns())
    assert second == pytest.approx((sides[1] - sides[0]) / (2 * h), abs=1e-6 * np.abs(second).max())
