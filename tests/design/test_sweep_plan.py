"""Sweep files: what they may hold, and what is refused before anything is computed."""

import numpy as np
import pytest
from tests.helpers.sweeps import KEY, diameters, quick

from flexapod.common.errors import InputError
from flexapod.design.sweeps.outputs import select_outputs
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.samples import Points

pytestmark = pytest.mark.unit


def refused(sweep):
    with pytest.raises(InputError) as caught:
        points = Points(quick(), read_plan(sweep))
        select_outputs(points.plan.keep, quick(), points.resolve())
    return str(caught.value)


def vary(key, *values):
    return {"vary": [{"key": key, "values": list(values)}]}


def scatter(key, **law):
    return {"random": {"count": 3, "tolerance": [{"key": key, **law}]}}


@pytest.mark.parametrize(
    ("sweep", "words"),
    [
        ({}, ["varies nothing", "[[vary]]"]),
        ({"grid": []}, ["grid: unknown key", "latin_hypercube"]),
        ({"vary": {"key": "a"}}, ["vary", "[[vary]]"]),
        ({"vary": [{"key": KEY}]}, ["vary[1].start: is missing"]),
        ({"vary": [{"key": "leg..a", "values": [1]}]}, ["vary[1].key", "not a key path", "leg[3].piston.diameter"]),
        ({"vary": [{"key": KEY, "values": []}]}, ["vary[1].values", "not a list of values"]),
        ({"vary": [{"key": KEY, "start": 1, "stop": 2, "count": 1}]}, ["vary[1].count = 1", "at least 2"]),
        ({"vary": [{"together": {KEY: [0.02], "payload.mass": [1, 2]}}]}, ["payload.mass: has 2 values", "1, as"]),
        ({"vary": [*vary(KEY, 1)["vary"], *vary(KEY, 2)["vary"]]}, [KEY, "varies in two places"]),
        ({"vary": [*vary("leg[3].damping", 1)["vary"], *vary("leg.damping", 2)["vary"]]}, ["and so does leg.damping"]),
        ({"vary": [*vary("payload.com[2]", 1)["vary"], *vary("payload.com", [1, 2, 3])["vary"]]}, ["would replace"]),
        ({"vary": [{"together": {"leg.piston": [{}], "leg[2].piston.E": [1]}}]}, ["and so does leg[2].piston.E"]),
        (
            {"vary": [*vary("robot.base.radius", 1)["vary"], *vary("robot.base.joints[1][2]", 1)["vary"]]},
            ["robot.base.radius: varies, and so does robot.base.joints[1][2]"],
        ),
        (
            {
                "random": {
                    "count": 2,
                    "tolerance": [
                        {"key": "payload.com", "normal": 1e-3},
                        {"key": "payload.com[2]", "normal": 1e-3},
                    ],
                }
            },
            ["payload.com: varies, and so does payload.com[2]"],
        ),
        (vary("leg", {}), ["leg: is a whole table", "[vary.together]"]),
        (
            {**vary("load.wrench", [0, 0, 1, 0, 0, 0]), **scatter("load.wrench", uniform="1 N")},
            ["load.wrench: holds numbers of several kinds (force, torque)", "load.wrench[1]"],
        ),
        (vary("base.radius", "0.2 m"), ["unknown key", "Did you mean 'robot.base.radius'?"]),
        (vary("leg.piston.diametre", 1), ["leg.piston.diametre: unknown key", "diameter, inner_diameter"]),
        (vary(KEY, "27 mm", "27 deg"), ["27 deg", "is not a length", '"27 mm"']),
        (vary(KEY, "27 mm", [1, 2]), [KEY, "is not a number"]),
        (vary(KEY, "-1 mm", 0.0), ["is out of range", "above 0"]),  # not one point that could be
        (vary("leg[7].damping", 0.1), ["leg[7]: has no such item", "1 to 6"]),
        (vary("payload.mass[1]", 1), ["payload.mass[1]", "no such item"]),
        (vary("payload.mass.value", 1), ["payload.mass", "is not a table"]),
        (vary("simulation.fidelity", "rigit"), ["rigit", "Did you mean 'rigid'?"]),
        (vary("simulation.modes", 2.5), ["2.5", "is not a whole number"]),
        ({"vary": [{"key": "motion.profile", "start": 1, "stop": 2, "count": 3}]}, ["motion.profile"]),
        ({"vary": [{"key": KEY, "start": "1 mm", "stop": "1 kg", "count": 3}]}, ["1 kg", "is not a length"]),
        (
            {"vary": [{"key": KEY, "start": 0, "stop": 1, "count": 3, "spacing": "logarithmic"}]},
            ["logarithms", "above 0"],
        ),
        ({"vary": [{"key": "simulation.modes", "start": 1, "stop": 4, "count": 3}]}, ["takes whole numbers only"]),
        ({"latin_hypercube": {"count": 3, "ranges": {KEY: ["30 mm", "20 mm"]}}}, ["is not a range", "lowest"]),
        ({"latin_hypercube": {"count": 3, "ranges": {KEY: [1, 2, 3]}}}, ["is not a range"]),
        ({"latin_hypercube": {"ranges": {KEY: [1, 2]}}}, ["latin_hypercube.count: is missing"]),
        ({"latin_hypercube": {"count": 3, "ranges": {"simulation.modes": [1, 5]}}}, ["[[vary]]"]),
        (scatter(KEY), ["random.tolerance[1]", "has no law", "normal"]),
        (scatter(KEY, normal="1 %", uniform="1 %"), ["has two laws"]),
        (scatter(KEY, normal="1 deg"), ["is not a length"]),
        (scatter(KEY, normal=-1e-3), ["is out of range"]),
        (scatter("motion.profile", normal="1 %"), ["not a number that could scatter"]),
        (scatter("payload.tool", normal="1 mm"), ["has no value in the study file"]),
        (diameters(2, scalars=["peak"]), ["keep.scalars = 'peak'", "com_deviation_peak"]),
        (diameters(2, records=["tip"]), ["keep.records = 'tip'", "tip_deflection"]),
        (diameters(2, records=["base_force_rigid"]), ["keep.records"]),  # of inverse dynamics, not of a simulation
        (diameters(2, records=["lateral_amplitude"]), ["number of shapes"]),  # legs that only stretch
        (diameters(2, records=["com_deviation"], record_step=1.5e-3), ["not a multiple", "0.001 s"]),
        (diameters(2, record_step=1e-3, scalars=["steps"]), ["no effect without records"]),
        (
            {**vary("simulation.duration", 0.01, 0.02), "keep": {"records": ["com_deviation"]}},
            ["other instants at other points"],
        ),
        ({"vary": [{"key": KEY, "start": 1, "stop": 2, "count": 10**9}]}, ["1,000,000,000 points"]),
    ],
)
def test_refused_in_words(sweep, words):
    message = refused(sweep)
    assert not [word for word in words if word not in message], message


