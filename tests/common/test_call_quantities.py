"""Quantities of Python calls: one rule. A number, in a text too, is in SI; a text may have a unit, which is read.

Parameters are taken from the signatures of all public calls: of a new one the test asks whether it is a quantity.
"""

import inspect

import numpy as np
import pytest
import xarray as xr

import flexapod as fx
from flexapod import control
from flexapod.commissioning.feedforward import least_time, loaded_path
from flexapod.common.errors import InputError
from flexapod.control import IFF, PID

pytestmark = pytest.mark.unit

ROBOT = fx.preset("paper-robot").replace(simulation={"fidelity": "lumped", "step": 1e-3, "duration": 0.02})
SCREWS = fx.preset("machine-hexapod")
BEAM = fx.preset("paper-actuator").replace(simulation={"modes": 1, "step": 2e-3, "duration": 0.02})
DESIGN = {
    "variables": [{"key": "leg.piston.diameter", "low": "20 mm", "high": "40 mm"}],
    "objective": {"minimise": "piston_mass"},
    "constraints": {"first_frequency": {"least": "20 Hz"}},
}
WHOLE = {"output_step": 5e-3, "duration": 0.02}


def system():
    return fx.linearize(SCREWS, inputs="force:tool", outputs="tool")


def held():
    return fx.linearize(SCREWS, inputs="drive", outputs=("stroke", "force-sensor:drive"), drives="force")


def spring():
    """A mass of 1 kg on a spring of 100 Hz with two sensors."""
    w = 200 * np.pi
    return control.StateSpace(
        A=[[0, 1], [-(w**2), -0.02 * w]], B=[[0], [1]], C=[[1, 0], [w**2, 0]], D=[[0], [0]], inputs=("drive:1",),
        outputs=("stroke:1", "force-sensor:drive:1"), states=("x", "v"), units={},
    )  # fmt: skip


def closed(controller, **how):
    return spring().close(controller, sample=1e-4, **how).A


