"""Every sample of examples/mechanisms through the Python calls and the command line: what all mechanisms have."""

import json
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers.samples import SAMPLES, sample_study, sample_text
from typer.testing import CliRunner

import flexapod as fx
from flexapod.analysis.results.stored_run import check_run
from flexapod.analysis.results.variables import ANGLES, VARIABLES
from flexapod.analysis.store import save
from flexapod.app.cli.cli import app
from flexapod.model import chains_of, override

pytestmark = pytest.mark.contract

FIXED = {"strut"}  # platforms that are fixed
REDUNDANT = {"eight-legs"}
SHORT = {"modes": 2, "step": 1e-3, "duration": 0.02, "output_step": 1e-3}


@cache
def study(name):
    return override(sample_study(name), **SHORT)


@cache
def run(name):
    return fx.run(study(name))


@pytest.fixture(params=SAMPLES)
def name(request):
    return request.param


def test_every_sample_of_the_page_is_there():
    assert len(SAMPLES) >= 9


def test_names_sizes_and_units(name):
    data, robot = run(name), study(name).robot
    legs = len(chains_of(robot.type))
    assert data.leg.values.tolist() == list(range(1, legs + 1))
    for variable in ("drive_position", "drive_command", "drive_force", "joint_force", "leg_angle", "tip_deflection"):
        assert data.sizes["leg"] == data[variable].sizes["leg"], variable
    units = {variable: data[variable].attrs["units"] for variable in data.data_vars}
    cranks = any(leg.carriage is not None and leg.carriage.kind == "crank" for leg in robot.legs)
    assert (units["drive_position"], units["drive_force"]) == (("rad", "N m") if cranks else ("m", "N"))
    assert set(data.joint_angle.values) <= set(ANGLES)
    strokes = any(leg.strut is None for leg in robot.legs)
    assert ("leg_length" in data) == ("actuator_force" in data) == ("leg_stroke" in data) == strokes
    assert all(np.isfinite(data[variable].values).all() for variable in data.data_vars)
    assert set(map(str, data.data_vars)) <= set(VARIABLES)


def test_energy_is_balanced(name):
    """Of second order in the step: a ten-thousandth of the energies that change, or rounding of the potential's."""
    data = run(name)
    energies = [data[f"energy_{kind}"].values for kind in ("kinetic", "potential", "strain", "dissipated")]
    works = [data.work_drive.values, data.work_external.values]
    balance = sum(energies) - sum(works)
    changed = max(float(np.ptp(part)) for part in (*energies, *works))
    allowed = 5e-3 * changed + 1e-12 * max(float(np.abs(part).max()) for part in energies)
    assert float(np.ptp(balance)) < allowed


def test_legs_and_platform_stay_together(name):
    assert float(run(name).closure_residual.max()) < 1e-13


def test_causes_add_up(name):
    data = run(name)
    whole = data.deviation_by_cause.sum(("cause", "leg")) + data.deviation_residual
    np.testing.assert_allclose(whole, data.com_deviation, rtol=0, atol=1e-15)
    deviation = np.linalg.norm(data.com_deviation, axis=1).max()
    residual = np.linalg.norm(data.deviation_residual, axis=1).max()
    assert residual <= 0.02 * deviation + 1e-12  # what the first order leaves out


def test_forces_of_the_legs_carry_the_payload(name):
    """At the start, at rest: joint forces and the payload's weight cancel."""
    data, robot = run(name).isel(time=0), study(name).robot
    if robot.payload is None:
        return
    held = (
        np.abs(np.eye(3)["xyz".index({"xy": "z", "yz": "x", "zx": "y"}[robot.plane])]) if robot.plane else np.zeros(3)
    )
    total = data.joint_force.values.sum(axis=0) + robot.payload.mass * robot.gravity
    assert np.abs(total * (1 - held)).max() < 1e-7 * robot.payload.mass * 9.81


def _moments(data, end):
    return data.joint_moment.sel(end=end).values if "joint_moment" in data else np.zeros((data.sizes["leg"], 3))


def test_moments_of_the_legs_balance_the_payload(name):
    """At the start, at rest: moments about the centre of mass."""
    data, robot = run(name).isel(time=0), study(name).robot
    if robot.payload is None or robot.plane:
        return
    R = Rotation.from_quat(data.platform_quaternion.values, scalar_first=True).as_matrix()
    arms = (robot.platform_joints - robot.com) @ R.T
    total = (np.cross(arms, data.joint_force.values) + _moments(data, "platform")).sum(axis=0)
    assert np.abs(total).max() < 1e-7 * np.abs(arms).max() * robot.payload.mass * 9.81


def test_moments_at_the_base_balance_the_legs(name):
    """At the start, at rest, across each leg: straight ones, of which bending leaves a thousandth."""
    data, robot = run(name).isel(time=0), study(name).robot
    if robot.plane or study(name).initial.start != "equilibrium":
        return
    tips = data.com_position.values + (robot.platform_joints - robot.com)
    ways = tips - robot.home_bases
    lengths = np.linalg.norm(ways, axis=1)
    for i, leg in enumerate(robot.legs):
        axis, piston = ways[i] / lengths[i], leg.piston
        mass = piston.rhoA * piston.length
        weight = (leg.cylinder.mass * leg.cylinder.com + mass * (lengths[i] - piston.length / 2)) * robot.gravity
        on_platform = np.cross(ways[i], data.joint_force.values[i]) + _moments(data, "platform")[i]
        total = _moments(data, "base")[i] + np.cross(axis, weight) - on_platform
        scale = np.linalg.norm(np.cross(axis, weight)) + np.linalg.norm(on_platform) + 1e-3
        across = total - (total @ axis) * axis
        assert np.linalg.norm(across) < 5e-3 * scale, (i, across, scale)


