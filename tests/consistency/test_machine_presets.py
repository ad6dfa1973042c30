"""Presets of machines that somebody builds: stiffness of their parts by hand, what they do beside ideal ones."""

import numpy as np

import flexapod as fx
from flexapod.study.before.describe.robot import describe
from flexapod.study.words import held


def shares(name):
    """Parts' shares in the compliance of leg 1 at home."""
    found = fx.parts(fx.preset(name).robot)
    give = 1 / found.part_stiffness.sel(leg=1)
    return dict(zip(give.part.values.tolist(), (give / give.sum()).values.tolist(), strict=True))


def test_a_leg_of_the_machine_hexapod_is_its_catalogue_in_series():
    # HIWIN, IBC, THK by hand, N and mm; the nut stands 245.75 mm from the bearing: 905.75 - 600 - 60.
    study = fx.preset("machine-hexapod")
    np.testing.assert_allclose(study.robot.home_lengths, 0.90575, atol=5e-6)
    steel = study.robot.legs[0].screw.material
    modulus, shear = steel.E / 1e6, steel.E / 1e6 / (2 * (1 + steel.poisson))
    area, polar = np.pi / 4 * 28.744**2, np.pi / 32 * 28.744**4
    shaft = modulus * area / (905.75 - 660)
    twist = shear * polar / (905.75 - 660) * (2 * np.pi / 10) ** 2
    nut = 0.8 * 1130e3 * (1540 / 3080) ** (1 / 3)
    piston = modulus * np.pi / 4 * (60**2 - 40**2) / 600
    give = 2 / 200e3 + 2 / 1000e3 + 1 / 830e3 + 1 / nut + 1 / shaft + 1 / twist + 1 / piston
    np.testing.assert_allclose(fx.parts(study.robot).leg_stiffness, 1e3 / give, rtol=1e-5)


def test_shares_of_the_machine_hexapod_are_those_of_real_machines():
    # Of ball-jointed machines: joints 40-60 %, screw, nut and bearing 20-35 %, piston 5-15 %, frame 5-20 %.
    found = shares("machine-hexapod")
    assert 0.4 < found["base_joint"] + found["platform_joint"] < 0.6
    assert 0.2 < found["screw"] + found["twist"] + found["nut"] + found["bearing"] < 0.35
    assert 0.05 < found["piston"] < 0.15
    assert 0.05 < found["base_plate"] + found["top_plate"] < 0.2


def test_what_check_says_of_the_machine_hexapod():
    study = fx.preset("machine-hexapod")
    found = describe(study)
    start = found.poses[0]
    assert held(study.robot) == "Drives locked"
    assert 40 < start.modes[0].frequency < 70  # machine-tool hexapods: 20 to 60 N/um at the tool, some 50 Hz
    assert 20e6 < start.stiffness.least < 60e6
    assert 10e-6 < start.sag < 40e-6