LOADS = ([0, 0, -100, 0, 2, 0], [0, 0, "-0.1 kN", 0, "2 N m", 0], ["1 m", 0, 0, 0, 0, 0])
HEAVE = ({"heave": 0.01}, "heave=1cm", "heave=1 N")
YAW = ({"yaw": 0.02}, "yaw=20 mrad", "yaw=2 mm")
#: A parameter of a call: in SI, in units (or in words), in units of something else; the call of a value.
CASES = {
    "accuracy.pose": ({"roll": 0.1, "heave": 0.01}, "roll=100mrad, heave=10mm", "roll=1m",
        lambda x: fx.accuracy(ROBOT, x)),
    "budget.pose": (*HEAVE, lambda x: fx.budget(SCREWS, x)),
    "budget.load": (*LOADS, lambda x: fx.budget(SCREWS, load=x)),
    "compliance.hz": ([10.0, 20.0], ["10 Hz", "0.02 kHz"], ["10 s"], lambda x: fx.compliance(SCREWS, x)),
    "compliance.pose": ({"yaw": 0.02}, {"yaw": "20 mrad"}, {"yaw": "2 mm"},
        lambda x: fx.compliance(SCREWS, [10.0], x)),
    "compliance.load": (*LOADS, lambda x: fx.compliance(SCREWS, [10.0], load=x)),
    "export.pose": (*HEAVE, lambda x: written("abaqus", "a.inp", pose=x, elements=2)),
    "export.load": (*LOADS, lambda x: written("abaqus", "a.inp", load=x, elements=2)),
    "export.step": (5e-4, "0.5 ms", "0.5 mm", lambda x: written("c", "", step=x)),
    "forward_kinematics.lengths": ([1.0] * 6, ["1000 mm"] * 6, ["1 s"] * 6,
        lambda x: fx.forward_kinematics(ROBOT, x)),
    "forward_kinematics.guess": (*HEAVE, lambda x: fx.forward_kinematics(ROBOT, [1.0] * 6, x)),
    "forward_kinematics.time": ([0.0, 0.5], ["0 s", "500 ms"], ["0 m", "1 m"],
        lambda x: fx.forward_kinematics(ROBOT, [[1.0] * 6] * 2, time=x)),
    "inverse_dynamics.load": (*LOADS, lambda x: fx.inverse_dynamics(ROBOT, load=x)),
    "inverse_dynamics.duration": (0.01, "10 ms", "10 mm", lambda x: fx.inverse_dynamics(ROBOT, duration=x)),
    "inverse_dynamics.output_step": (0.01, "10 ms", "10 Hz", lambda x: fx.inverse_dynamics(ROBOT, output_step=x)),
    "inverse_kinematics.duration": (0.01, "10 ms", "10 mm", lambda x: fx.inverse_kinematics(ROBOT, duration=x)),
    "inverse_kinematics.output_step": (0.01, "1 cs", "10 mm", lambda x: fx.inverse_kinematics(ROBOT, output_step=x)),
    "ladder.step": (2e-3, "2 ms", "2 m", lambda x: fx.ladder(BEAM, step=x)),
    "linearize.pose": ({"pitch": 0.02}, "pitch=20mrad", "pitch=2 s",
        lambda x: fx.linearize(SCREWS, x, inputs="wrench", outputs="tool").A),
    "linearize.load": (*LOADS, lambda x: fx.linearize(SCREWS, inputs="wrench", outputs="tool", load=x).A),
    "mobility.pose": (*HEAVE, lambda x: fx.mobility(ROBOT, x)),
    "modes.pose": ([0.01, 0, 0, 0, 0, 0.02], ["10 mm", 0, 0, 0, 0, "20 mrad"], ["10 mm", 0, 0, 0, 0, "20 mm"],
        lambda x: fx.modes(SCREWS, x)),
    "modes.load": (*LOADS, lambda x: fx.modes(SCREWS, load=x)),
    "optimise.pose": (*HEAVE, lambda x: fx.optimise(ROBOT, DESIGN, pose=x)),
    "parts.pose": (*HEAVE, lambda x: fx.parts(SCREWS, x)),
    "play.load": (*LOADS, lambda x: fx.play(SCREWS, load=x)),
    "shape.modes": ([16.0], ["16 Hz"], ["16 s"], lambda x: fx.shape(ROBOT, modes=x).motion.pose),
    "sensitivity.pose": (*HEAVE, lambda x: fx.sensitivity(SCREWS, "payload.mass", "first_frequency", x)),
    "shape.pose": (*HEAVE, lambda x: fx.shape(ROBOT, modes=1, pose=x).motion.pose),
    "simulate.load": (*LOADS, lambda x: fx.simulate(ROBOT, load=x)),
    "simulate.step": (2e-3, "2 ms", "2 mm", lambda x: fx.simulate(ROBOT, step=x, output_step=4e-3)),
    "simulate.duration": (0.01, "10 ms", "10 N", lambda x: fx.simulate(ROBOT, duration=x)),
    "simulate.output_step": (2e-3, "2 ms", "2 Hz", lambda x: fx.simulate(ROBOT, output_step=x)),
    "simulate.sample": (1e-3, "1 ms", "1 mm",
        lambda x: fx.simulate(fx.preset("nano-hexapod"), controller=IFF(20.0), sample=x, step=5e-4, **WHOLE)),
    "simulate_actuator.step": (1e-3, "1 ms", "1 mm", lambda x: fx.simulate_actuator(BEAM, step=x)),
    "simulate_actuator.duration": (0.01, "10 ms", "1 mm", lambda x: fx.simulate_actuator(BEAM, duration=x)),
    "simulate_actuator.output_step": (4e-3, "4 ms", "1 mm", lambda x: fx.simulate_actuator(BEAM, output_step=x)),
    "simulate_solid.size": (0.04, "40 mm", "40 ms", lambda x: fx.simulate_solid(BEAM, size=x, step=5e-3, **WHOLE)),
    "simulate_solid.spacing": (0.04, "40 mm", "40 ms",
        lambda x: fx.simulate_solid(BEAM, size=0.04, spacing=x, step=5e-3, **WHOLE)),
    "simulate_solid.step": (5e-3, "5 ms", "5 mm", lambda x: fx.simulate_solid(BEAM, size=0.04, step=x, **WHOLE)),
    "simulate_solid.duration": (0.01, "10 ms", "5 mm",
        lambda x: fx.simulate_solid(BEAM, size=0.04, step=5e-3, output_step=5e-3, duration=x)),
    "simulate_solid.output_step": (5e-3, "5 ms", "5 mm",
        lambda x: fx.simulate_solid(BEAM, size=0.04, step=5e-3, duration=0.01, output_step=x)),
    "stiffness.pose": (*HEAVE, lambda x: fx.stiffness(SCREWS, x)),
    "stiffness.load": (*LOADS, lambda x: fx.stiffness(SCREWS, load=x)),
    "time_optimal.start": ({"heave": 0.001}, "heave=1 mm", "heave=1 s", lambda x: ends(x, "heave=5 mm")),
    "time_optimal.end": ({"heave": 0.004}, "heave=4 mm", "heave=4 s", lambda x: ends(None, x)),
    "time_optimal.residual": (1e-5, "10 um", "10 us",
        lambda x: fx.time_optimal(SCREWS, end="heave=5 mm", acceleration=2.0, residual=x).motion.pose),
    "time_optimal.speed": (0.05, "50 mm/s", "50 mm", lambda x: limits(speed=x)),
    "time_optimal.acceleration": (1.0, "100 cm/s^2", "1 m", lambda x: limits(acceleration=x)),
    "time_optimal.force": (2000.0, "2 kN", "2 kg", lambda x: limits(force=x)),
    "transmissibility.hz": ([10.0], "10 Hz", "10 s", lambda x: fx.transmissibility(SCREWS, x)),
    "transmissibility.pose": (*YAW, lambda x: fx.transmissibility(SCREWS, [10.0], x)),
    "transmissibility.load": (*LOADS, lambda x: fx.transmissibility(SCREWS, [10.0], load=x)),
    "vibration.pose": (*HEAVE, lambda x: fx.vibration(shaken(), x)),
    "workspace_map.axes": ({"heave": [-0.01, 0.01]}, {"heave": ["-10 mm", "10 mm"]}, {"heave": ["1 s"]},
        lambda x: fx.workspace_map(ROBOT, x)),
    "workspace_map.at": ({"roll": 0.02}, "roll=20 mrad", "roll=1 mm",
        lambda x: fx.workspace_map(ROBOT, {"heave": [0]}, at=x)),
    "workspace_map.acceleration": ([0, 0, 2.0], [0, 0, "200 cm/s^2"], [0, 0, "2 m"],
        lambda x: fx.workspace_map(ROBOT, {"heave": [0]}, acceleration=x)),
    "workspace_map.load": (*LOADS, lambda x: fx.workspace_map(ROBOT, {"heave": [0]}, load=x)),
    # linear systems and controllers
    "StateSpace.frequency_response.hz": ([10.0, 20.0], ["10 Hz", "20 Hz"], ["10 s"],
        lambda x: system().frequency_response(x)),
    "StateSpace.at.hz": ([10.0], ["10 Hz"], ["10 s"], lambda x: system().at(x)),
    "StateSpace.rga.hz": ([10.0], ["10 Hz"], ["10 s"], lambda x: held().select(outputs="stroke").rga(x)),
    "StateSpace.step.duration": (0.01, "10 ms", "10 mm", lambda x: system().step(x, 1e-3)),
    "StateSpace.step.step": (1e-3, "1 ms", "1 mm", lambda x: system().step(0.01, x)),
    "StateSpace.impulse.duration": (0.01, "10 ms", "10 mm", lambda x: system().impulse(x, 1e-3)),
    "StateSpace.impulse.step": (1e-3, "1 ms", "1 mm", lambda x: system().impulse(0.01, x)),
    "StateSpace.reduce.below": (200.0, "0.2 kHz", "200 s", lambda x: system().reduce(below=x).A),
    "StateSpace.sampled.period": (1e-4, "0.1 ms", "0.1 mm", lambda x: system().sampled(x).A),
    "StateSpace.sampled.delay": (1e-4, "0.1 ms", "0.1 mm", lambda x: system().sampled(1e-4, x).A),
    "StateSpace.close.delay": (1e-4, "0.1 ms", "0.1 mm", lambda x: closed(IFF(20.0), delay=x)),
    "StateSpace.close.sample": (1e-4, "0.1 ms", "0.1 mm", lambda x: spring().close(IFF(20.0), sample=x).A),
    "IFF.high_pass": (2.0, "2 Hz", "2 s", lambda x: closed(IFF(20.0, high_pass=x))),
    "IFF.parallel_stiffness": (1e4, "10 kN/m", "10 kN", lambda x: closed(IFF(20.0, parallel_stiffness=x))),
    "PID.low_pass": (500.0, "0.5 kHz", "500 s", lambda x: closed(PID(1e3, derivative=10.0, low_pass=x))),
    "DVF.low_pass": (500.0, "0.5 kHz", "500 s", lambda x: closed(control.DVF(10.0, low_pass=x))),
    "SensorFusion.corner": (5.0, "5 Hz", "5 s",
        lambda x: closed(control.SensorFusion(control.gain(1.0), low="stroke", high="force-sensor:drive", corner=x))),
    "Tracker.frequency": (30.0, "30 Hz", "30 s", lambda x: control.Tracker(frequency=x).start()),
    "Tracker.lowest": (3.0, "3 Hz", "30 s", lambda x: tracked(lowest=x)),
    "Tracker.highest": (300.0, "0.3 kHz", "30 s", lambda x: tracked(highest=x)),
    "best_gain.below": (400.0, "0.4 kHz", "400 s", lambda x: control.best_gain(spring(), IFF(1.0), below=x)),
    "by_modes.above": (1.0, "1 Hz", "1 s", lambda x: control.by_modes(held(), above=x).into),
    "by_singular_vectors.hz": (20.0, "20 Hz", "20 s", lambda x: control.by_singular_vectors(held(), x).into),
    "impedance.hz": ([10.0], ["10 Hz"], ["10 s"],
        lambda x: control.impedance(spring(), x, force="drive:1", place="stroke:1")),
    "margins.delay": (1e-4, "0.1 ms", "0.1 mm", lambda x: control.margins(spring(), IFF(20.0), delay=x)),
    "ring_down.period": (1e-3, "1 ms", "1 mm",
        lambda x: control.ring_down(np.exp(-np.arange(100) / 30) * np.cos(np.arange(100)), x, 2)),
    "complementary.corner": (5.0, "5 Hz", "5 s", lambda x: control.complementary(x)[0].A),
    "high_pass.corner": (5.0, "5 Hz", "5 s", lambda x: control.high_pass(x).A),
    "low_pass.corner": (5.0, "5 Hz", "5 s", lambda x: control.low_pass(x).A),
    "integrator.high_pass": (5.0, "5 Hz", "5 s", lambda x: control.integrator(2.0, x).A),
    "lead.crossing": (5.0, "5 Hz", "5 s", lambda x: control.lead(x, 3.0).A),
    "notch.frequency": (5.0, "5 Hz", "5 s", lambda x: control.notch(x).A),
    "pid.low_pass": (5.0, "5 Hz", "5 s", lambda x: control.pid(1.0, 0.0, 1.0, x).A),
    "positive_feedback.frequency": (5.0, "5 Hz", "5 s", lambda x: control.positive_feedback(x, 0.5, 1.0).A),
    "rate.low_pass": (5.0, "5 Hz", "5 s", lambda x: control.rate(1.0, x).A),
    "Scheduled.axes": ({"heave": [-0.1, 0.1]}, {"heave": ["-100 mm", "100 mm"]}, {"heave": ["1 s", "2 s"]},
        lambda x: scheduled(axes=x)),
    "Scheduled.at.pose": ({"heave": 0.05}, {"heave": "50 mm"}, {"heave": "50 s"}, lambda x: scheduled(pose=x)),
}  # fmt: skip