def test_drives_follow_their_commands(name):
    data, robot = run(name), study(name).robot
    exact = [i for i, leg in enumerate(robot.legs) if leg.driven and leg.drive.type == "prescribed"]
    np.testing.assert_allclose(data.drive_position[:, exact], data.drive_command[:, exact], atol=1e-14)
    passive = [i for i, leg in enumerate(robot.legs) if not leg.driven]
    assert not data.drive_force.values[:, passive].any()


def test_held_forces_and_moments_are_there_where_joints_hold(name):
    data, robot = run(name), study(name).robot
    bears = any(set("RF") & {leg.letters.base, leg.letters.platform} or not leg.letters.platform
                or leg.letters.platform == "U" for leg in robot.legs)  # fmt: skip
    assert ("joint_moment" in data) == (bears and robot.plane is None)
    struts = any(leg.strut is not None for leg in robot.legs)
    if struts:
        assert float(np.abs(data.held_force.sel(coordinate="l")).max()) > 0


def test_results_open_again(name, tmp_path):
    path = save(run(name), tmp_path / "results.nc")
    check_run(fx.study.open_results(path), str(path))


def test_modes_and_stiffness(name):
    found = fx.modes(study(name))
    frequency = found.frequency.values
    assert (np.diff(frequency) >= -1e-9).all()
    assert frequency[0] > 1
    assert found.leg_shape.sizes["leg"] == study(name).robot.count
    assert all(found.kind.values)
    if name in FIXED:
        with pytest.raises(fx.InputError, match="no stiffness to ask for"):
            fx.stiffness(study(name))
        return
    stiffness = fx.stiffness(study(name))
    whole = stiffness.stiffness_share.sum("leg") + stiffness.stiffness_turning
    free = np.isfinite(np.diag(stiffness.stiffness))
    assert free.sum() == (3 if study(name).robot.plane else 6)
    np.testing.assert_allclose(
        stiffness.stiffness.values[np.ix_(free, free)], whole.values[np.ix_(free, free)],
        atol=1e-9 * np.abs(whole.values).max(),
    )  # fmt: skip


def test_rigid_forces_by_work(name):
    """Power of the drives is the rate of the payload's and the legs' energy: here at rest, none without motion."""
    data = fx.inverse_dynamics(study(name))
    assert np.isfinite(data.drive_force_rigid).all()
    assert ("base_force_rigid" in data) == ("joint_moment_rigid" not in data and "held_force_rigid" not in data
                                            and len(data.leg) == 6 and "leg_length_command" in data)  # fmt: skip
    if name in REDUNDANT:
        assert "open" not in data.attrs["warnings"]  # its two drives too many have forces of their own


def test_poses_from_drives(name):
    if name in FIXED:
        return
    data = fx.inverse_kinematics(study(name))
    driven = [i for i, leg in enumerate(study(name).robot.legs) if leg.driven]
    at = data.isel(time=-1)
    found = fx.forward_kinematics(study(name), at.drive_command.values[driven])
    np.testing.assert_allclose(found.com_position, at.com_position_rigid, atol=1e-9)


def test_mobility(name):
    found = fx.mobility(study(name))
    expected = {"delta": 3, "planar": 3, "tricept": 3, "tripod": 3, "strut": 0}.get(name, 6)
    assert found.mobility.item() == expected
    assert found.locked.item() == 0
    assert found.self_stress.item() == {"eight-legs": 2, "strut": 1}.get(name, 0)


@pytest.mark.parametrize("command", ["check", "modes", "run"])
def test_command_line(name, command, tmp_path):
    path = tmp_path / f"{name}.toml"
    path.write_text(study(name).source_text, encoding="utf-8")
    options = ["--out", str(tmp_path / "out"), "--no-figures"] if command == "run" else []
    result = CliRunner().invoke(app, [command, str(path), "--json", *options])
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)
    assert found["warnings" if command != "check" else "remarks"] is not None
    if command == "check":
        assert found["motions"]
        assert len(found["legs"]) == study(name).robot.count


@pytest.mark.parametrize(
    ("sample", "key", "values"),
    [
        ("delta", "leg[2].strut.diameter", '["10 mm", "11 mm"]'),
        ("tricept", "leg[4].piston.diameter", '["60 mm", "70 mm"]'),
        ("flexures", "leg.base_joint.bending", "[10, 30]"),
        ("hexaglide", "robot.base.joints[3]", "[[-0.3, 0.4, 0], [-0.31, 0.4, 0]]"),
    ],
)
def test_sweeps_over_tables_of_other_legs(sample, key, values, tmp_path):
    path, sweep = tmp_path / "robot.toml", tmp_path / "sweep.toml"
    text = sample_text(sample).split("[simulation]")[0]
    settings = "\n".join(f"{name} = {value}" for name, value in (SHORT | {"modes": 1, "duration": 0.01}).items())
    path.write_text(f"{text}[simulation]\n{settings}\n", encoding="utf-8")
    kept = 'scalars = ["com_deviation_peak", "actuator_force_peak", "first_frequency"]\nrecords = ["drive_force"]'
    sweep.write_text(f'[[vary]]\nkey = "{key}"\nvalues = {values}\n[keep]\n{kept}\n', encoding="utf-8")
    found = fx.sweep(path, sweep, workers=0)
    assert not any(found.message.values)
    assert found.sizes["leg"] == study(sample).robot.count
    frequency = found.first_frequency.values
    assert frequency[0] != frequency[1]
    np.testing.assert_allclose(np.abs(found.drive_force).max(("time", "leg")), found.actuator_force_peak)
