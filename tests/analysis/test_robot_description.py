"""What `describe` says before a simulation, against closed forms and against simulations."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, with_legs
from tests.helpers.samples import sample_study

import flexapod as fx
from flexapod.analysis.description.leg_description import _stress
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.results.idealizations import soft_drives
from flexapod.model import (
    AxisMotion,
    ConstantLaw,
    ConstantWrench,
    ForceDrive,
    Load,
    RateLaw,
    ServoDrive,
    Stroke,
    Tube,
    override,
)
from flexapod.output.text.description import locked_drive_words

pytestmark = pytest.mark.unit


def rolling(duration, amplitude=0.4643, profile="quintic", hold=0.25, **settings):
    motion = AxisMotion(type="roll", amplitude=amplitude, duration=duration, hold=hold, profile=profile)
    return paper_robot(**settings).replace(motion=motion)


@pytest.fixture(scope="module")
def found():
    return describe(paper_robot())


def test_lengths_and_margins_are_those_of_the_path(found):
    study = paper_robot()
    path = fx.inverse_kinematics(study, output_step=1e-3)
    length = path.leg_length_command.values
    for i, leg in enumerate(found.legs):
        assert leg.shortest.value == pytest.approx(length[:, i].min(), abs=1e-12)
        assert leg.longest.value == pytest.approx(length[:, i].max(), abs=1e-12)
        assert leg.stroke_margin.value == pytest.approx(
            min(length[:, i].min() - 0.7, 1.05 - length[:, i].max()), abs=1e-12
        )
        assert leg.guided.value == pytest.approx(0.31518 + 0.75 - length[:, i].max(), abs=1e-12)
    assert found.legs[2].longest.time == 1.0
    assert (found.motion_end, found.duration) == (1.0, 2.0)


def test_margin_names_the_limit_that_is_nearer():
    study = paper_robot(leg={"stroke": Stroke(min=0.85, max=1.3)})
    legs = describe(study).legs
    assert legs[5].stroke_margin.value == pytest.approx(legs[5].shortest.value - 0.85)
    assert legs[5].stroke_margin.time == 1.0
    assert describe(with_legs(study, stroke=None)).legs[0].stroke_margin is None


def test_forces_are_those_of_newton_and_euler(found):
    force = fx.inverse_dynamics(paper_robot(), output_step=1e-3).actuator_force_rigid.values
    for i, leg in enumerate(found.legs):
        assert (leg.force_min.value, leg.force_max.value) == pytest.approx((force[:, i].min(), force[:, i].max()))


def test_stress_and_euler_share_of_a_resting_robot():
    # Symmetric load, no masses but the payload's: each leg bears m g / (6 cos) and does not bend.
    study = with_legs(
        paper_robot(),
        lambda leg: leg.replace(
            cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0), piston=leg.piston.replace(rhoA=1e-9)
        ),
    )
    payload = study.robot.payload.replace(com=[0, 0, 0], tool=[0, 0, 0])
    study = study.replace(
        robot=study.robot.replace(payload=payload), motion=AxisMotion(type="heave", amplitude=0.0, duration=1.0)
    )
    leg = describe(study).legs[0]
    length = study.robot.home_lengths[0]
    push = 100 * 9.81 / 6 * length / 0.9
    assert leg.force_max.value == pytest.approx(push, rel=1e-6)
    assert leg.stress.axial == pytest.approx(push / (np.pi * 0.027**2 / 4), rel=1e-6)
    assert leg.stress.bending < 1e-3 * leg.stress.axial
    assert leg.euler_share.value == pytest.approx(push / leg.euler_load, rel=1e-6)
    # Between a leg pinned at its mouth and one whose rigid part is endless.
    pinned = np.pi**2 * 200e9 * np.pi * 0.027**4 / 64 / (length - 0.31518) ** 2
    assert pinned / 4 < leg.euler_load < pinned


def test_bending_stress_is_that_of_a_simulation():
    # A quick roll; the run's own curvature (T8.10) against the estimate on the rigid path (T8.13).
    study = rolling(0.4, hold=0.0, modes=5)
    estimate = max(leg.stress.bending for leg in describe(study).legs)
    data = fx.simulate(study, step=2e-4)
    basis_curvature = _curvature(data)
    simulated = 200e9 * 0.027 / 2 * basis_curvature.max()
    # The legs vibrate on top of what the estimate knows; both see the same weight and inertia.
    assert simulated == pytest.approx(estimate, rel=0.15)


def _curvature(data):
    from flexapod.mechanics.shapes import lateral_basis

    values = lateral_basis("tip-load", 5).values(np.linspace(0, 1, 21), 2)
    free = data.leg_stroke.values - 0.31518
    bend = np.einsum("tldk,ks->tlds", data.lateral_amplitude.values, values)
    return np.linalg.norm(bend, axis=2).max(axis=-1) / free**2


def test_stiffness_is_force_over_displacement():
    study = paper_robot()
    stiffness = describe(study).poses[0].stiffness
    force = 50.0 * np.array(stiffness.softest)

    def tool(wrench):
        # The sag of the centre of mass, which is the tool here.
        return fx.modes(study, load=wrench).com_sag.values

    moved = tool([*force, 0, 0, 0]) - tool(np.zeros(6))
    along = moved @ np.array(stiffness.softest)
    # Linear up to 15 um / 1 m of geometry.
    assert 50.0 / along == pytest.approx(stiffness.least, rel=1e-3)
    assert np.linalg.norm(moved) == pytest.approx(along, rel=1e-3)  # an eigenvector: no motion across
    assert stiffness.most > stiffness.least
    assert stiffness.turning_most > stiffness.turning_least > 0


def test_frequencies_are_those_of_modes(found):
    study = paper_robot()
    for pose, place in zip(found.poses, (None, {"roll": study.motion.amplitude}), strict=True):
        data = fx.modes(study, place)
        assert [m.frequency for m in pose.modes] == pytest.approx(data.frequency.values[:6].tolist())
        assert [m.kind for m in pose.modes] == data.kind.values[:6].tolist()
        assert pose.sag == pytest.approx(float(np.linalg.norm(data.com_sag)))


@pytest.mark.parametrize(
    "study, step",
    [
        (rolling(0.25, 0.1), 2e-4),
        (rolling(0.15, 0.05, "cycloidal"), 2e-4),
        (rolling(0.25, 0.1, start="moving", profile="linear"), 5e-5),
    ],
    ids=["quintic", "cycloidal", "stop with a jump"],
)
def test_residual_vibration_is_that_of_a_simulation(study, step):
    expected = describe(study).vibration
    end = study.motion.duration
    data = fx.simulate(study, step=step)
    after = data.tool_deviation.sel(time=slice(end + 1e-3, None)).values
    simulated = np.linalg.norm(after - after.mean(axis=0), axis=1).max()
    # All modes in phase is a bound of what they make together; directions frozen over 0.1 rad cost some per cent.
    assert 0.4 * expected.amplitude < simulated < 1.1 * expected.amplitude


def test_settling_time_is_when_a_simulation_settles():
    # Servo drives damp the payload's modes strongly, so that a short run sees the end of it.
    drive = ServoDrive(stiffness=1e7, damping=1e5)
    study = with_legs(rolling(0.15, 0.02, "trapezoid", hold=1.5), drive=drive)
    expected = describe(study).vibration
    data = fx.simulate(study, step=2e-4, fidelity="lumped")
    end = data.tool_deviation.values[-1]
    off = np.linalg.norm(data.tool_deviation.values - end, axis=1)
    settled = float(data.time[np.flatnonzero(off > expected.band)[-1]]) - 0.15
    assert 0.1 < expected.settling < 1.0
    # The sum of all modes settles last.
    assert 0.5 * expected.settling < settled < 1.2 * expected.settling


def test_modes_that_a_long_motion_leaves_out_are_named():
    """Motions of more than 2.5 s were sampled too coarsely for modes of up to 2 kHz, and nobody was told."""
    # The axial modes end at 852 Hz, the next ones are above 3 kHz; 100,000 instants take 12 a period of it for 9.8 s.
    assert describe(override(rolling(9.5, 0.1), duration=9.5)).vibration.left_out is None
    frequency = fx.modes(paper_robot(), {"roll": 0.1}).frequency.values
    left_out = describe(override(rolling(40.0, 0.1), duration=40.0)).vibration.left_out
    # Ten instants a period: 250 Hz in 40 s.
    assert left_out == pytest.approx(frequency[frequency > 1e5 / 40 / 10][0], rel=1e-6)


def test_undamped_vibration_never_settles():
    study = with_legs(rolling(0.15, 0.1, "linear"), damping=0.0)
    assert describe(study).vibration.settling == np.inf


def test_remarks_on_loads():
    heavy = Load(wrench=ConstantWrench(value=[0, 0, -2.6e5, 0, 0, 0]))
    found = describe(paper_robot().replace(load=heavy))
    assert any("of the Euler load" in remark for remark in found.remarks)
    pulled = describe(paper_robot().replace(load=Load(wrench=ConstantWrench(value=[0, 0, 2.4e6, 0, 0, 0]))))
    assert any("yields: a stress of" in remark and "times its yield stress" in remark for remark in pulled.remarks)
    assert describe(paper_robot()).remarks == ()


def test_short_free_length_is_remarked_on():
    short = with_legs(paper_robot(), lambda leg: leg.replace(cylinder=leg.cylinder.replace(mouth=0.7), stroke=None))
    for fidelity, left_out in (("assumed-modes", "shear, which an Euler-Bernoulli beam"), ("solid-fem", "rotary")):
        remarks = describe(override(short, fidelity=fidelity)).remarks
        assert any("times the width of the piston" in remark and left_out in remark for remark in remarks)
        assert sum("shear" in remark for remark in remarks) == (fidelity == "assumed-modes")


def test_worst_pose_between_start_and_end_is_described_too():
    study = paper_robot()
    # There and back again: the farthest pose is in the middle.
    from flexapod.model import Waypoint, WaypointMotion

    points = (Waypoint(time=0.5, roll=0.4), Waypoint(time=1.0, roll=0.0))
    poses = describe(study.replace(motion=WaypointMotion(points=points))).poses
    assert [pose.name for pose in poses] == ["start", "end of the motion", "nearest to a singularity"]
    assert poses[2].time == pytest.approx(0.5, abs=0.01)


def test_drives_that_hold_nothing_have_no_stiffness():
    from flexapod.model import ForceDrive

    study = paper_robot(leg={"drive": ForceDrive(law="rigid")}, start="moving")
    found = describe(study)
    assert "pure force drive holds no position" in found.poses[0].problem
    assert found.poses[0].stiffness is None
    assert found.vibration is None


def test_actuator_in_a_round_trip_and_under_its_weight():
    study = fx.preset("paper-actuator")
    law = study.motion.replace(extension=RateLaw(rate=-0.1))
    beams = {b.name: b for b in describe(study.replace(motion=law)).beam}
    assert beams["at the end"].free_length == pytest.approx(0.83)
    section = study.actuator.replace(gravity=9.81, section=Tube(diameter=0.03))
    beam = describe(study.replace(actuator=section, motion=study.motion.replace(extension=RateLaw(rate=0.183)))).beam[1]
    # The published sag of the Table 2 beam at its full length.
    assert beam.free_length == pytest.approx(3.66)
    assert beam.sag == pytest.approx(1.169, abs=5e-4)
    assert beam.slenderness == pytest.approx(122)


def test_driven_actuator_has_no_path_to_describe():
    study = fx.preset("paper-actuator")
    free = study.replace(
        motion=study.motion.replace(rotation=None, extension=None),
        load=study.load.replace(torque=ConstantLaw(value=1.0), force=ConstantLaw(value=1.0)),
    )
    found = describe(free)
    assert found.driven == ("rotation", "extension")
    assert found.angles is None
    assert [beam.name for beam in found.beam] == ["at the start"]


def test_what_gives_way_is_not_called_locked():
    servo = paper_robot(leg={"drive": ServoDrive(stiffness=2e7, damping=1e3)})
    assert locked_drive_words(describe(paper_robot()).held) == "Drives locked"
    assert (
        locked_drive_words(describe(servo).held)
        == "Commands of the drives held, with the springs and dampers of the servo drives"
    )
    force = paper_robot(leg={"drive": ForceDrive()})
    assert (
        locked_drive_words(soft_drives(force.robot)) == "Drives locked"
    )  # what would have to be: no feedback holds anything


def test_a_fixed_platform_has_frequencies_and_nothing_that_moves():
    # 42.66 Hz: of this strut across its weight, `fx.modes` finds the same.
    found, study = describe(sample_study("strut")), sample_study("strut")
    assert found.singularity is None and found.vibration is None
    for pose in found.poses:
        assert pose.problem is None and pose.stiffness is None and pose.sag is None
        np.testing.assert_allclose([m.frequency for m in pose.modes], fx.modes(study).frequency[:6], rtol=1e-9)


def test_a_strip_has_stresses_by_its_thickness():
    # N / A and 6 M / (w t^2) of a section of 25 by 1.5 mm.
    study, force, moment = sample_study("planar"), 3.0, 0.02
    stress = _stress(study.robot.legs[0], np.zeros(1), np.array([force]), np.array([moment]), np.array([0.3]))
    np.testing.assert_allclose(stress.axial, force / 37.5e-6)
    np.testing.assert_allclose(stress.bending, 6 * moment / (25e-3 * 1.5e-3**2))
    assert all(leg.stress.total.value > 0 and leg.stress.yield_stress == 276e6 for leg in describe(study).legs)