#: What is no quantity: subjects, choices, counts, names, ratios; matrices and gains, whose units follow from channels.
OTHERS = set(
    """
    A B C D D_rate accuracy actuator as_built at axes axial_modes basis budget commands control controller controllers
    corrections count damping data delay_samples denominator depth derivative design direction draws drives elements
    engines fidelity follows force format frequencies friction function gain gains high initial input inputs integral
    into jacobian keep keys kind law least limit low magnify modes most motion name names noise numerator order out
    output outputs parts path place poisson progress proportional quantise ratio residual
    retry_failed rho_inf robot robust samples saturate scheduler section seed self sensor shapes sources speed
    states stiffness store stroke study subject sweep system text tilt title tolerance tracker trials
    units value width workers
    """.split()
)
CHOICES = {"simulate_actuator.load"}  # objects of the model alone
#: A time between samples or its rate: a text has to say which.
TIMES_OR_RATES = {"simulate.sample", "StateSpace.sampled.period", "StateSpace.close.sample", "ring_down.period"}
FUNCTIONS = {name: getattr(fx, name) for name in fx.__all__ if inspect.isfunction(getattr(fx, name, None))}
FUNCTIONS |= {name: getattr(control, name) for name in control.__all__ if inspect.isfunction(getattr(control, name))}
CLASSES = {name: getattr(control, name) for name in control.__all__ if inspect.isclass(getattr(control, name))}
MEASURED = set(
    """
    pose start end guess load hz step duration output_step sample period delay below above corner crossing
    frequency low_pass high_pass lengths time size spacing acceleration parallel_stiffness lowest highest
    """.split()
)


