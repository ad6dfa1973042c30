"""From a plan to studies: products, short forms spelled out, draws, points that are alike."""

import numpy as np
import pytest
from tests.helpers.samples import sample_text
from tests.helpers.sweeps import KEY, diameters, quick

from flexapod.analysis.checks import resource_limits
from flexapod.common.errors import InputError
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points
from flexapod.model import loads, preset_text
from flexapod.solve.kernel import kernel

pytestmark = pytest.mark.unit


def points(**sweep):
    return Points(quick(), read_plan(sweep))


def test_product_last_fastest():
    mass = {"key": "payload.mass", "values": ["50 kg", 100]}
    found = Points(quick(), read_plan(diameters(3, more=[mass])))
    studies = [found.study(i) for i in range(len(found))]
    assert [s.robot.payload.mass for s in studies] == [50.0, 100.0] * 3
    assert [s.robot.legs[5].piston.diameter for s in studies] == pytest.approx(
        [0.025, 0.025, 0.0275, 0.0275, 0.03, 0.03]
    )


def test_together():
    found = points(vary=[{"together": {"payload.mass": [50, 100], "payload.com": [[0, 0, 0.1], [0, 0, 0.2]]}}])
    assert [(s.robot.payload.mass, s.robot.payload.com[2]) for s in map(found.study, (0, 1))] == [(50, 0.1), (100, 0.2)]


def test_one_leg_of_six_that_were_alike():
    legs = points(vary=[{"key": "leg[3].damping", "values": [0.1]}]).study(0).robot.legs
    assert [leg.damping for leg in legs] == [0.005, 0.005, 0.1, 0.005, 0.005, 0.005]


def test_all_legs_of_six_tables():
    six = points(vary=[{"key": "leg[3].damping", "values": [0.1]}]).study(0).replace(notes=())
    written = loads(six.replace(source_text="").source_text)
    legs = Points(written, read_plan({"vary": [{"key": KEY, "values": ["30 mm"]}]})).study(0).robot.legs
    assert [leg.piston.diameter for leg in legs] == [0.03] * 6
    assert [leg.damping for leg in legs][1:4] == [0.005, 0.1, 0.005]


def test_item_of_a_vector():
    assert points(vary=[{"key": "payload.com[3]", "values": ["10 mm"]}]).study(0).robot.payload.com.tolist() == [
        0, 0.373, 0.01,
    ]  # fmt: skip


def test_values_in_the_tables_of_real_parts():
    mount = 'base_mount = { stiffness = ["300 N/um", 3e8, 5e8, 3e7, 3e7, 4e7], mass = "150 kg" }'
    text = preset_text("machine-hexapod").replace("[payload]", f"{mount}\n[payload]", 1)
    text = text.replace("damping = 0.005", 'guide = { gland = "200 N/um", head = "150 N/um" }\ndamping = 0.005', 1)
    vary = {
        "leg.base_joint.friction.M0": ["0.2 N m"],
        "leg.drive.friction.torque": ["0.6 N m"],
        "leg.drive.encoder.resolution": ["0.18 deg"],
        "leg.guide.gland": ["250 N/um"],
        "robot.base_mount.stiffness[1]": ["400 N/um"],
        "robot.base_mount.loss": [0.03],
    }
    found = Points(loads(text), read_plan({"vary": [{"together": vary}]})).study(0).robot
    leg = found.legs[4]
    assert (leg.base_joint.friction.M0, leg.drive.friction.torque, leg.guide.gland) == (0.2, 0.6, 250e6)
    assert leg.drive.encoder.resolution == pytest.approx(np.pi / 1000)
    assert (found.base_mount.stiffness[0, 0], found.base_mount.loss) == (4e8, 0.03)
    steps = '{ sections = [{ length = "700 mm", diameter = "35 mm", material = "steel" }] }'
    text = preset_text("paper-robot").replace('{ diameter = "27 mm", length = "750 mm", material = "steel" }', steps)
    vary = [{"key": "leg.piston.sections[1].length", "values": ["750 mm"]}]
    found = Points(loads(text), read_plan({"vary": vary})).study(0).robot
    assert found.legs[2].piston.sections[0].length == 0.75


def test_spacing():
    entry = {"key": KEY, "start": "10 mm", "stop": "40 mm", "count": 3, "spacing": "logarithmic"}
    assert points(vary=[entry]).columns[0][0] == pytest.approx((0.01, 0.02, 0.04))
    assert points(vary=[{"key": "simulation.modes", "start": 1, "stop": 5, "count": 3}]).columns == (((1, 3, 5),),)


def test_points_that_are_alike_are_one():
    found = points(vary=[{"key": KEY, "values": ["27 mm", 0.027, "30 mm", "2.7 cm"]}]).resolve()
    assert found.first.tolist() == [0, 0, 2, 0]


def test_points_that_cannot_be_are_told_apart():
    found = points(vary=[{"key": KEY, "values": ["-1 mm", "27 mm"]}]).resolve()
    assert found.first.tolist() == [0, 1]
    assert list(found.refused) == [0]
    assert "is out of range" in found.refused[0]


