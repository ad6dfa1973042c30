"""Motions, locked motions, redundant closures and self-stress of mechanisms that people build, and their words."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.mechanisms import LOWER, ROBOTS, THREE, built, hexapod, leg, ring, tangents

from flexapod import kinematics
from flexapod.common.errors import InputError
from flexapod.kinematics.leg_geometry import FREE, HELD, limbs
from flexapod.model.motion import AxisMotion, CombinedMotion

pytestmark = pytest.mark.unit


def loosened(legs, base=(), platform=()):
    """Hinges of some legs made crosses: the axis as given stays fixed to base or platform, a second is normal to it."""
    state, frames = legs.state.copy(), [legs.platform_frames.copy(), legs.leg_frames.copy()]
    for i in base:
        state[i, 2] = FREE
    for i in platform:
        state[i, 5:] = FREE, FREE, HELD
        for frame in frames:
            frame[i] = frame[i] @ np.array([[0.0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    return replace(legs, state=state, platform_frames=frames[0], leg_frames=frames[1])


def hinges(kind, base, top, height, base_axes, platform_axes):
    chains = [name for part in kind.split("+") for name in [part.split("-")[-1]] * int(part.split("-")[0])]
    joints = zip(chains, base_axes, platform_axes, strict=True)
    return limbs(built(kind, base, top, height, [leg(*each) for each in joints]), rigid=True)


def radial_upu():
    out = ring(1.0, THREE)
    return loosened(hinges("3-RPR", ring(0.35, THREE), ring(0.2, THREE), 0.6, out, out), range(3), range(3))


def exechon():
    base = [[0.35, 0, 0], [-0.35, 0, 0], [0, 0.35, 0]]
    top = [[0.2, 0, 0], [-0.2, 0, 0], [0, 0.2, 0]]
    x, y = np.eye(3)[:2]
    return loosened(hinges("2-RPR+1-SPR", base, top, 0.6, (x, x, None), (y, y, x)), (0, 1))


def planar_in_space(chain):
    z = [np.array([0.0, 0, 1])] * 3
    if chain == "RPR":
        return hinges("3-RPR", ring(0.35, THREE), ring(0.1, THREE + 20), 0.0, z, z)
    flat = limbs(ROBOTS["planar 3-PRR"](), rigid=True)
    spatial = hinges("3-RPR", flat.base, ring(0.08, THREE + 10.0), 0.0, z, z)
    state = spatial.state.copy()
    state[:, 0], state[:, 4] = flat.state[:, 0], HELD
    return replace(spatial, state=state, carriage="slider", carriage_axis=flat.carriage_axis)


def of(name):
    return lambda: limbs(ROBOTS[name](), rigid=True)


TABLE = {  # joint freedoms, Gruebler, rank, redundant, locked, self-stress
    "6-UPS": (of("6-UPS"), 36, 6, 6, 0, 0, 0),
    "6-PUS": (of("6-PUS"), 36, 6, 6, 0, 0, 0),
    "6-RUS": (of("6-RUS"), 36, 6, 6, 0, 0, 0),
    "6-UCU": (of("6-UCU"), 36, 6, 6, 0, 0, 0),
    "6-FPF": (of("6-FPF"), 36, 6, 6, 0, 0, 0),  # the rigid path releases welds
    "6-SPS": (of("6-SPS"), 42, 12, 12, 0, 6, 0),
    "8-UPS": (of("8-UPS"), 48, 6, 6, 0, 0, 2),
    "3-RPS": (of("3-RPS"), 15, 3, 3, 0, 0, 0),
    "3-PRS": (of("3-PRS"), 15, 3, 3, 0, 0, 0),
    "3-SPR": (of("3-SPR"), 15, 3, 3, 0, 0, 0),
    "3-UPU": (of("3-UPU"), 15, 3, 3, 0, 0, 0),
    "3-PUU": (of("3-PUU"), 15, 3, 3, 0, 0, 0),
    "3-UPS+UP": (of("3-UPS+UP"), 21, 3, 3, 0, 0, 0),
    "3-UPU radial": (radial_upu, 15, 3, 5, 2, 2, 2),
    "Exechon": (exechon, 13, 1, 3, 2, 0, 2),
    "3-RPR in space": (lambda: planar_in_space("RPR"), 9, -3, 3, 6, 0, 6),
    "3-PRR in space": (lambda: planar_in_space("PRR"), 9, -3, 3, 6, 0, 6),
    "similar hexagons": (lambda: limbs(hexapod("UPS", LOWER, LOWER), rigid=True), 36, 6, 6, 0, 3, 3),
    "1-UPS fixed": (of("1-UPS"), 6, 0, 0, 0, 0, 1),
    "planar 3-RPR": (of("planar 3-RPR"), 18, 3, 3, 0, 0, 0),  # the plane holds the platform, joints are balls
}
INSTANTANEOUS = {"3-UPU radial": 3}  # motions next to home, where they are fewer
HELD_NEXT = {"3-UPU radial": 0, "similar hexagons": 1}  # similar hexagons stay loose while parallel: yaw alone


@pytest.mark.parametrize("name", TABLE)
def test_table_of_mobility(name):
    make, *expected = TABLE[name]
    legs = make()
    found = kinematics.mobility(legs)
    counts = [found.freedoms, found.gruebler, found.mobility, found.redundant, found.locked, found.self_stress]
    assert counts == expected
    next_to = kinematics.displaced(legs)
    assert len(next_to) == 2
    for posture in next_to:
        near = kinematics.mobility(legs, posture)
        assert near.mobility == INSTANTANEOUS.get(name, expected[2])
        assert near.locked == HELD_NEXT.get(name, expected[4])


WORDS = {
    "6-UPS": "6 motions: surge, sway, heave, roll, pitch, yaw",
    "3-RPS": "3 motions: heave, roll, pitch",
    "3-UPU": "3 motions: surge, sway, heave",
    "3-UPS+UP": "3 motions: move along z, turn about base x, turn about base y",
    "planar 3-RPR": "3 motions: surge, sway, yaw",
    "1-UPS": "no motion",
}


@pytest.mark.parametrize("name", WORDS)
def test_motions_have_names(name):
    assert kinematics.mobility_words(limbs(ROBOTS[name](), rigid=True))[0] == WORDS[name]


def test_what_else_is_worth_saying():
    assert "two drives more than motions: forces are shared by stiffness" in kinematics.mobility_words(
        TABLE["8-UPS"][0]()
    )
    loose = kinematics.mobility_words(radial_upu())
    assert "next to home it has 3 motions only" in loose
    assert any(s.startswith("with all drives locked it still has 2 motions: ") for s in loose)
    assert any(s.endswith(": singular at home") for s in loose)
    assert any("legs 1, 2, 3, 4, 5 and 6 can turn about" in s for s in kinematics.mobility_words(TABLE["6-SPS"][0]()))
    assert any(s.startswith("over-constrained: 2 conditions") for s in kinematics.mobility_words(exechon()))


def test_a_robot_that_its_drives_do_not_hold_is_refused():
    kinematics.refuse_loose(TABLE["3-RPS"][0]())
    with pytest.raises(InputError, match="with all drives locked it still has 2 motions"):
        kinematics.refuse_loose(radial_upu())


@pytest.mark.parametrize(("name", "axis"), [("3-RPS", "surge"), ("3-RPS", "yaw"), ("3-UPU", "roll")])
def test_a_motion_that_the_robot_does_not_have_is_refused(name, axis):
    motion = AxisMotion(type=axis, amplitude=0.05, duration=1.0)
    with pytest.raises(InputError, match=f"asks for {axis} of a robot with 3 motions: "):
        kinematics.poses(ROBOTS[name](), motion, [0.0, 1.0])


def test_more_axes_than_motions_are_refused():
    motion = CombinedMotion(amplitudes={"surge": 0.01, "heave": 0.01, "roll": 0.1, "pitch": 0.1}, duration=1.0)
    with pytest.raises(InputError, match=r"motions: move along z, turn about base x, turn about base y"):
        kinematics.poses(ROBOTS["3-UPS+UP"](), motion, [0.0, 1.0])


def test_a_motion_must_not_command_what_it_leaves_to_follow():
    named = {"duration": 1.0, "independent": ["heave", "roll", "pitch"]}
    motion = CombinedMotion(amplitudes={"heave": 0.01, "yaw": 0.1}, **named)
    with pytest.raises(InputError, match="leaves yaw to follow, which the motion commands"):
        kinematics.poses(ROBOTS["3-RPS"](), motion, [0.0, 1.0])
    path = kinematics.poses(ROBOTS["3-RPS"](), CombinedMotion(amplitudes={"heave": 0.01}, **named), [0.0, 1.0])
    np.testing.assert_allclose(path.position[1], [0, 0, 0.61], atol=1e-15)


def test_coordinates_of_a_motion_are_completed():
    tricept = limbs(ROBOTS["3-UPS+UP"](), rigid=True)
    chosen = kinematics.independent_axes(tricept, np.eye(6, dtype=bool)[3], np.zeros(3))
    assert chosen[3] and chosen.sum() == 3
    named = kinematics.independent_axes(tricept, np.zeros(6, dtype=bool), np.zeros(3), ["surge", "sway", "heave"])
    assert named.tolist() == [True] * 3 + [False] * 3
    with pytest.raises(InputError, match="independently"):
        kinematics.independent_axes(tricept, np.zeros(6, dtype=bool), np.zeros(3), ["surge", "pitch", "heave"])


def test_tangential_axes_differ_from_radial_ones():
    """The same three legs UPU: axes along the circle translate, radial ones leave two turns free at home."""
    out, along = ring(1.0, THREE), tangents(THREE)
    for axes, motions in ((out, 5), (along, 3)):
        legs = hinges("3-RPR", ring(0.35, THREE), ring(0.2, THREE), 0.6, axes, axes)
        assert kinematics.mobility(loosened(legs, range(3), range(3))).mobility == motions
