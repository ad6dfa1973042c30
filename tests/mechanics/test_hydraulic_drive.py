"""Hydraulic legs: oil in closed form, leakage against integrated chambers, limits, energy, one number everywhere."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar
from tests.helpers.machines import OIL, SCREW, light, machine, study, symmetric
from tests.helpers.runs import balance, run_robot
from tests.helpers.texts import replaced

import flexapod as fx
from flexapod import model
from flexapod.analysis.description.hydraulic_description import describe_hydraulics, hydraulic_remarks, oil_frequency
from flexapod.analysis.description.robot_description import describe
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.errors import InputError
from flexapod.mechanics.elements.springs import springs_along
from flexapod.model import AxialSpring, HydraulicLimits
from flexapod.output.text import html
from flexapod.output.text.check import check_items
from flexapod.output.text.study import study_items
from flexapod.output.text.terminal import print_items
from flexapod.solve.modal.structural_damping import loss_frequency

pytestmark = pytest.mark.consistency

BETA, S = 1.2e9, 0.5
STILL = {"gravity": [0, 0, 0]}


def oil_of(drive, length):
    """Stiffness of the oil of a leg [N/m]."""
    spring = next(x for x in springs_along(machine(drive=drive).legs[0]) if x.name == "oil")
    return 1 / spring.at_length(np.asarray(length))


def out(length):
    return np.asarray(length) - 0.75 - 0.05


class TestOilColumn:
    def test_is_two_chambers_side_by_side(self):
        x, push, pull = np.linspace(0.01, 0.49, 7), np.pi / 4 * 0.08**2, np.pi / 4 * (0.08**2 - 0.056**2)
        expected = BETA * (push**2 / (1e-4 + push * x) + pull**2 / (3e-4 + pull * (S - x)))
        np.testing.assert_allclose(oil_of(OIL, x + 0.8), expected, rtol=1e-12)

    def test_is_softest_where_the_closed_form_says(self):
        push, pull = OIL.areas
        root, (first, second) = np.sqrt([push, pull]), OIL.dead_volume
        place = ((S + second / pull) * root[0] - first / push * root[1]) / root.sum()
        found = minimize_scalar(lambda x: float(oil_of(OIL, x + 0.8)), bounds=(0, S), options={"xatol": 1e-10})
        # A minimum is found to the root of the rounding.
        assert found.x == pytest.approx(place, abs=1e-6)
        assert found.fun == pytest.approx(BETA * root.sum() ** 2 / (S + first / push + second / pull), rel=1e-12)

    def test_with_equal_areas_four_times_area_over_stroke(self):
        drive = OIL.replace(double_ended=True, dead_volume=0)
        area = np.pi / 4 * (0.08**2 - 0.056**2)
        assert oil_of(drive, 0.8 + S / 2) == pytest.approx(4 * BETA * area / S, rel=1e-12)
        # Towards an end without dead volume the oil is rigid.
        assert oil_of(drive, 0.8 + 1e-9) > 1e7 * oil_of(drive, 0.8 + S / 2)

    def test_catalogue_size_of_the_source(self):
        # 80 mm bore, 1 m stroke, 1.4 GPa: 28 N/um with the whole area on both sides, 20.7 for a 56 mm rod.
        drive = OIL.replace(stroke=1.0, dead_volume=0, bulk_modulus=1.4e9)
        x = np.linspace(0.8, 1.8, 2001)[1:-1]
        assert 1e-6 * oil_of(drive, x).min() == pytest.approx(20.7, abs=0.05)
        assert 1e-6 * 4 * 1.4e9 * np.pi / 4 * 0.08**2 / 1.0 == pytest.approx(28, abs=0.2)


class TestLeakage:
    """The chambers as equations, integrated: no formula of the product."""

    def chambers(self, drive, x0, motion, end, start=(0.0, 0.0), force=None):
        push, pull = drive.areas
        v1, v2 = drive.volumes(np.array(x0))
        beta, leak = drive.bulk_modulus, drive.leakage

        def rate(t, p):
            flow = leak * (p[0] - p[1])
            # With a given force the head moves so that A1 p1 - A2 p2 keeps its value.
            v = motion(t) if force is None else (
                -flow * (push / v1 + pull / v2) / (push**2 / v1 + pull**2 / v2)
            )  # fmt: skip
            return [-beta * (push * v + flow) / v1, beta * (pull * v + flow) / v2, *([v] if force is not None else [])]

        return solve_ivp(rate, (0, end), start, rtol=1e-11, atol=1e-6, dense_output=True)

    @pytest.mark.parametrize("rod", [0.056, 1e-6])
    def test_damper_at_a_frequency(self, rod):
        drive, omega, x0 = OIL.replace(rod=rod, leakage=1e-13), 2 * np.pi * 12.0, 0.2
        push, pull = drive.areas
        found = self.chambers(drive, x0, lambda t: 1e-4 * omega * np.cos(omega * t), 40 / 12.0)
        t = np.linspace(30 / 12.0, 40 / 12.0, 4001)
        p = found.sol(t)
        force = push * p[0] - pull * p[1]
        sine, cosine = (2 * np.trapezoid(force * wave(omega * t), t) / (10 / 12.0) for wave in (np.sin, np.cos))
        spring = next(x for x in springs_along(machine(drive=drive).legs[0]) if x.name == "oil")
        k = 1 / float(spring.at_length(np.array(1.0)))
        eps = float(spring.creep(np.array(1.0)))
        # First order in the loss factor, which is 2e-3: what is left out is its square. With unequal areas the
        # transient of the common pressure is slow, and no part of the difference.
        assert -sine / 1e-4 == pytest.approx(k, rel=1e-4)
        assert -cosine / 1e-4 == pytest.approx(eps * k**2 / omega, rel=2e-2)

    def test_creep(self):
        spring = next(x for x in springs_along(machine(drive=OIL).legs[0]) if x.name == "oil")
        push, pull = OIL.areas
        v1, v2 = OIL.volumes(np.array(0.2))
        k = BETA * (push**2 / v1 + pull**2 / v2)
        at_once = np.array([BETA * push / v1, -BETA * pull / v2]) / k * 1e4  # of 10 kN
        found = self.chambers(OIL, 0.2, None, 1e-3, (*at_once, 0.0), force=1e4)
        assert found.y[2, -1] / 1e-3 == pytest.approx(-1e4 * float(spring.creep(np.array(1.0))), rel=1e-3)

    def test_it_is_the_damper_of_the_first_frequency(self):
        robot, sealed = (machine(drive=OIL.replace(leakage=x)) for x in (1e-12, 0.0))
        frequency = loss_frequency(robot, study(robot, fidelity="lumped").simulation)
        first = fx.modes(sealed, fidelity="lumped")
        assert loss_frequency(sealed, study(sealed).simulation) == 0
        assert frequency == pytest.approx(first.frequency.values[0], rel=1e-9)
        found = fx.modes(robot, fidelity="lumped").damping_ratio.values[0] - first.damping_ratio.values[0]
        eta = 1e-12 * (1 / OIL.areas[0]) ** 2 * 3e7 / (2 * np.pi * frequency)  # about: the size
        assert 0.3 * eta / 2 < found < 3 * eta / 2
        # Four times the leakage, four times the damping.
        more = fx.modes(machine(drive=OIL.replace(leakage=4e-12)), fidelity="lumped").damping_ratio.values[0]
        assert more - first.damping_ratio.values[0] == pytest.approx(4 * found, rel=1e-2)


def test_hard_oil_is_a_prescribed_stroke():
    hard = OIL.replace(bulk_modulus=1e18, leakage=0.0)
    for compute, name in ((fx.stiffness, "stiffness"), (fx.modes, "frequency")):
        ours, theirs = (compute(machine(**x), fidelity="lumped")[name].values for x in ({"drive": hard}, {}))
        size = np.sqrt(np.outer(np.diag(theirs), np.diag(theirs))) if theirs.ndim == 2 else theirs
        # 4.4e8 N/m over 2e16, and rounding of these.
        np.testing.assert_allclose(ours[: len(theirs)] / size, theirs / size, atol=1e-7)


def test_oil_scales_all_frequencies_of_a_payload():
    # The same leg six times: every frequency falls with the root of the compliance.
    robot, ideal = (light(machine(**x), **STILL) for x in ({"drive": OIL.replace(leakage=0.0)}, {}))
    oil = oil_of(OIL, robot.home_lengths[0])
    ours, theirs = (fx.modes(x, fidelity="lumped").frequency.values[:6] for x in (robot, ideal))
    np.testing.assert_allclose(ours * np.sqrt(1 + 3.3e8 / 0.75 / oil), theirs, rtol=1e-9)


def test_the_kernel_has_the_oil_of_every_length():
    # A run at rest at another height: what is far from home is not a series about it.
    robot = symmetric(drive=OIL.replace(leakage=0.0))
    for heave in (-0.15, 0.1):
        pose = {"heave": heave}
        part = fx.parts(robot, pose).part_stiffness.sel(part="oil").values
        data = fx.stiffness(robot, pose)
        # Along z, from the legs' cosines, in series with the piston; the thrust adds some 1e-3.
        h = robot.home_position + np.array([0, 0, heave]) + robot.platform_joints - robot.base_joints
        n = h / np.linalg.norm(h, axis=1)[:, None]
        along = (n[:, 2] ** 2 / (1 / part + 0.75 / 3.3e8)).sum()
        assert data.stiffness.values[2, 2] == pytest.approx(along, rel=2e-3)


def test_energy_closes_to_second_order():
    robot, errors = machine(drive=OIL, springs=(AxialSpring(name="valve", stiffness=2e8, loss=0.02),)), []
    for step in (1e-3, 5e-4):
        found = balance(run_robot(study(robot, fidelity="lumped", step=step)))
        errors.append(np.abs(found - found[0]).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)


def test_causes_run_modes_and_budget_agree():
    robot = machine(drive=OIL)
    given = study(robot, fidelity="lumped", step=1e-3, duration=0.01)
    data, sag = fx.simulate(given), fx.modes(robot, fidelity="lumped").com_sag.values
    np.testing.assert_allclose(data.com_deviation.values[0], sag, rtol=0, atol=1e-12)
    assert "oil" in data.cause.values
    budget = fx.budget(given)
    rows = budget.budget.sel(kind="systematic", component=["x", "y", "z"])
    whole = rows.sum("part") + budget.budget_residual.sel(kind="systematic", component=["x", "y", "z"])
    np.testing.assert_allclose(whole, data.tool_deviation.values[0], rtol=0, atol=1e-12)
    shares = data.deviation_by_cause.isel(time=0).sum("leg").sel(axis="z")
    part = fx.parts(robot).part_stiffness.isel(leg=0)
    ratio = float(shares.sel(cause="oil") / shares.sel(cause="axial-strain"))
    # The same thrust along a leg but for its own weight, a sixteenth of the payload's.
    assert ratio == pytest.approx(float(part.sel(part="piston") / part.sel(part="oil")), rel=0.1)


def test_made_ideal_it_takes_its_row_out():
    whole, without = (
        fx.budget(study(machine(drive=x), fidelity="lumped")) for x in (OIL, OIL.replace(bulk_modulus=1e18))
    )
    row = whole.budget.sel(part="oil", kind="systematic", component="z")
    change = (whole.budget_total - without.budget_total).sel(kind="systematic", component="z")
    assert float(change) == pytest.approx(float(row), rel=0.02)


def test_beside_screws_and_maps():
    # In one kernel with legs that have no oil.
    robot = machine()
    legs = [leg.replace(drive=OIL if i % 2 else SCREW) for i, leg in enumerate(robot.legs)]
    robot = robot.replace(legs=tuple(legs))
    found = fx.parts(robot).part_stiffness.sel(part="oil").values
    assert np.isinf(found[::2]).all() and np.isfinite(found[1::2]).all()
    here = fx.modes(robot, fidelity="lumped")
    data = fx.workspace_map(study(robot, fidelity="lumped"), {"heave": [-0.02, 0.0, 0.02]})
    middle = data.isel(heave=1) if "heave" in data.dims else data.isel(pose=1)
    np.testing.assert_allclose(middle.frequency.values[:6], here.frequency.values[:6], rtol=1e-9)


TEXT = model.preset_text("motion-base")


def changed(*pairs):
    return model.loads(replaced(TEXT, *pairs))


class TestFile:
    def test_round_trip(self):
        given = changed(('leakage = "2e-12 m^3/(s Pa)"', "leakage = 2e-12\ndouble_ended = true"))
        assert model.loads(model.to_toml(given)).robot == given.robot
        one = changed(('dead_volume = ["0.5 l", "0.9 l"]', 'dead_volume = "0.7 l"'))
        np.testing.assert_allclose(one.robot.legs[0].drive.dead_volume, [7e-4, 7e-4])

    def test_begins_where_the_leg_is_shortest(self):
        given = changed(('bottom = "0.5 m"             #', "#"))
        assert given.robot.legs[0].begins == pytest.approx(2.1)
        assert model.preset("motion-base").robot.legs[0].begins == pytest.approx(2.1)

    @pytest.mark.parametrize("change", [('bottom = "0.5 m"', 'bottom = "1.2 m"'),
                                        ('stroke = "1.25 m"', 'stroke = "0.9 m"')])  # fmt: skip
    def test_a_piston_that_leaves_its_oil_is_refused_on_the_path(self, change):
        given = changed(change)
        with pytest.raises(InputError, match="does not reach as far as the piston of leg") as caught:
            describe(given)
        assert "at t = " in str(caught.value)
        with pytest.raises(InputError):
            fx.simulate(given)


class TestMotionBase:
    def test_a_leg_by_hand(self):
        found = fx.parts(fx.preset("motion-base")).isel(leg=0)
        x, push, pull = 2.72215 - 2.1, np.pi / 4 * 0.1**2, np.pi / 4 * (0.1**2 - 0.07**2)
        oil = 1.4e9 * (push**2 / (5e-4 + push * x) + pull**2 / (9e-4 + pull * (1.25 - x)))
        assert float(found.part_stiffness.sel(part="oil")) == pytest.approx(oil, rel=1e-4)
        assert 0.8 < float(found.leg_stiffness / found.part_stiffness.sel(part="oil")) < 0.95

    def test_frequencies_are_those_of_motion_bases(self):
        # Of legs of 1 to 1.5 m stroke under 6 to 15 t some 5 to 15 Hz; its own legs and joints lower them by a tenth.
        study = fx.preset("motion-base")
        found = fx.modes(study).frequency.values[:6]
        assert 4.5 < found[0] and found[5] < 17
        low, high = oil_frequency(RigidPath(study))
        assert found[0] < high and low < high < 1.2 * found[0]

    def test_frequency_on_the_oil_is_that_of_legs_without_mass(self):
        study = fx.preset("motion-base")
        drive = study.robot.legs[0].drive.replace(leakage=0.0)
        bare = [
            leg.replace(drive=drive, base_joint=model.Joint(), platform_joint=model.Joint()) for leg in study.robot.legs
        ]
        robot = light(study.robot.replace(legs=tuple(bare)), **STILL)
        found = fx.modes(robot, fidelity="lumped").frequency.values[0]
        still = study.replace(motion=study.motion.replace(amplitudes={"heave": 0.0}))
        low, high = oil_frequency(RigidPath(still))
        assert low == pytest.approx(high, rel=1e-9)
        # The piston's stretch is in series, 21.2 and 481 N/um.
        k = fx.parts(robot).part_stiffness.isel(leg=0)
        series = np.sqrt(1 + float(k.sel(part="oil") / k.sel(part="piston")))
        assert found * series == pytest.approx(low, rel=1e-6)

    def test_check_and_report_say_it(self, capsys):
        study = changed(('pressure = "140 bar", flow = "470 l/min"', 'pressure = "30 bar", flow = "200 l/min"'))
        found = describe(study)
        print_items(check_items(found))
        words = capsys.readouterr().out
        assert "Hydraulic cylinders, on the path" in words and "The platform on its oil alone vibrates at" in words
        assert "Leakage lets leg" in words
        remarks = "\n".join(found.remarks)
        assert "needs a pressure of" in remarks and "above the limit of 30 bar" in remarks
        assert "needs a flow of" in remarks and "above the limit of 200 l/min" in remarks
        assert "hydraulic, bore 100 mm, rod 70 mm" in html.parts(study_items(study, None)).replace(
            "\N{NO-BREAK SPACE}", " "
        )

    def test_pressure_and_flow_by_hand(self):
        study = fx.preset("motion-base")
        path = RigidPath(study)
        one = describe_hydraulics(path)[0]
        push, pull = study.robot.legs[0].drive.areas
        force, rate = path.forces.drive_force[:, 0], path.legs.rate[:, 0]
        assert one.pressure.value == pytest.approx(max((force / push).max(), (-force / pull).max()))
        assert one.flow.value == pytest.approx(max((rate * push).max(), (-rate * pull).max()))
        assert hydraulic_remarks(path.robot, describe_hydraulics(path)) == []
        legs = study.robot.legs
        rubs = legs[0].drive.replace(friction=model.StrokeFriction(force=2e3, viscous=500.0))
        path = RigidPath(study.replace(robot=study.robot.replace(legs=tuple(leg.replace(drive=rubs) for leg in legs))))
        force = force + 2e3 * np.sign(rate) + 500.0 * rate  # its seals
        assert describe_hydraulics(path)[0].pressure.value == pytest.approx(
            max((force / push).max(), (-force / pull).max())
        )
        low = study.robot.legs[0].drive.replace(limits=HydraulicLimits(pressure=1e5))
        legs = tuple(leg.replace(drive=low) for leg in study.robot.legs)
        path = RigidPath(study.replace(robot=study.robot.replace(legs=legs)))
        assert "above the limit of 1 bar" in hydraulic_remarks(path.robot, describe_hydraulics(path))[0]


def test_a_cylinder_with_a_section_stretches_up_to_its_bottom():
    old = next(line for line in TEXT.splitlines() if line.startswith("cylinder = "))
    given = changed(
        (old, 'cylinder = { mouth = "1.9 m", diameter = "120 mm", inner_diameter = "100 mm", material = "steel" }')
    )
    steel = model.MATERIALS["steel"].E
    found = fx.parts(given).part_stiffness.sel(part="cylinder").values
    np.testing.assert_allclose(found, steel * np.pi / 4 * (0.12**2 - 0.1**2) / 0.5, rtol=1e-12)