@pytest.mark.parametrize(
    "keys",
    [
        ("payload.mass", "payload.com[2]"),
        ("leg[1].damping", "leg[2].damping"),
        ("robot.base.radius", "robot.platform.joints"),
    ],
)
def test_keys_that_have_nothing_in_common(keys):
    assert read_plan({"vary": [*vary(keys[0], 1)["vary"], *vary(keys[1], 2)["vary"]]}).size == 1


def test_numbers_of_numpy():
    by_numpy = {
        "vary": [{"key": KEY, "values": np.array([0.025, 0.03])}, {"key": "simulation.modes", "values": [np.int64(2)]}]
    }
    plain = {"vary": [{"key": KEY, "values": [0.025, 0.03]}, {"key": "simulation.modes", "values": [2]}]}
    assert read_plan(by_numpy) == read_plan(plain)


def test_an_unphysical_first_value_hides_no_other_key():
    """A mass of 0 stopped the reading before the diameter, whose values were then no numbers."""
    inner = {"key": "leg.piston.inner_diameter", "start": "0 mm", "stop": "20 mm", "count": 2}
    points = Points(quick(), read_plan({"vary": [*vary("payload.mass", 0, 100)["vary"], inner]}))
    assert points.columns[1] == ((0.0, 0.02),)


def test_file_is_named(tmp_path):
    file = tmp_path / "grid.toml"
    file.write_text(f'[[vary]]\nkey = "{KEY}"\nvalues = ["27 deg"]\n', encoding="utf-8")
    assert refused(file).startswith(str(file))
    file.write_text("[[vary\n", encoding="utf-8")
    assert "is not valid TOML" in refused(file)
    assert "cannot be read" in refused(tmp_path / "none.toml")
    assert "a sweep file or a dictionary" in refused(3)


def test_comments_are_no_content(tmp_path):
    text = f'[[vary]]\nkey = "{KEY}"\nvalues = ["27 mm"]\n'
    plans = []
    for more in ("", "# a comment\n", "[keep]\nscalars = ['steps']\n"):
        file = tmp_path / "grid.toml"
        file.write_text(text + more, encoding="utf-8")
        plans.append(read_plan(file))
    assert plans[0].hash == plans[1].hash != plans[2].hash