def test_hypercube_has_one_sample_in_every_slice():
    ranges = {KEY: ["20 mm", "30 mm"], "payload.mass": ["50 kg", 150]}
    cube = points(latin_hypercube={"count": 20, "seed": 3, "ranges": ranges}).cube
    slices = np.floor((cube - [0.02, 50]) / [0.01, 100] * 20).astype(int)
    assert (np.sort(slices, axis=0) == np.arange(20)[:, None]).all()
    again = points(latin_hypercube={"count": 20, "seed": 3, "ranges": ranges}).cube
    assert (again == cube).all()
    assert (points(latin_hypercube={"count": 20, "seed": 4, "ranges": ranges}).cube != cube).any()


def draws(count, *tolerances):
    return {"random": {"count": count, "seed": 1, "tolerance": [{"key": key, **law} for key, law in tolerances]}}


def test_every_leg_has_its_own_draw():
    found = Points(quick(), read_plan(draws(400, (KEY, {"normal": "0.1 mm"}))))
    values = found.resolve().scattered[0]
    assert values.shape == (400, 6)
    assert [leg.piston.diameter for leg in found.study(7).robot.legs] == pytest.approx(values[7], rel=1e-15)
    # 2400 normal numbers: mean within 4 standard errors, standard deviation within 4 of its own (1 / sqrt(2 n))
    assert abs(values.mean() - 0.027) < 4 * 1e-4 / np.sqrt(2400)
    assert values.std() == pytest.approx(1e-4, rel=4 / np.sqrt(4800))
    assert abs(np.corrcoef(values.T)[0, 1]) < 4 / np.sqrt(400)


def test_circles_become_joints_and_materials_numbers():
    found = Points(
        quick(), read_plan(draws(50, ("robot.base.joints", {"uniform": "0.1 mm"}), ("leg.piston.E", {"normal": "1 %"})))
    )
    joints, moduli = found.resolve().scattered
    away = joints.reshape(50, 6, 3) - quick().robot.base_joints
    assert 0.9e-4 < np.abs(away).max() <= 1e-4
    study = found.study(3)
    assert study.robot.base_joints == pytest.approx(joints[3].reshape(6, 3))
    steel = quick().robot.legs[0].piston
    assert study.robot.legs[1].piston.EA / steel.EA == pytest.approx(moduli[3, 1] / steel.E)
    assert study.robot.legs[1].piston.rhoA == steel.rhoA


def test_another_tolerance_leaves_the_draws_of_the_first():
    one = Points(quick(), read_plan(draws(5, (KEY, {"normal": "0.1 mm"}))))
    two = Points(quick(), read_plan(draws(5, (KEY, {"normal": "0.1 mm"}), ("payload.mass", {"uniform": "1 kg"}))))
    assert (one.draws[0] == two.draws[0]).all()
    alike = Points(quick(), read_plan(draws(5, (KEY, {"normal": "1 %"}), ("leg.damping", {"normal": "1 %"}))))
    assert (alike.draws[0] != alike.draws[1]).all()


def test_tolerances_scatter_about_what_varies():
    sweep = {"vary": [{"key": "payload.mass", "values": [50, 100]}], **draws(3, ("payload.mass", {"normal": "1 %"}))}
    values = Points(quick(), read_plan(sweep)).resolve().scattered[0][:, 0]
    assert values[3:] == pytest.approx(2 * values[:3], rel=1e-15)  # the same draws about each nominal


