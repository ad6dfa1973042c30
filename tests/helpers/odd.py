"""What tests of odd arguments share: a small linear system, and a refusal by its key."""

import pytest

import flexapod as fx
from flexapod import control

NAN = float("nan")


def refused(call, key):
    with pytest.raises(fx.InputError) as error:
        call()
    assert error.value.key == key


def swinging():
    """A mass on a spring with little damping: the force of a drive moves its stroke."""
    return control.StateSpace(
        A=[[0.0, 1.0], [-4.0, -0.1]], B=[[0.0], [1.0]], C=[[1.0, 0.0]], D=[[0.0]], inputs=("drive:1",),
        outputs=("stroke:1",), states=("place", "rate"), units={},
    )  # fmt: skip
