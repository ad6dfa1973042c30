"""The study files of `examples/mechanisms` through public calls against virtual power and dynamic stiffness."""

import numpy as np
import pytest
from tests.helpers.beam_frames import as_frame
from tests.helpers.chains import NAMED, PLANES, as_mechanism
from tests.helpers.samples import MECHANISMS, sample_study
from tests.oracles import frames, virtual_power

import flexapod as fx
from flexapod.model import PrescribedDrive

pytestmark = pytest.mark.consistency

NAMES = sorted(path.stem for path in MECHANISMS.glob("*.toml") if path.stem != "strut")  # its platform does not move
PRESETS = ("flight-simulator", "tripod-preset")


def loaded(name):
    """A sample, or a preset."""
    return fx.preset(name.removesuffix("-preset")) if name in PRESETS else sample_study(name)


def locked(robot):
    """A robot whose drives hold their places."""
    return robot.replace(legs=tuple(leg.replace(drive=PrescribedDrive()) for leg in robot.legs))


def quintic(amplitude, s, duration):
    """Value, rate, acceleration of the law at a share s of its duration."""
    law = [s**3 * (10 - 15 * s + 6 * s**2), 30 * (s * (1 - s)) ** 2, 60 * s * (1 - s) * (1 - 2 * s)]
    return amplitude * np.array(law) / duration ** np.arange(3)


@pytest.mark.parametrize("name", [*NAMES, *PRESETS])
def test_forces_and_moments_of_all_joints(name):
    study = loaded(name)
    # drives that hold their places share by least energy; constant forces: test_redundant_legs
    robot = locked(study.robot)
    motion = study.motion
    own = motion.independent or (PLANES[robot.plane] if robot.plane else tuple(NAMED))
    wrench = np.array([5.0, -3, 8, 0.3, 0.2, 0.1]) * ([1, 1, 0, 0, 0, 1] if robot.plane else [1] * 6)
    data = fx.inverse_dynamics(robot, motion, load=wrench, duration=motion.duration, output_step=motion.duration / 5)
    mechanism, found = as_mechanism(robot, own, motion.pivot), None
    seen = [0, 1] if robot.plane else [0, 1, 2]  # what acts across a plane is left open
    stretch = [leg.piston.length / leg.piston.EA for leg in robot.legs]
    for i in (1, 3):
        law = [quintic(motion.amplitudes.get(axis, 0.0), i / 5, motion.duration) for axis in own]
        found = virtual_power.follow(mechanism, *np.array(law).T, guess=found)
        other = virtual_power.forces(mechanism, found, wrench, stretch)
        at = data.isel(time=i)
        size = np.abs(other.tip_force).max()
        # Rounding times the condition of the closures; 1e-13 seen.
        drive = np.nan_to_num(other.drive)  # a passive leg has none
        np.testing.assert_allclose(at["drive_force_rigid"], drive, rtol=0, atol=1e-11 * np.abs(drive).max())
        ours = at["joint_force_rigid"].values
        np.testing.assert_allclose(ours[:, seen], other.tip_force[:, seen], rtol=0, atol=1e-11 * size)
        if "joint_moment_rigid" in data and not robot.plane:
            ours = at["joint_moment_rigid"].sel(end="platform").values
            np.testing.assert_allclose(ours, other.tip_moment, rtol=0, atol=1e-11 * size)


@pytest.mark.parametrize("name", [*NAMES, *PRESETS])
def test_forces_balance_mujocos_trees(name):
    pytest.importorskip("mujoco")
    from tests.oracles.mujoco_trees import Tree

    study, share = loaded(name), 0.6
    robot, motion = study.robot, study.motion
    own = motion.independent or (PLANES[robot.plane] if robot.plane else tuple(NAMED))
    data = fx.inverse_dynamics(robot, motion, duration=motion.duration, output_step=motion.duration / 5).isel(time=3)
    tree = Tree(as_mechanism(robot, own))
    law = [quintic(motion.amplitudes.get(axis, 0.0), share, motion.duration) for axis in own]
    tree.move(*np.array(law).T)
    drive = data["drive_force_rigid"].values
    left, tips = tree.forces(None, drive)
    size = np.abs(tips).max()
    assert left < 1e-8 * max(size, np.abs(drive).max())  # the asked-for; 1e-12 seen
    seen = [0, 1] if robot.plane else [0, 1, 2]
    np.testing.assert_allclose(data["joint_force_rigid"].values[:, seen], tips[:, seen], rtol=0, atol=1e-8 * size)


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("name", [*NAMES, *PRESETS])
def test_first_frequencies(name):
    robot = loaded(name).robot
    robot = locked(robot).replace(gravity=[0, 0, 0])
    exact = frames.frequencies(*as_frame(robot), 5, digits=1e-10)
    # What polynomials of degree 8 miss of one bow is 1e-8; two of the planar robot.s first five bend its struts twice.
    found = fx.modes(robot, modes=8 if name == "planar" else 6, axial_modes=4)["frequency"].values[:5]
    np.testing.assert_allclose(found, exact, rtol=1e-6)


@pytest.mark.parametrize("name", [name for name in NAMES if name != "planar"])
def test_mobility(name):
    robot = loaded(name).robot
    found, other = fx.mobility(robot), virtual_power.mobility(as_mechanism(robot))
    assert {key: int(found[key]) for key in ("mobility", "locked", "redundant", "self_stress")} == {
        key: other[key] for key in ("mobility", "locked", "redundant", "self_stress")
    }
