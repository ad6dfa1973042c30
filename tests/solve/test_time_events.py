"""Jumps and corners of commands and loads: found, sorted, read from tables; what is stored at a jump."""

import re
import time

import numpy as np
import pytest
from tests.helpers.runs import FIELDS, paper_robot, run_robot, with_legs

import flexapod as fx
from flexapod import kinematics
from flexapod.common.tables.csv_tables import WRENCH as COLUMNS
from flexapod.common.tables.csv_tables import read_table
from flexapod.kinematics import Breaks
from flexapod.model import (
    ActuatorMotion,
    CsvLaw,
    CsvWrench,
    ForceDrive,
    Load,
    StepWrench,
    Waypoint,
    WaypointMotion,
    override,
)
from flexapod.solve.time.time_events import Stop, Stops

pytestmark = pytest.mark.unit

WRENCH = np.array([60.0, -40.0, 30.0, 5.0, 4.0, -3.0])


def table(time, value):
    return CsvWrench(time=time, wrench=np.array(value)[:, None] * WRENCH)


def loaded(wrench, **simulation):
    study = paper_robot(**({"fidelity": "lumped", "step": 5e-4, "duration": 0.04} | simulation))
    study = study.replace(motion=study.motion.replace(amplitude=0.0))
    return study.replace(load=Load(wrench=wrench))


@pytest.mark.parametrize(
    ("wrench", "jumps", "corners"),
    [
        (None, (), ()),
        (StepWrench(amplitude=WRENCH, time=0.3), (0.3,), ()),
        (StepWrench(amplitude=WRENCH), (), ()),  # at the start, which is a start of its own
        (table([0, 1, 1, 2], [0, 0, 1, 1]), (1,), ()),
        (table([0, 0, 1], [0, 1, 0]), (), (1,)),  # comes at the start; constant after the last row
        (table([0, 1, 1, 2, 3, 4], [0, 1, 0, 1, 2, 2]), (1,), (3,)),  # no corner at 2, where it goes straight on
        (table([0, 1, 1.5, 1.5004, 1.5008, 2, 3], [0, 0, 1, 0, 1, 1, 1]), (), (1, 1.5, 1.5008)),  # 1.5004: a curve
    ],
)
def test_breaks_of_a_wrench(wrench, jumps, corners):
    assert kinematics.robot_breaks(loaded(wrench)) == Breaks(jumps=jumps, corners=corners)


def test_breaks_of_motions_and_drives():
    study = paper_robot()
    points = (Waypoint(time=1.0, heave=0.01), Waypoint(time=3.0, heave=0.0))
    for profile, jumps in (
        ("linear", (1, 3)), ("trapezoid", (0.25, 0.75, 1, 1.5, 2.5, 3)), ("quintic", ()), ("s-curve", ()),
    ):  # fmt: skip
        motion = WaypointMotion(points=points, profile=profile)
        assert kinematics.robot_breaks(study.replace(motion=motion)) == Breaks(jumps=jumps)
    drive = ForceDrive(law="csv", time=[0, 0.5, 0.5, 2], force=[1, 1, 2, 2], feedback={"stiffness": 1e6})
    assert kinematics.robot_breaks(with_legs(study, lambda leg: leg.replace(drive=drive))) == Breaks(jumps=(0.5,))


def test_breaks_of_an_actuator():
    study = fx.preset("paper-actuator")
    trapezoid = {"law": "trapezoid", "amplitude": 1.0, "duration": 2.0}
    study = study.replace(
        motion=ActuatorMotion(rotation=trapezoid, extension=None),
        load={"force": {"law": "linear", "amplitude": 1.0, "duration": 0.7}},
    )
    assert kinematics.actuator_breaks(study) == Breaks(jumps=(0.5, 1.5, 2), corners=(0.7,))