def test_tolerances_scatter_about_a_circle_that_varies():
    """What all draws of a grid point share is kept from one to the next, and not too long."""
    sweep = {
        "vary": [{"key": "robot.base.radius", "values": [0.25, 0.3]}],
        **draws(2, ("robot.base.joints", {"uniform": "0.1 mm"}), ("leg[2].damping", {"normal": "10 %"})),
    }
    found = Points(quick(), read_plan(sweep))
    for point in (3, 0, 2, 1):
        joints = found.study(point).robot.base_joints
        radius = (0.25, 0.3)[point // 2]
        assert np.hypot(joints[:, 0], joints[:, 1]) == pytest.approx(np.full(6, radius), abs=1.5e-4)
        damping = [leg.damping for leg in found.study(point).robot.legs]
        assert damping[1] == pytest.approx(0.005 * (1 + 0.1 * found.draws[1][point % 2, 0]), rel=1e-15)
        assert damping[2:] == [0.005] * 4
    again = Points(quick(), read_plan(sweep))
    assert again.study(1) == found.study(1)


def test_every_shape_has_a_kernel_of_its_own():
    """Shapes of solid pistons depend on their diameter, those of a tip body on its mass: one kind was counted."""
    fidelity = {"key": "simulation.fidelity", "values": ["solid-fem"]}
    modes = {"key": "simulation.modes", "values": [2]}
    solid = points(vary=[{"key": KEY, "values": ["25 mm", "27 mm", "30 mm"]}, fidelity, modes]).resolve()
    assert (len(solid.settings), solid.refused) == (3, {})
    mass = {"key": "payload.mass", "values": [50, 100]}
    assert len(points(vary=[mass, fidelity, modes]).resolve().settings) == 1
    actuator = loads(preset_text("paper-actuator"))
    tips = [{"key": "actuator.tip_mass", "values": [1, 2]}]
    for basis, kinds in (("clamped-free", 1), ("tip-load", 1), ("tip-mass", 2)):
        chosen = {"key": "simulation.basis", "values": [basis]}
        assert len(Points(actuator, read_plan({"vary": [*tips, chosen]})).resolve().settings) == kinds
    assert kernel.cache_info().maxsize is not None  # a worker meets thousands of them


def test_tables_are_read_beside_the_study(tmp_path):
    (tmp_path / "roll.csv").write_text("time [s], roll [deg]\n0, 0\n0.01, 0.1\n0.02, 0\n", encoding="utf-8")
    text = quick().replace(source_text="").source_text
    head, tail = text.split("[motion]")
    study = head + '[motion]\ntype = "csv"\nfile = "roll.csv"\n\n[' + tail.split("\n[", 1)[1]
    (tmp_path / "study.toml").write_text(study, encoding="utf-8")
    found = Points(loads(study, path=tmp_path / "study.toml"), read_plan(diameters(2)))
    assert found.study(1).motion.pose[1, 3] == pytest.approx(np.deg2rad(0.1))
    before = found.resolve().hash
    (tmp_path / "roll.csv").write_text("time [s], roll [deg]\n0, 0\n0.01, 0.2\n0.02, 0\n", encoding="utf-8")
    assert found.resolve().hash != before


def test_draws_beyond_the_memory_are_refused_before_they_are_made(monkeypatch):
    """All random numbers are made at once: 1e7 draws of six diameters take gigabytes."""
    monkeypatch.setattr(resource_limits, "available_memory", lambda: 1e9)
    with pytest.raises(InputError, match=r"random.count.*2.96 GB of memory, where 1 GB is free.*Give fewer points"):
        Points(quick(), read_plan(draws(10_000_000, (KEY, {"normal": "0.1 mm"}))))
    cube = {"count": 10_000_000, "seed": 3, "ranges": {KEY: ["25 mm", "30 mm"]}}
    with pytest.raises(InputError, match=r"latin_hypercube.count.*2.16 GB of memory"):
        points(latin_hypercube=cube)


@pytest.mark.parametrize(
    ("name", "key", "value", "read", "expected"),
    [
        ("tripod", "robot.base.joints[2][3]", "5 mm", lambda r: r.base_joints[:, 2], [0, 0.005, 0]),
        ("tripod", "robot.platform.angles[3]", "270 deg", lambda r: r.platform_joints[2], [0, -0.2, 0]),
        ("tripod", "leg[3].base_joint.axis", "radial", lambda r: r.legs[2].u_axis @ r.base_joints[2], 0.35),
        ("tricept", "leg[4].piston.length", "0.72 m", lambda r: [x.piston.length for x in r.legs[2:]], [0.75, 0.72]),
        ("tricept", "leg[2].piston.EI", 1.0, lambda r: r.count, 4),
        ("hexaglide", "leg[2].carriage.mass", "4 kg", lambda r: [leg.carriage.mass for leg in r.legs[:3]], [3, 4, 3]),
        ("planar", "robot.platform.joints[1][2]", "9 mm", lambda r: r.platform_joints[0, 1], 0.009),
        ("eight-legs", "leg[8].drive.value", "450 N", lambda r: [leg.drive.value for leg in r.legs[6:]], [500, 450]),
        ("flexures", "leg.base_joint.bending", "20 N m/rad", lambda r: r.legs[4].base_joint.bending, 20),
    ],
)  # fmt: skip
def test_keys_of_other_mechanisms(name, key, value, read, expected):
    study = loads(sample_text(name))
    if "EI" in key:  # of a piston by its section: refused as a study file with both is
        with pytest.raises(InputError, match="EA"):
            Points(study, read_plan({"vary": [{"key": key, "values": [value]}]})).resolve()
        return
    found = Points(study, read_plan({"vary": [{"key": key, "values": [value]}]})).study(0)
    assert read(found.robot) == pytest.approx(expected, abs=1e-15)


def test_tolerances_of_joints_at_angles_and_of_a_carriage():
    study = loads(sample_text("hexaglide"))
    plan = draws(20, ("robot.base.joints", {"uniform": "0.1 mm"}), ("leg.carriage.mass", {"normal": "1 %"}))
    joints, masses = Points(study, read_plan(plan)).resolve().scattered
    assert joints.shape == (20, 18) and masses.shape == (20, 6)
    assert 0.9e-4 < np.abs(joints.reshape(20, 6, 3) - study.robot.base_joints).max() <= 1e-4
