"""Loops about a robot, as the pages on control show them: every controller, margins, loci, best gains."""

import json

import numpy as np

import flexapod as fx
from flexapod.control import (
    DVF,
    IFF,
    PID,
    Decentralised,
    Decoupled,
    Fused,
    Scheduled,
    StateSpace,
    Together,
    best_gain,
    by_jacobian,
    by_modes,
    by_singular_vectors,
    centre_of_stiffness,
    complementary,
    gain,
    high_pass,
    impedance,
    integrator,
    lead,
    low_pass,
    margins,
    notch,
    pid,
    positive_feedback,
    rate,
    ring_down,
    robot_jacobian,
    root_locus,
)

study = fx.preset("nano-hexapod")
sensors = ["tool", "stroke", "force-sensor:drive", "force-sensor:base", "encoder"]
plant = fx.linearize(study, inputs=["drive", "wrench"], outputs=sensors).reduce(below="2 kHz")


def slowest(system):
    """Damping ratios of the suspension."""
    poles = system.damp()
    return poles.damping_ratio.values[(poles.frequency > 100) & (poles.frequency < 600) & (poles.damping_ratio < 1)]


laws = {
    "IFF": IFF(200.0, high_pass="5 Hz"),
    "IFF beside": IFF(200.0, high_pass="5 Hz", parallel_stiffness="10 kN/m", sensor="force-sensor:base"),
    "DVF": DVF(100.0, low_pass="3 kHz", sensor="stroke"),
    "PID": PID(1e4, 1e5, 50.0, low_pass="2 kHz"),
    "Decentralised": Decentralised(integrator(100.0, high_pass="5 Hz"), sensor="force-sensor:drive"),
    "positive": Decentralised(positive_feedback("400 Hz", 0.3, -1e4), sensor="stroke"),
    "Fused": Fused(rate(50.0, "2 kHz"), low="stroke", high="encoder", corner="50 Hz"),
    "Together": Together((IFF(100.0, high_pass="5 Hz"), DVF(50.0, low_pass="3 kHz"))),
}
J = robot_jacobian(study.robot, "com")
frame = by_jacobian(J)
laws["Decoupled"] = frame.controller(lead("50 Hz", 3.0) * (gain(1e3) + integrator(1e4)))
laws["by hand"] = Decoupled(rate(20.0, "3 kHz"), into=np.linalg.inv(J), out=np.linalg.inv(J).T)
strokes = plant.select("drive", "stroke")
laws["modes"] = by_modes(plant, count=6, above="50 Hz").controller(rate(20.0, "3 kHz"))
laws["vectors"] = by_singular_vectors(strokes, "300 Hz").controller(rate(20.0, "3 kHz"))

law = laws["IFF"]
held = margins(plant, law, delay="0.1 ms")
locus = root_locus(plant, law, np.geomspace(0.1, 10, 5))
best = best_gain(plant, law, below="600 Hz")
loop = plant.close(law)
sampled = plant.close(law, sample="10 kHz", delay="0.1 ms")
schedule = Scheduled(
    axes={"heave": [-1e-4, 1e-4]}, controllers=[DVF(100.0, low_pass="3 kHz"), DVF(200.0, low_pass="3 kHz")]
)
below, above = complementary("20 Hz", 2)

two = StateSpace(
    A=np.array([[0.0, 1.0], [-1e4, -1.0]]), B=np.array([[0.0], [1.0]]), C=np.array([[1.0, 0.0]]), D=np.zeros((1, 1)),
    inputs=("force",), outputs=("place",), states=("x", "v"), units={"force": "N", "place": "m"},
)  # fmt: skip
t = 1e-3 * np.arange(200)
fitted = ring_down(np.exp(-2 * t) * np.cos(60 * t), 1e-3, 2)
filters = {
    "notch": notch("50 Hz", 0.5, 0.1),
    "low": low_pass("50 Hz", 2),
    "high": high_pass("50 Hz"),
    "pid": pid(1.0, 2.0, 3e-3, "200 Hz"),
    "below": below,
    "above": above,
}


def sizes(one):
    """Responses at two frequencies."""
    closed = Decentralised(one, sensor="place", actuator="force").on(two.outputs, two.inputs)
    return [closed.B.shape, closed.D]


found = {
    "damping": {name: slowest(plant.close(one)) for name, one in laws.items()},
    "channels": {name: [loop.inputs, loop.outputs] for name, loop in {"IFF": loop}.items()},
    "margins": {name: held[name].values for name in ("modulus_margin", "delay_margin", "phase_margin")},
    "unstable": held.attrs["unstable_poles"],
    "locus": [sorted(locus.data_vars), list(locus.sizes), np.sort(locus.damping_ratio.values[-1])[:6]],
    "best": [float(best.gain), float(best.damping_ratio)],
    "sampled": np.sort(np.abs(sampled.poles()))[-4:],
    "scheduled": schedule.at({"heave": 0.0}, plant.outputs, plant.inputs).D,
    "stiffness": centre_of_stiffness(J),
    "impedance": sorted(impedance(two, [1.0, 10.0], force="force", place="place").data_vars),
    "ring_down": np.sort(fitted.real),
    "filters": {name: sizes(one) for name, one in filters.items()},
    "hinf": loop.select("wrench:fz", "tool:z").hinf().hinf_norm.values,
    "h2": loop.h2("wrench", "tool").h2_norm.values,
    "h2_noise": plant.close(DVF(100.0, low_pass="3 kHz")).h2("noise:stroke:1", "tool:z").h2_norm.values,
    "rga": strokes.rga([100.0]).relative_gain.sel(part="real").values[0].ravel(),
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