def test_stops_on_outputs_and_between_them():
    breaks = Breaks(jumps=(2e-3, 3.2e-3, 9e-3), corners=(1e-3, 3.5e-3, 3.7e-3))
    stops = Stops.from_breaks(breaks, 1e-3, 5e-4, outputs=5)
    assert stops.ends == {2: Stop(first=2e-3, last=2e-3, jumps=True)}  # a corner there needs nothing
    assert [stop.first for stop in stops.inside[3]] == [3.2e-3, 3.5e-3, 3.7e-3]
    corner = Stops.from_breaks(Breaks(corners=(3.5e-3,)), 1e-3, 5e-4, outputs=5)
    assert not corner.unaligned_stops(3, 2)  # steps of 0.5 ms end there anyway
    assert corner.unaligned_stops(3, 1)
    assert [stops.next(done, 5, 2) for done in range(5)] == [2, 2, 3, 4, 5]


def test_a_ramp_shorter_than_a_microsecond_is_a_jump():
    joined = Stops.from_breaks(Breaks(corners=(2.5e-3, 2.5005e-3)), 1e-3, None, outputs=5)
    assert joined.inside == {2: [Stop(first=2.5e-3, last=2.5005e-3, jumps=True)]}
    sudden, steep = (
        run_robot(loaded(x))
        for x in (table([0, 0.02, 0.02, 1], [0, 0, 1, 1]), table([0, 0.02, 0.02 + 1e-9, 1], [0, 0, 1, 1]))
    )
    np.testing.assert_allclose(steep["pose"], sudden["pose"], atol=1e-12)


def test_a_table_is_the_law_that_it_describes():
    law, rows = StepWrench(amplitude=WRENCH, time=0.02), table([0, 0.02, 0.02, 1], [0, 0, 1, 1])
    for t in (0.0199, 0.02, 0.03, 2.0):
        np.testing.assert_array_equal(*(kinematics.wrench(Load(wrench=x), t) for x in (law, rows)))
    one, other = (run_robot(loaded(x)) for x in (law, rows))
    for name in FIELDS:
        np.testing.assert_array_equal(one[name], other[name])
    now, later = table([0, 0, 1], [0, 1, 1]), StepWrench(amplitude=WRENCH)
    one, other = (run_robot(loaded(x)) for x in (now, later))
    np.testing.assert_array_equal(one["pose"], other["pose"])


def test_rows_that_change_nothing_change_nothing():
    """Corners that the steps meet anyway, and rows on a straight line, leave every digit as it is."""
    plain = run_robot(loaded(table([0, 0.01, 0.03, 1], [0, 0, 1, 1])))
    more = run_robot(loaded(table([0, 0.01, 0.0141, 0.03, 1], [0, 0, 0.205, 1, 1])))
    np.testing.assert_allclose(more["pose"], plain["pose"], atol=1e-15)  # 0.205 is not exact
    assert kinematics.robot_breaks(loaded(table([0, 0.01, 0.0141, 0.03, 1], [0, 0, 0.205, 1, 1]))).corners == (
        0.01,
        0.03,
    )


def test_what_is_stored_at_a_jump_is_what_follows_it():
    """As at t = 0. Forces of the joints and of the drives belong to the same instant; positions do not jump."""
    wrench = StepWrench(amplitude=[0, 0, 1000.0, 0, 0, 0], time=0.02)
    study = with_legs(loaded(wrench), lambda leg: leg.replace(damping=0.0))
    data = fx.simulate(study, fidelity="rigid").sel(time=[0.019, 0.02, 0.021], method="nearest")
    for ours in ("actuator_force", "joint_force"):
        np.testing.assert_allclose(data[ours], data[f"{ours}_rigid"], atol=1e-3)  # 1e-6 of 1000 N
    assert np.ptp(data.actuator_force[:2].values, axis=0).min() > 100
    for t in (0.02, 0.04):  # the end is an instant like others
        found = run_robot(loaded(StepWrench(amplitude=WRENCH, time=t)))
        at = np.searchsorted(found["time"], t - 1e-9)
        assert np.abs(found["v_dot"][at, -6:-3]).max() > 0.5  # 60 N on 100 kg
        assert np.abs(found["v_dot"][at - 1]).max() < 1e-5  # rounding: 1e-14 m / (h^2 / 4), some of them


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_breaks_inside_outputs_with_a_tolerance(tolerance):
    rows = table([0, 0.0123, 0.0123, 0.01251, 0.02, 0.0305, 1], [0, 0, 1, 0.5, 0.5, 0, 0])
    study = loaded(rows, step=None, tolerance=tolerance)
    found, reference = run_robot(study), run_robot(override(study, step=1e-5, output_step=1e-3))
    deviation = np.abs(reference["pose"] - reference["pose"][0]).max()
    assert np.abs(found["pose"] - reference["pose"]).max() < tolerance * deviation


