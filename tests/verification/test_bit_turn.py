"""The bottom turns about the place where the bit stands (manual: eq-bit-turn)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Session, load_case
from drillpetsc.physics.bit.rock_bit import RockBit


@pytest.mark.parametrize(("bit", "stiffness"), [("205 mm", 1e8), ("212 mm", 1e9)])
def test_weight_stays_when_the_axis_of_the_end_is_renewed(bit, stiffness, monkeypatch):
    """A bit that stands beside the axis of a hole that it turns: every millimetre the axis turns by 1e-4 rad, and depth and weight stay.

    Without the term the depth changed by the offset (5 and 2 mm) times that angle: 51 and 208 N.
    """
    case = load_case(
        "cases/motor-slide.yaml", [f"string[3].od={bit}", f"bottom={{kind: bit, stiffness: {stiffness}}}"]
    )
    with Session(case) as s:
        asm = s._integrator.system.assembly
        rock = next(c for c in s._model.system.components if isinstance(c, RockBit))
        update, changes = rock.apply_update, []

        def watched(total):
            axis, weight, depth = (
                rock.hole.direction,
                float(rock.element_results(asm)[0]),
                rock.depth_of_face(asm)[0],
            )
            update(total)
            turn = np.linalg.norm(rock.hole.direction - axis)
            if turn > 0:
                changes.append(
                    (turn, float(rock.element_results(asm)[0]) - weight, rock.depth_of_face(asm)[0] - depth)
                )

        monkeypatch.setattr(rock, "apply_update", watched)
        s.step(1.5)
    turn, weight, depth = np.array(changes).T
    assert len(turn) >= 3
    assert turn.min() > 5e-5
    assert np.abs(depth).max() < 1e-11
    assert np.abs(weight).max() < 1.0
