"""Robots with flexible legs against other programs: weight in MuJoCo's pieces, welded legs as exact rods."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.chains import as_mechanism
from tests.helpers.mechanisms import ROBOTS
from tests.oracles import welded

import flexapod as fx

pytestmark = [pytest.mark.consistency, pytest.mark.usefixtures("uncompiled")]


@pytest.mark.parametrize("name", ["3-RPS", "6-PUS"])
def test_sag_and_frequencies_under_weight_are_those_of_mujoco(name):
    pytest.importorskip("mujoco")
    from tests.oracles import mujoco_beams

    robot = ROBOTS[name]()
    mechanism = as_mechanism(robot)

    def pieces(n):
        parts = []
        for chain, leg in zip(mechanism.legs, robot.legs, strict=True):
            p, mouth = leg.piston, leg.cylinder.mouth
            beam = {"EI": p.EI, "EA": p.EA, "GJ": np.inf, "rhoA": p.rhoA, "length": p.length, "mouth": mouth, "n": n}
            parts.append(mujoco_beams.with_beam(chain, **beam))
        whole = replace(mechanism, legs=tuple(chain for chain, _ in parts))
        return mujoco_beams.Flexible(whole, [stiffness for _, stiffness in parts]).frequencies(5)

    (coarse, near), (fine, nearer) = pieces(5), pieces(10)
    frequency, sag = (4 * fine - coarse) / 3, (4 * nearer - near)[:3] / 3  # of the second order in the pieces
    ours = fx.modes(robot, modes=5, axial_modes=4)
    # The platform's motions; the fourth order that is left: (1 / 5)^4 / 12 of pieces a quarter of a wave long. Weight
    # moves the frequencies of the tripod by 3e-3.
    np.testing.assert_allclose(ours["frequency"].values[:3], frequency[:3], rtol=1e-5)
    np.testing.assert_allclose(ours["frequency"].values[:5], frequency, rtol=1e-4)
    moved = ours["platform_position"].values - robot.home_position
    np.testing.assert_allclose(moved, sag, rtol=0, atol=1e-4 * np.abs(sag).max())


@pytest.mark.parametrize(("degrees", "slope"), [(1, 0.024), (2, 0.049), (4, 0.098)])
def test_welded_legs_bend_as_rods_to_the_second_order(degrees, slope):
    robot = fx.preset("paper-robot-radii").robot
    legs = tuple(leg.replace(chain="UPF") for leg in robot.legs)
    robot = robot.replace(type="6-UPF", legs=legs)
    piston, cylinder, load = legs[0].piston, legs[0].cylinder, robot.payload
    rods = welded.Robot(
        base=robot.base_joints, tips=robot.platform_joints, home=robot.home_position, com=load.com, mass=load.mass,
        mouth=cylinder.mouth, piston=piston.length, EI=piston.EI, EA=piston.EA, GJ=piston.torsional_stiffness,
        rhoA=piston.rhoA, cylinder=(cylinder.mass, cylinder.com), gravity=robot.gravity,
    )  # fmt: skip
    *_, (_, exact, _) = welded.rolled(rods, np.deg2rad([0, degrees / 2, degrees]))
    ours = fx.modes(robot, [0, 0, 0, np.deg2rad(degrees), 0, 0], modes=3)["com_sag"].values
    # What a theory of the second order leaves out is the square of the tip's slope; 0.5 of it seen.
    np.testing.assert_allclose(ours, exact, rtol=0, atol=slope**2 * np.abs(exact).max())