def written(format, name, **options):
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder:
        found = fx.export(ROBOT, format, Path(folder) / (name or "c"), **options)
        return [Path(x).read_text() for x in found.files]


def ends(start, end):
    """Where `time_optimal` begins and ends; the way between takes it ten seconds."""
    return least_time._ends(SCREWS, start, end)


def limits(**given):
    """What `time_optimal` takes the drives to be able to do."""
    found = loaded_path.drive_limits(SCREWS, *(given.get(name) for name in ("speed", "acceleration", "force")))
    return [getattr(found, name) or 0.0 for name in ("speed", "acceleration", "force")]


def tracked(**given):
    """An oscillation of 60 Hz as it is followed between bounds."""
    one = control.Tracker(frequency=30.0, **given)
    state = one.start()
    for k in range(500):
        state = one.step(np.sin(2 * np.pi * 60 * k * 1e-3), state, 1e-3)
    return state


def shaken():
    return fx.loads(fx.model.preset_text("machine-hexapod") + '\n[disturbance]\nfloor = "VC-C"\n')


def scheduled(axes=None, pose=None):
    made = control.Scheduled(axes=axes or {"heave": [-0.1, 0.1]}, controllers=[PID(1.0), PID(3.0)])
    return made.at(pose or {"heave": 0.02}, ["stroke:1"], ["drive:1"]).D


