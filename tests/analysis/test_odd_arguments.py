"""Arguments and options that once slipped through: ignored in silence, or met by an error not in the user's words."""

import pytest
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod import model
from flexapod.model import preset_text
from flexapod.model.study.remarks import robot_remarks

pytestmark = pytest.mark.unit


@pytest.mark.parametrize("load", ["x", [1, 2], [[1] * 6], [0, 0, float("nan"), 0, 0, 0]])
def test_loads_that_are_none(load):
    with pytest.raises(fx.InputError, match="numbers") as error:
        fx.simulate(paper_robot(), load=load)
    assert error.value.key == "load"


@pytest.mark.parametrize(
    ("pose", "words", "key"),
    [
        ("roll", "is not an axis with its value", "pose"),
        ({"roll": "20 mm"}, "mm does not measure one", "pose.roll"),
        (5.0, "is not a pose", "pose"),
        ([0] * 5, "is not a pose", "pose"),
    ],
)
def test_poses_that_are_none(pose, words, key):
    with pytest.raises(fx.InputError, match=words) as error:
        fx.modes(paper_robot(), pose)
    assert error.value.key == key


@pytest.mark.parametrize("basis", ["segments", "hermite"])
def test_bases_of_a_fidelity_are_refused_by_name_from_python_too(basis):
    with pytest.raises(fx.InputError, match="is the basis of a fidelity"):
        fx.simulate(paper_robot(), basis=basis)


def test_a_tolerance_of_all_is_none():
    with pytest.raises(fx.InputError, match="below 1"):
        fx.simulate(paper_robot(), tolerance=1.0)


def test_axial_shapes_that_differ_are_refused_on_reading():
    text = preset_text("paper-robot")
    begin, end = text.index("[leg]"), text.index("[motion]")
    leg = text[begin:end].replace("[leg]", "[[leg]]")
    legs = "axial_modes = 1\n".join([leg, leg * 5])
    with pytest.raises(fx.InputError, match="one number for all legs") as error:
        model.loads(text[:begin] + legs + text[end:], path="mine.toml")
    assert (error.value.file, error.value.key) == ("mine.toml", "leg.axial_modes")


def test_a_piston_of_no_material_is_told_both_ways_to_give_one():
    text = preset_text("paper-robot").replace(', material = "steel"', "")
    with pytest.raises(fx.InputError, match=r"material \(steel, .*\), or E and density") as error:
        model.loads(text)
    assert error.value.key == "leg.piston.material"


def test_the_tip_of_a_rigid_beam_cannot_be_displaced():
    data = fx.simulate_actuator(fx.preset("paper-actuator"), fidelity="rigid", duration=0.01)
    assert "initial.tip_displacement = 0.005 m has no effect on a rigid beam" in data.warnings
    assert "tip_displacement" not in fx.simulate_actuator(fx.preset("paper-actuator"), duration=0.01).warnings


def test_lengths_outside_the_stroke_are_remarked_on():
    robot = paper_robot().robot
    assert fx.forward_kinematics(robot, robot.home_lengths).warnings == ""
    assert "Leg 1 is longer than its stroke allows" in fx.forward_kinematics(robot, [1.2] * 6).warnings


def test_studies_with_other_tables_have_other_hashes(tmp_path):
    """The text of a study names its tables; the hash once left out what stands in them."""
    text = preset_text("paper-robot")
    begin, end = text.index("[motion]"), text.index("[simulation]")
    found = []
    for last in (1, 2, 1):
        (tmp_path / "heave.csv").write_text(f"time [s],heave [mm]\n0,0\n2,{last}\n")
        study = model.loads(
            text[:begin] + '[motion]\ntype = "csv"\nfile = "heave.csv"\n' + text[end:], path=tmp_path / "a.toml"
        )
        found.append(fx.inverse_kinematics(study).attrs["study_hash"])
    assert found[0] == found[2] != found[1]