def test_three_rows_at_one_instant_are_refused(tmp_path):
    with pytest.raises(fx.InputError, match="does not increase at row 4"):
        table([0, 1, 1, 1, 2], [0, 0, 1, 2, 2])
    with pytest.raises(fx.InputError, match="does not increase at row 3"):
        ForceDrive(law="csv", time=[0, 1, 0.5], force=[1, 1, 1])
    file = tmp_path / "load.csv"
    file.write_text("time [s], Fz [N]\n0, 0\n1, 0\n1, 5\n1, 6\n2, 6\n")
    with pytest.raises(fx.InputError, match="repeats the instant before once more") as error:
        read_table(file, COLUMNS, jumps=True)
    assert (error.value.file, error.value.key) == (str(file), "line 5, column 'time'")


FILES = {
    "robot.toml": ('[load]\nwrench = { law = "csv", file = "table.csv" }\n', "Fz [N]"),
    "drive.toml": ('drive = { type = "force", law = "csv", file = "table.csv", feedback = { stiffness = 1e6 } }', None),
    "actuator.toml": ('[load]\ntorque = { law = "csv", file = "table.csv" }\n', "value [N m]"),
}


@pytest.mark.parametrize("name", FILES)
def test_tables_of_study_files_may_jump(tmp_path, name):
    text, header = FILES[name]
    header = header or ", ".join(f"leg {i} [N]" for i in range(1, 7))
    rows = [f"{t}, " + ", ".join([str(value)] * (header.count(",") + 1)) for t, value in ((0, 1), (1, 1), (1, 5))]
    (tmp_path / "table.csv").write_text("\n".join([f"time [s], {header}", *rows]) + "\n")
    preset = "paper-actuator" if name == "actuator.toml" else "paper-robot"
    whole = fx.preset(preset).source_text
    if name == "drive.toml":
        whole = re.sub(r"drive = .*", text, whole)
    elif name == "actuator.toml":
        whole = re.sub(r"rotation = .*\n", "", whole) + text
    else:
        whole += text
    (tmp_path / name).write_text(whole)
    study = fx.load(tmp_path / name)
    breaks = kinematics.actuator_breaks if name == "actuator.toml" else kinematics.robot_breaks
    assert breaks(study).jumps == (1.0,)


def test_a_motion_cannot_jump():
    with pytest.raises(fx.InputError, match="does not increase at row 3") as error:
        ActuatorMotion(rotation=CsvLaw(time=[0, 1, 1, 2], value=[0, 0, 1, 1]))
    assert error.value.key == "rotation.time"


def test_outputs_without_breaks_cost_nothing():
    """Each output was looked at: a rigid actuator of 150,000 outputs took twice as long as the integration itself."""
    stops = Stops.from_breaks(Breaks(jumps=(0.5,), corners=(0.70003,)), 1e-3, None, 10**8)
    begun = time.process_time()
    assert [stops.next(done, 10**8, 1.0) for done in (0, 500, 700, 701)] == [500, 700, 701, 10**8]
    assert time.process_time() - begun < 1.0  # 10 s and more if one after the other