def same(one, other):
    """All numbers alike to the bit."""
    if isinstance(one, xr.Dataset):
        for name in one.variables:
            if str(name).startswith("seconds"):  # of the machine
                continue
            np.testing.assert_array_equal(one[name].values, other[name].values, err_msg=name)
    else:
        np.testing.assert_array_equal(one, other)


def test_every_parameter_of_every_public_call_is_a_quantity_or_known_to_be_none():
    found = {f"{name}.{p}" for name, f in FUNCTIONS.items() for p in inspect.signature(f).parameters}
    words = {x.split(".")[-1] for x in found}
    assert words <= OTHERS | MEASURED, sorted(words - OTHERS - MEASURED)
    quantities = {x for x in found if x.split(".")[-1] in MEASURED} - CHOICES
    assert quantities <= set(CASES), sorted(quantities - set(CASES))


def test_every_field_of_a_controller_and_every_method_of_a_system_is_a_quantity_or_known_to_be_none():
    fields = {f"{name}.{p}" for name, kind in CLASSES.items() for p in inspect.signature(kind).parameters}
    methods = {
        f"StateSpace.{name}.{p}"
        for name, f in inspect.getmembers(control.StateSpace, inspect.isfunction)
        if not name.startswith("_")
        for p in inspect.signature(f).parameters
    }
    words = {x.split(".")[-1] for x in fields | methods}
    assert words <= OTHERS | MEASURED, sorted(words - OTHERS - MEASURED)
    quantities = {x for x in fields | methods if x.split(".")[-1] in MEASURED}
    computed = {"DelayedLoop.delay", "StateSpace.sample"}  # made by `close` and `sampled`, of numbers
    assert quantities - computed <= set(CASES), sorted(quantities - computed - set(CASES))


@pytest.mark.parametrize("name", CASES)
def test_a_text_with_a_unit_is_the_number_in_si_and_another_unit_is_refused(name):
    si, text, wrong, call = CASES[name]
    wanted = call(si)
    same(call(text), wanted)
    if isinstance(si, float) and name not in TIMES_OR_RATES:
        same(call(repr(si)), wanted)
    with pytest.raises(InputError) as error:
        call(wrong)
    assert error.value.allowed, error.value


@pytest.mark.parametrize(
    ("make", "si", "text", "wrong"),
    [
        (lambda x: fx.model.AxisMotion(type="heave", amplitude=x, duration=1.0), 0.01, "10 mm", "10 deg"),
        (lambda x: fx.model.AxisMotion(type="roll", amplitude=x, duration=1.0), 0.01, "10 mrad", "10 mm"),
        (lambda x: fx.model.AxisMotion(type="roll", amplitude=0.1, duration=x), 2.0, "2 s", "2 m"),
        (lambda x: fx.model.CombinedMotion(amplitudes={"surge": x}, duration=1.0), 0.01, "10 mm", "1 deg"),
        (lambda x: fx.model.Waypoint(time=x, heave="5 mm"), 0.5, "500 ms", "5 mm"),
        (lambda x: ROBOT.simulation.replace(step=x), 5e-4, "0.5 ms", "5 mm"),
        (lambda x: ROBOT.robot.payload.replace(mass=x), 90.0, "90 kg", "90 N"),
    ],
)
def test_objects_of_the_model_read_texts_by_the_same_rule(make, si, text, wrong):
    assert make(text) == make(si) == make(repr(si))
    with pytest.raises(InputError):
        make(wrong)