def test_keys_without_effect_are_told():
    text = preset_text("paper-robot")
    lumped = text.replace('"assumed-modes"', '"lumped"').replace("damping = 0.005", "axial_modes = 3\ndamping = 0.005")
    assert "leg.axial_modes has no effect with fidelity 'lumped'" in model.loads(lumped).warnings
    stiff = 'length = "750 mm", EI = 5e3, EA = 1e8, rhoA = 4.5, diameter = "27 mm", yield_stress = "300 MPa" }'
    start = text.index('diameter = "27 mm"')
    given = text[:start] + stiff + text[text.index("}", start) + 1 :]
    assert any("yield_stress has no effect" in warning for warning in model.loads(given).warnings)
    whole = text[start:].split("}")[0]
    one = '{ length = "375 mm", diameter = "27 mm", E = "200 GPa", density = 7800'
    for limits, said in (
        (("", ""), False),
        ((", yield_stress = 4e8", ""), True),
        ((", yield_stress = 4e8",) * 2, False),
    ):
        sections = ", ".join(f"{one}{limit} }}" for limit in limits)
        warnings = model.loads(text.replace(whole, f"sections = [{sections}] ")).warnings
        assert any("yield_stress of some sections has no effect: sections without: 2" in x for x in warnings) == said
    machine = preset_text("machine-hexapod")
    given = machine.replace('length = "400 mm" ', 'length = "400 mm"\nyield_stress = "400 MPa" ')
    told = [x for x in model.loads(given).warnings if x not in model.loads(machine).warnings]
    assert told == ["all legs: drive.yield_stress has no effect: stress is looked at in pistons and struts"]
    robot = fx.preset("paper-robot").robot
    heat = robot.replace(
        heat=model.Heat(base=21.0, gradient={"piston": 1.0}, expansion={"base": 1e-5, "piston": 1e-5, "platform": 1e-5})
    )
    (said,) = (line for line in robot_remarks(heat) if "expansion" in line)
    assert said.startswith("heat.expansion.platform has no effect: without heat.platform")
    for bow in (None, 1e-4):
        leg = robot.legs[0].replace(piston=robot.legs[0].piston.replace(bow=bow))
        scattered = robot.replace(legs=(leg,) * 6, tolerances=model.Tolerances(EI=0.03))
        assert any("tolerances.EI has no effect" in line for line in robot_remarks(scattered)) == (bow is None)
    heated = robot_remarks(robot.replace(heat=model.Heat(reference=25.0)))
    assert "heat has no effect: every part is as warm as heat.reference" in heated
    leg = robot.legs[0].replace(platform_joint=model.Joint(axis=[1.0, 0.0, 0.0]))
    ball = robot_remarks(robot.replace(legs=(leg, *robot.legs[1:])))
    assert "leg 1: platform_joint.axis has no effect: a joint S has none" in ball
    idle = fx.model.override(fx.preset("paper-robot"), friction="stuck").warnings
    assert "simulation.friction = 'stuck' has no effect: no joint and no drive has friction" in idle
    played = fx.preset("machine-hexapod")
    assert not [x for x in fx.model.override(played, friction="stuck").warnings if "has no effect" in x]
    played = played.replace(simulation=played.simulation.replace(play="gap"))
    assert "simulation.play = 'gap' has no effect: no joint and no drive has play" in played.warnings
    for preset in ("paper-robot", "paper-actuator"):
        study = fx.preset(preset)
        odd = study.replace(simulation=study.simulation.replace(rho_inf=0.8))
        said = "simulation.rho_inf = 0.8 is of fixed steps (simulation.step): within a tolerance compiled runs "
        assert [line for line in odd.warnings if line not in study.warnings] == [said + "do not use it"]
        fixed = odd.simulation.replace(step=1e-3, tolerance=None)
        assert odd.replace(simulation=fixed).warnings == study.warnings


def test_an_integer_beyond_all_floats_is_not_finite():
    with pytest.raises(fx.InputError, match="is not finite"):
        model.loads(preset_text("paper-robot").replace('"100 kg"', "1" + "0" * 400))


def test_figures_refuse_results_of_another_kind():
    robot = fx.simulate(paper_robot(fidelity="lumped", step=1e-3), duration=0.01)
    beam = fx.simulate_actuator(fx.preset("paper-actuator"), duration=0.01)
    for draw in (fx.plot.actuator_forces, fx.plot.leg_lengths, fx.plot.tip_deflections, fx.plot.com_path):
        with pytest.raises(fx.InputError, match="the result has no"):
            draw(beam)
    for draw in (fx.plot.actuator_response, fx.plot.actuator_modes, fx.plot.modes_3d):
        with pytest.raises(fx.InputError, match="the result has no") as error:
            draw(robot)
        assert error.value.key == draw.__name__
    with pytest.raises(fx.InputError, match="the result has no"):
        fx.plot.actuator_response({1: beam, 2: robot})
    with pytest.raises(fx.InputError, match="the result has no"):
        fx.plot.energies("results.nc")
