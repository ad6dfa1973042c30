"""Datasets keep what is promised: names, dimensions, units, attributes, whatever the study."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.model import ActuatorLoad, Cylinder, ForceDrive, PrescribedDrive, ServoDrive, loads, override

pytestmark = pytest.mark.contract

SHORT = {"duration": 0.03, "step": 1e-3}

# name: dimensions, unit
ROBOT = {
    **{
        f"{point}_{what}": (("time", "axis"), "m")
        for point in ("com", "tool")
        for what in ("position_rigid", "position", "deviation")
    },
    "rotation_deviation": (("time", "axis"), "rad"),
    "deviation_by_cause": (("time", "cause", "leg", "axis"), "m"),
    "deviation_residual": (("time", "axis"), "m"),
    "platform_quaternion": (("time", "quaternion"), "1"),
    "platform_angular_velocity": (("time", "axis"), "rad s-1"),
    "leg_length_command": (("time", "leg"), "m"),
    "leg_length": (("time", "leg"), "m"),
    "actuator_force_rigid": (("time", "leg"), "N"),
    "actuator_force": (("time", "leg"), "N"),
    "tip_deflection": (("time", "leg", "direction"), "m"),
    "joint_force": (("time", "leg", "axis"), "N"),
}
ENERGIES = {
    **{
        name: (("time",), "J")
        for name in (
            "energy_kinetic", "energy_potential", "energy_strain", "energy_dissipated", "work_drive", "work_external"
        )
    },
    "closure_residual": (("time",), "m"),
}  # fmt: skip
ACTUATOR = {
    "tip_deflection": (("time",), "m"),
    "length": (("time",), "m"),
    "angle": (("time",), "rad"),
    "mode_amplitude": (("time", "mode"), "m"),
    "torque": (("time",), "N m"),
    "force": (("time",), "N"),
}
LABELS = {
    "leg": [1, 2, 3, 4, 5, 6],
    "axis": ["x", "y", "z"],
    "direction": ["a", "b"],
    "quaternion": ["w", "x", "y", "z"],
    "cause": ["axial-strain", "bending", "drive"],
}
SETTINGS = ("integrator", "fidelity", "basis", "modes", "output_step", "step")
COUNTERS = ("steps", "newton_iterations", "factorisations", "rejected_steps", "wall_time")
DRIVES = {
    "prescribed": PrescribedDrive(),
    "servo": ServoDrive(stiffness=1e8, damping=1e4),
    "force": ForceDrive(law="rigid", feedback={"stiffness": 1e8, "damping": 1e4}),
}


def check_variables(data, table):
    for name, (dims, unit) in table.items():
        assert data[name].dims == dims, name
        assert data[name].attrs["units"] == unit, name
        assert data[name].attrs["long_name"], name
        assert data[name].dtype == np.float64, name
        assert np.isfinite(data[name]).all(), name
    for name in data.data_vars:
        assert {"units", "long_name"} <= set(data[name].attrs), name
    for dim, labels in LABELS.items():
        if dim in data.dims:
            assert data[dim].values.tolist() == labels
    assert data.time.attrs["units"] == "s"


def check_attributes(data):
    assert data.attrs["flexapod_version"] == fx.__version__
    assert set(SETTINGS + COUNTERS) <= set(data.attrs)
    assert data.attrs["steps"] > 0
    assert data.attrs["newton_iterations"] >= data.attrs["steps"]
    assert data.attrs["wall_time"] > 0
    assert isinstance(data.attrs["warnings"], str)
    assert data.attrs["partial"] == 0


def same_content(a, b):
    parts = ("motion", "load", "initial", "simulation")
    whole = ("actuator",) if hasattr(a, "actuator") else ("robot",)
    return type(a) is type(b) and all(getattr(a, part) == getattr(b, part) for part in whole + parts)


def unequal(study):
    legs = tuple(
        leg.replace(
            cylinder=Cylinder(mass=2.0 + 0.2 * i, com=0.15, inertia=0.02, mouth=0.30 + 0.005 * i),
            piston=leg.piston.replace(length=0.75 + 0.005 * i),
            damping=0.001 * (i + 1),
            drive=list(DRIVES.values())[i % 3],
        )
        for i, leg in enumerate(study.robot.legs)
    )
    return study.replace(robot=study.robot.replace(legs=legs))


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("fidelity", ["rigid", "lumped", "assumed-modes"])
def test_every_promised_variable_of_a_robot(fidelity, drive):
    study = paper_robot(leg={"drive": DRIVES[drive]})
    data = fx.simulate(study, fidelity=fidelity, **SHORT)
    check_variables(data, ROBOT | ENERGIES)
    check_attributes(data)
    assert data.attrs["fidelity"] == fidelity
    assert data.time.values.tolist() == pytest.approx(np.arange(31) * 1e-3)


@pytest.mark.parametrize("driven", [False, True], ids=["prescribed", "driven"])
@pytest.mark.parametrize("fidelity", ["rigid", "assumed-modes"])
def test_every_promised_variable_of_an_actuator(fidelity, driven):
    study = fx.preset("paper-actuator")
    if driven:
        constant = {"law": "constant", "value": 2.0}
        study = study.replace(
            motion=study.motion.replace(rotation=None, extension=None),
            load=ActuatorLoad(torque=constant, force=constant),
            actuator=study.actuator.replace(hub_inertia=1.0),
        )
    data = fx.simulate_actuator(study, fidelity=fidelity, **SHORT)
    table = ACTUATOR | ENERGIES
    if fidelity == "rigid":
        table = {name: form for name, form in table.items() if name != "mode_amplitude"}
    check_variables(data, table)
    check_attributes(data)
    if driven:
        np.testing.assert_array_equal(data.torque, 2.0)
        np.testing.assert_array_equal(data.force, 2.0)


@pytest.mark.parametrize("name", ["paper-robot", "paper-robot-radii"])
def test_an_unchanged_study_keeps_its_text_word_by_word(name):
    assert fx.inverse_kinematics(fx.preset(name)).attrs["study"] == fx.model.preset_text(name)


def test_the_stored_study_gives_the_same_result_after_changes_from_python():
    study = unequal(paper_robot())
    data = fx.simulate(study, load=[10, 20, 30, 1, 2, 3], initial="straight", modes=2, axial_modes=1, **SHORT)
    again = loads(data.attrs["study"])
    # What was asked for, not what the file said.
    assert again.simulation.modes == 2
    assert again.simulation.step == 1e-3
    assert again.initial.start == "straight"
    assert again.load.wrench.value.tolist() == [10, 20, 30, 1, 2, 3]
    assert {leg.axial_modes for leg in again.robot.legs} == {1}
    expected = override(study, modes=2, axial_modes=1, **SHORT)
    assert again.robot == expected.robot
    assert again.simulation == expected.simulation
    repeated = fx.run(again)
    for variable in ("com_position", "actuator_force", "energy_dissipated"):
        np.testing.assert_array_equal(repeated[variable], data[variable])
    assert repeated.attrs["study"] == data.attrs["study"]
    assert repeated.attrs["study_hash"] == data.attrs["study_hash"]


def test_the_stored_study_of_an_actuator_gives_the_same_result():
    study = fx.preset("paper-actuator")
    data = fx.simulate_actuator(
        study.actuator, study.motion, initial=study.initial.replace(tip_displacement=2e-3), modes=2, **SHORT
    )
    again = loads(data.attrs["study"])
    assert same_content(again, again.replace(initial={"tip_displacement": 2e-3}))
    np.testing.assert_array_equal(fx.run(again).tip_deflection, data.tip_deflection)


def test_a_bare_robot_with_a_motion_is_the_study_of_both():
    study = paper_robot()
    a = fx.simulate(study.robot, study.motion, fidelity="lumped", **SHORT)
    b = fx.simulate(study, fidelity="lumped", **SHORT)
    np.testing.assert_array_equal(a.com_position, b.com_position)
    assert same_content(loads(a.attrs["study"]), loads(b.attrs["study"]))


@pytest.mark.parametrize(
    ("keywords", "found"),
    [
        ({"modes": 2}, {"modes": 2, "basis": "tip-load"}),
        ({"basis": "clamped-free"}, {"basis": "clamped-free", "modes": 3}),
        ({"axial_modes": 1}, {"axial_modes": 1}),
        ({"fidelity": "lumped"}, {"fidelity": "lumped", "modes": 0, "basis": "none", "axial_modes": 1}),
        ({"rho_inf": 0.6}, {"rho_inf": 0.6}),
        ({"output_step": 5e-3}, {"output_step": 5e-3}),
    ],
)
def test_keywords_override_the_file(keywords, found):
    data = fx.simulate(paper_robot(), **(SHORT | keywords))
    assert {name: data.attrs[name] for name in found} == found
    step = keywords.get("output_step", 1e-3)
    assert data.time.values == pytest.approx(np.arange(round(0.03 / step) + 1) * step)


def test_step_and_tolerance_take_each_others_place():
    fixed, controlled = (fx.simulate(paper_robot(), fidelity="lumped", duration=0.03, **how)
                         for how in ({"step": 2.5e-4}, {"tolerance": 1e-3}))  # fmt: skip
    assert fixed.attrs["step"] == 2.5e-4
    assert fixed.attrs["steps"] == 120
    assert "tolerance" not in fixed.attrs
    assert controlled.attrs["tolerance"] == 1e-3
    assert 0 < controlled.attrs["estimated_error"] <= 1e-3


def test_refused_keywords_are_named():
    with pytest.raises(fx.InputError, match="modes") as error:
        fx.simulate(paper_robot(), fidelity="rigid", modes=3)
    assert error.value.key == "modes"
    with pytest.raises(fx.InputError, match="motion"):
        fx.simulate(paper_robot().robot)
    with pytest.raises(fx.InputError, match="robot"):
        fx.simulate(3)
    with pytest.raises(fx.InputError, match="study"):
        fx.run(3)
    with pytest.raises(fx.InputError, match=r"robot.toml: cannot be read"):
        fx.run("robot.toml")


@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
def test_mixed_drives_and_six_unequal_legs(fidelity):
    study = unequal(paper_robot())
    data = fx.simulate(study, fidelity=fidelity, **SHORT)
    check_variables(data, ROBOT | ENERGIES)
    give = data.deviation_by_cause.sel(cause="drive")
    held = np.abs(give.sel(leg=[1, 4])).max()
    assert held < 1e-15
    assert (np.abs(give.sel(leg=[2, 3, 5, 6])).max(("time", "axis")) > 1e-9).all()
    np.testing.assert_array_equal(data.leg_stroke.sel(leg=[1, 4]), data.leg_length_command.sel(leg=[1, 4]))
    assert data.closure_residual.max() < 1e-10


def test_results_survive_the_file(tmp_path):
    data = fx.simulate(paper_robot(), **SHORT)
    found = fx.study.open_results(fx.study.save(data, tmp_path / "deep" / "results.nc"))
    assert found.attrs == data.attrs
    for name in data.variables:
        np.testing.assert_array_equal(found[name].values, data[name].values)
        assert found[name].attrs == data[name].attrs
    assert [path.name for path in (tmp_path / "deep").iterdir()] == ["results.nc"]


@pytest.mark.parametrize(("setting", "method"), [
    ({"step": 1e-3, "tolerance": None}, "generalized-alpha"), ({"step": None, "tolerance": 1e-2}, "Radau"),
])  # fmt: skip
def test_the_method_of_a_run_is_named(setting, method):
    attrs = fx.simulate(paper_robot(), fidelity="lumped", duration=0.03, **setting).attrs
    assert method in attrs["integrator"]
    assert ("rho_inf" in attrs) == (method == "generalized-alpha")  # nothing else depends on it
