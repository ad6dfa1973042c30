"""A study written as text and read again is the same study."""

import numpy as np
import pytest

from flexapod import model

pytestmark = pytest.mark.unit

ROBOT, ACTUATOR = model.preset("paper-robot"), model.preset("paper-actuator")


def content(study):
    return study.replace(source_text="x", path=None, notes=())


def driven(**fields):
    return ROBOT.robot.replace(legs=tuple(leg.replace(**fields) for leg in ROBOT.robot.legs))


def unequal():
    legs = list(ROBOT.robot.legs)
    legs[2] = legs[2].replace(
        stroke=None,
        u_axis=[0.0, 1.0, 0.5],
        piston=model.Piston(length=0.7, EA=1e8, EI=5e3, rhoA=4.0, diameter=0.03, yield_stress=1e8),
    )
    return ROBOT.robot.replace(legs=tuple(legs))


def sectioned(material):
    section = model.Rectangle(width=0.15, height=0.01)
    return ACTUATOR.replace(
        actuator=model.Actuator.from_section(
            section=section, material=material, length=3.0, free_length=1.0, tip_mass=2.0
        )
    )


STUDIES = {
    "preset": ROBOT,
    "radii": model.preset("paper-robot-radii"),
    "actuator": ACTUATOR,
    "unequal legs": ROBOT.replace(robot=unequal()),
    "servo": ROBOT.replace(robot=driven(drive=model.ServoDrive(stiffness=1e7, damping=10.0))),
    "force": ROBOT.replace(robot=driven(drive=model.ForceDrive(feedback=model.Feedback(stiffness=1e5)))),
    "combined": ROBOT.replace(motion=model.CombinedMotion(amplitudes={"roll": 0.1, "heave": 1 / 3}, duration=1.0)),
    "waypoints": ROBOT.replace(
        motion=model.WaypointMotion(
            points=(model.Waypoint(time=1.0, yaw=0.1), model.Waypoint(time=2.0)), pivot=[0, 0, 1]
        )
    ),
    "wrench": ROBOT.replace(load=model.Load(wrench=model.SineWrench(amplitude=np.arange(6.0), frequency=3.0))),
    "constant": ROBOT.replace(load=model.Load(wrench=model.ConstantWrench(value=np.arange(6.0)))),
    "settings": model.override(ROBOT, step=1e-4, modes=5, axial_modes=1, basis="clamped-free"),
    "torque": ACTUATOR.replace(
        motion=model.ActuatorMotion(
            rotation=None, extension=model.ProfileLaw(law="smooth", amplitude=1.0, duration=2.0)
        ),
        load=model.ActuatorLoad(torque=model.SineLaw(amplitude=1.0, frequency=2.0)),
    ),
    "section": sectioned(model.MATERIALS["aluminium"].replace(name="given")),
    "material by name": sectioned(model.MATERIALS["aluminium"]),
    "with another yield stress": sectioned(model.MATERIALS["aluminium"].replace(yield_stress=1e8)),
    "with another Poisson's ratio": sectioned(model.MATERIALS["aluminium"].replace(poisson=0.3, expansion=2e-5)),
    "not known where it yields": sectioned(model.MATERIALS["aluminium"].replace(name="given", yield_stress=None)),
}


@pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES)
def test_written_and_read_again(study):
    assert content(model.loads(model.to_toml(study))) == content(study)


def test_source_text_follows_every_change():
    assert ROBOT.source_text == model.preset_text("paper-robot")
    changed = model.override(ROBOT, fidelity="rigid")
    assert model.loads(changed.source_text).simulation.fidelity == "rigid"
    built = model.Study(robot=ROBOT.robot, motion=ROBOT.motion)
    assert model.loads(built.source_text).robot == ROBOT.robot


def test_tables_keep_their_file(tmp_path):
    (tmp_path / "p.csv").write_text("time [s], roll [rad]\n0, 0\n1, 0.1\n")
    (tmp_path / "f.csv").write_text(
        "time [s]," + ",".join(f"leg {i} [N]" for i in range(1, 7)) + "\n0,1,2,3,4,5,6\n1,1,2,3,4,5,6\n"
    )
    motion = model.CsvMotion(file="p.csv", time=[0.0, 1.0], pose=[[0] * 6, [0, 0, 0, 0.1, 0, 0]])
    drives = [model.ForceDrive(law="csv", file="f.csv", time=[0.0, 1.0], force=[i, i]) for i in range(1, 7)]
    legs = tuple(leg.replace(drive=drive) for leg, drive in zip(ROBOT.robot.legs, drives, strict=True))
    study = ROBOT.replace(motion=motion, robot=ROBOT.robot.replace(legs=legs))
    text = model.to_toml(study)
    assert "[[leg]]" not in text
    assert content(model.loads(text, path=tmp_path / "s.toml")) == content(study)
