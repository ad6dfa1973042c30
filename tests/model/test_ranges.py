"""Sizes that no machine has are refused where they enter the model: one range for every dimension."""

from typing import Annotated, get_args, get_origin

import numpy as np
import pytest
from annotated_types import Ge, Le, Lt
from tests.helpers.tables import classes

from flexapod import model
from flexapod.common.errors import InputError
from flexapod.common.tables.base import Quantity
from flexapod.common.units import DIMENSIONS

pytestmark = pytest.mark.unit


def numbers():
    """Every field of the model that holds numbers: class, name, type, what bounds it."""
    for cls in classes():
        for name, info in cls.model_fields.items():
            for kind, bounds in unwrapped(info.annotation, info.metadata):
                if kind in (float, np.ndarray):
                    yield pytest.param(cls, name, kind, bounds, id=f"{cls.__name__}.{name}")


def unwrapped(annotation, metadata):
    if get_origin(annotation) is Annotated:
        inner, *more = get_args(annotation)
        return unwrapped(inner, [*metadata, *more])
    inside = [a for a in get_args(annotation) if a is not type(None)]
    if get_origin(annotation) is None or get_origin(annotation) is np.ndarray:
        return [(get_origin(annotation) or annotation, flat(metadata))]
    return [found for argument in inside for found in unwrapped(argument, metadata)]


def flat(metadata):
    return [m for item in metadata for m in (flat(item.metadata) if hasattr(item, "metadata") else [item])]


@pytest.mark.parametrize(("cls", "name", "kind", "bounds"), list(numbers()))
def test_every_number_of_the_model_has_a_range(cls, name, kind, bounds):
    measured = [b for b in bounds if isinstance(b, Quantity)]
    both_ends = any(isinstance(b, Ge) for b in bounds) and any(isinstance(b, Le | Lt) for b in bounds)
    assert measured or (kind is float and both_ends)


@pytest.mark.parametrize("name", DIMENSIONS)
def test_a_range_leaves_room_for_products(name):
    # The largest product that is formed is E d^4 over a length cubed, or the square of a norm of it. A spectrum is such
    # a square, and enters nothing but sums.
    found, power = DIMENSIONS[name], 0.5 if name.endswith("spectrum") else 1.0
    assert 1e-20 <= found.least**power < 1 < found.most**power < 1e20


@pytest.mark.parametrize("size", [1e-300, 1e-30, 1e30, 1e160, 10**400])
def test_a_size_beyond_the_range_is_refused_with_the_range(size):
    with pytest.raises(InputError, match=r"^diameter = .*Allowed|^diameter = .* valid number"):
        model.Tube(diameter=size)
    with pytest.raises(InputError, match=r"^EI = "):
        model.Piston(length=1.0, EA=1e8, EI=size, rhoA=4.5)


@pytest.mark.parametrize("size", [1e30, -1e160, 10**400])
def test_an_array_with_one_huge_number_is_refused(size):
    with pytest.raises(InputError, match=r"^com = "):
        model.Payload(mass=1.0, inertia=[1.0, 1.0, 1.0], com=[0.0, size, 0.0])


def test_what_may_be_zero_may_be_next_to_it():
    motion = model.AxisMotion(type="heave", amplitude=0.3 - 0.1 - 0.2, duration=1.0, hold=1e-17)
    assert motion.amplitude == pytest.approx(0, abs=1e-16)


@pytest.mark.parametrize("mouth", [1e160, 1e308])
def test_a_tube_is_not_computed_before_its_length_is_in_range(mouth):
    section = model.Tube(diameter=0.06, inner_diameter=0.045)
    with pytest.raises(InputError, match=r"mouth.*is out of range"):
        model.Cylinder.tube(mouth=mouth, section=section, material=model.MATERIALS["steel"])


def test_instants_of_a_table_do_not_come_as_near_as_no_time_that_is_computed_with():
    # A spline through instants 1e-300 s apart has no coefficients.
    with pytest.raises(InputError, match=r"does not increase at row 2.*at least 1e-09 s above 0 s"):
        model.CsvLaw(time=[0.0, 1e-300, 1.0], value=[0.0, 1.0, 2.0])
