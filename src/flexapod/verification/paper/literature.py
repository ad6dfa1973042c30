"""The paper's literature and outlook, and where they are here: each with its status and the call that does it.

The table of docs/paper.md is made of this list; a test runs every call.
"""

from __future__ import annotations

from dataclasses import dataclass

HERE, IN_PART, NOT_YET = "here", "in part", "not yet"
HEAD = ("In the paper", "Status", "Here", "Call")
#: Names in the calls: what they stand for.
GIVEN = {
    "study": 'fx.preset("paper-robot")',
    "beam": 'fx.preset("paper-actuator")',
    "machine": 'fx.preset("machine-hexapod")',
    "soft": 'fx.preset("nano-hexapod")',
}


@dataclass(frozen=True, kw_only=True)
class Topic:
    """Topic that the paper names, its status here, and the call that does it.

    `call`: an expression of Python in `fx` and the names of `GIVEN`, empty where there is none; `awaits`: a name of a
    call that would do what is missing, and is not there.
    """

    paper: str
    status: str
    here: str
    call: str = ""
    awaits: str = ""


TOPICS = (
    Topic(
        paper="Table 1, lumped: finite segments (Megahed & Hamza [3]); stiffness and damping lumped on legs with mass "
        "(Lee & Geng [5])",
        status=HERE,
        here='`fidelity = "finite-segment"`; `"lumped"`, one axial spring a leg. [5]\'s legs have mass, as ours',
        call='fx.simulate(study, fidelity="finite-segment", duration=0.02)',
    ),
    Topic(
        paper="Table 1, lumped: an actuator coupled by its impedance, springs and dampers in series and in parallel "
        "(Kim [4])",
        status=HERE,
        here="Springs and dampers of drive, screw, joints and piston in series ([T15](theory/T15-real-parts.md)), a "
        "loop's stiffness and damping in parallel ([T23](theory/T23-drives.md)); impedance over frequency, and the "
        "springs and dampers, in series or in parallel, that have it ([T21](theory/T21-control.md))",
        call='fx.control.impedance(fx.linearize(soft, inputs="drive", outputs="stroke"), [5.0, 20.0], force="drive:1", '
        'place="stroke:1")',
    ),
    Topic(
        paper="Axial stiffness, friction and torques as lumped parameters (Mokhergi et al. [6])",
        status=HERE,
        here='`"lumped"` with [friction](theory/T19-friction.md) of joints and drives',
        call='fx.simulate(machine, fidelity="lumped", duration=0.02)',
    ),
    Topic(
        paper="Damped vibration of a symmetric Stewart robot, all in parameters, with the actuators' inertia "
        "(Afzalifar et al. [7])",
        status=HERE,
        here="`modes` with damping ratios, for any symmetry, inertia of cylinders, pistons and rotors; numbers, not "
        "formulas: a [sweep](sweep.md) over any value",
        call="fx.modes(study)",
    ),
    Topic(
        paper="Table 1, small deformations (Pan et al. [8]), beams with tip masses (Tadikonda & Baruh [9]), assumed "
        "modes with stiffening, tip mass and weight (Khulief & Bedoor [10])",
        status=HERE,
        here='`fidelity = "assumed-modes"`, bases `clamped-free` and `tip-mass` with a tip body; '
        "[theory](theory/T1-bases.md)",
        call='fx.simulate_actuator(beam, basis="tip-mass", duration=0.1)',
    ),
    Topic(
        paper="Bending stress of an arm that slides through a joint which turns and rises, with weight, rotary "
        "inertia, axial force (Yoksel & Gurgoze [11])",
        status=IN_PART,
        here="The single actuator with weight and axial force; in robots also stress of pistons, and rotary inertia "
        "with `shear`. A joint that rises: not yet",
        call="fx.simulate_actuator(beam, duration=0.1)",
    ),
    Topic(
        paper="Arms with prismatic and revolute joints in space, by perturbation (Khadem & Pirmohammadi [12])",
        status=IN_PART,
        here='`space = true` ([T9](theory/T9-actuator.md)), `"1-UPS"`; integrated in time. A perturbation series: '
        "not yet",
        call='fx.simulate_actuator("examples/actuator-in-space.toml", duration=0.02)',
    ),
    Topic(
        paper="An arm along piecewise straight paths under forces and torques (Kalyoncu [13])",
        status=HERE,
        here="Motion by waypoints or a file, `[load]`; where a path bends, steps end "
        "([jumps](devnotes/06-time-steps.md#steps-end-on-jumps-and-corners))",
        call="fx.simulate(study.replace(load=fx.model.Load(wrench=fx.model.ConstantWrench("
        "value=[0, 0, -50, 0, 0, 0]))), duration=0.02)",
    ),
    Topic(
        paper="Coupling of sliding and lateral vibration (Wang et al. [14])",
        status=HERE,
        here="The terms in $\\dot L$ of (T9.2), (T9.8); leaving them out costs 13 % (Eq. 4 in "
        "[T9](theory/T9-actuator.md))",
        call="fx.simulate_actuator(beam, duration=0.1)",
    ),
    Topic(
        paper="Mechanisms of rigid and flexible links, systematically (Nagarjan & Turcic [15])",
        status=HERE,
        here="A leg is a chain of elements, each rigid or not; mechanisms by their chains "
        "([T13](theory/T13-mechanisms.md))",
        call='fx.modes("examples/mechanisms/delta.toml")',
    ),
    Topic(
        paper="Equivalent rigid link with natural shapes, Lagrange and finite elements, validated on one link "
        "(Chang & Gannon [16])",
        status=IN_PART,
        here="The deviation from the rigid robot is the result; natural shapes or elements on the same leg "
        "([the ladder](ladder.md)). Their measurements as a case: not yet, they were not seen",
        call='fx.simulate(study, fidelity="beam-fem", modes=4, duration=0.02)',
    ),
    Topic(
        paper="Symbolic recursive elastodynamics by Newton-Euler and virtual powers, costly for a 6-UPS "
        "(Briot & Khalil [17])",
        status=HERE,
        here="Symbolic as well, by Lagrange, differentiated once and compiled; the legs are eliminated one by one. "
        "2 s of this robot in 0.025 s ([accuracy](accuracy.md))",
        call="fx.simulate(study)",
    ),
    Topic(
        paper="Table 1, actuator for parallel robots (Noorian & Akbarzadeh [18]: rotor, screw and nut, piston)",
        status=HERE,
        here="Screw drives with rotor, nut and active length: [T15](theory/T15-real-parts.md); the three masses are "
        "derived, and their limit is ours, in [T23](theory/T23-drives.md)",
        call="fx.parts(machine)",
    ),
    Topic(
        paper="Table 1, finite elements for tracking by the end point (Moulin & Bayo [19, 20])",
        status=HERE,
        here='Elements: `"beam-fem"`, `"solid-fem"`, `fx.simulate_solid`. Commands that keep the elastic end on its '
        "path: stable inversion, of robots and of the single actuator ([ahead of time](ahead.md))",
        call='fx.compensate(study, "stable-inversion")',
    ),
    Topic(
        paper="Table 1, finite elements with measured frequencies (Tokhi et al. [21-24])",
        status=IN_PART,
        here="The same elements. Their measured frequencies as a case: not yet, no source that gives them with beam, "
        "hub and payload could be read",
        call='fx.simulate_actuator(beam, fidelity="beam-fem", modes=8, duration=0.1)',
    ),
    Topic(
        paper="Table 1, three-dimensional actuators (Li & Sankar [25])",
        status=HERE,
        here='A robot of one leg (`type = "1-UPS"`, `platform.fixed`), every leg of a robot, and the single actuator '
        "with `space = true` ([example](../examples/actuator-in-space.toml))",
        call='fx.simulate_actuator("examples/actuator-in-space.toml", duration=0.02)',
    ),
    Topic(
        paper="Thickness below a tenth of the length: Euler-Bernoulli is valid ([26])",
        status=HERE,
        here='Row "Section 3" below; thicker pistons: `shear = true`',
        call="fx.modes(study)",
    ),
    Topic(
        paper="Table 1, inverse dynamics of rigid robots (Dasgupta & Mruthyunjaya [27])",
        status=HERE,
        here="`fx.inverse_dynamics`, for every mechanism",
        call="fx.inverse_dynamics(study)",
    ),
    Topic(
        paper="4.2, design modifications",
        status=HERE,
        here="Sweeps over any value ([sweep.md](sweep.md)); hollow and thinner pistons in a row below",
        call="fx.stiffness(study)",
    ),
    Topic(
        paper="4.3, a wider range of architectures",
        status=HERE,
        here="`robot.type`: tripods, Tricept, hexaglides, deltas, planar and redundant robots, flexures "
        "([when bending matters](when-bending-matters.md))",
        call='fx.mobility(fx.preset("tripod"))',
    ),
    Topic(
        paper="4.3, joint friction",
        status=HERE,
        here="[Friction](theory/T19-friction.md) of joints, strokes and drives; a row below",
        call="fx.simulate(machine, duration=0.02)",
    ),
    Topic(
        paper="4.3, material imperfections",
        status=HERE,
        here="[Tolerances](as-built.md) of joints, lengths, stiffness, density and bow; a row below",
        call="fx.accuracy(machine, draws=10)",
    ),
    Topic(
        paper="4.3, external disturbances",
        status=HERE,
        here="Floors, wrenches and noise of drives by their spectra ([vibration.md](vibration.md)), and all in one "
        "[error budget](error-budget.md)",
        call='fx.vibration(machine.replace(disturbance=fx.model.Disturbance(floor=fx.model.Floor.by_curve("VC-C"))))',
    ),
    Topic(
        paper="4.4, active vibration control, real-time feedback",
        status=HERE,
        here="Loops about any robot ([control.md](control.md)): force feedback, direct velocity feedback, PID of "
        "strokes and of the tool, laws from files, decoupled, sampled, delayed; in the linear model and in the "
        "march. Commands that leave no vibration ([ahead of time](ahead.md)); rows below",
        call='fx.simulate(soft, controller=fx.control.IFF(100.0, high_pass="5 Hz"), sample="10 kHz", duration=0.01)',
    ),
    Topic(
        paper="4.4, adaptive damping",
        status=HERE,
        here="A damper that finds the frequency of what vibrates ([T21](theory/T21-control.md))",
        call="fx.simulate(soft, controller=fx.control.AdaptiveDamping(gain=1.0, "
        'tracker=fx.control.Tracker(frequency="200 Hz")), sample="10 kHz", duration=0.01)',
    ),
    Topic(
        paper="4.4, new materials and structures",
        status=HERE,
        here="Any section and material; sweeps over any value ([sweep.md](sweep.md)); hollow and thinner pistons in a "
        "row below",
        call='fx.modes(study.with_values({"leg.piston.material": "titanium"}))',
    ),
    Topic(
        paper="4.4, thermal, fluidic, electromagnetic effects",
        status=IN_PART,
        here="[Heat](as-built.md) that stretches legs and plates; columns of oil, ripple and lag of motors "
        "([T23](theory/T23-drives.md)). Fields: not yet",
        call='fx.parts(fx.preset("motion-base"))',
    ),
    Topic(
        paper="4.4, experiments with prototypes",
        status=IN_PART,
        here="Experiments of our own: not yet. What a program can bring to one is here: frequencies, shapes and "
        "damping for a modal test, measured responses laid over ours, forces, stresses and the tool's path as "
        "files, published measurements and independent programs as cases ([verification.md](verification.md))",
        call="fx.compliance(machine, [10.0, 50.0])",
    ),
    Topic(
        paper="4.4, experiments: a model fitted to what was measured",
        status=NOT_YET,
        here="Frequency responses that were measured are read (`fx.read_frf`) and compared, not fitted",
        awaits="identify",
    ),
    Topic(
        paper="4.4, control that accounts for elastic deformation and compensates it",
        status=HERE,
        here="Commands that make up for weight, inertia and modes ([ahead of time](ahead.md)); a row below",
        call="fx.compensate(study, 2)",
    ),
)


def literature_markdown() -> str:
    """The list as a table in Markdown."""
    lines = [HEAD, ("---",) * len(HEAD)]
    lines += [(t.paper, f"**{t.status}**", t.here, f"`{t.call}`" if t.call else "") for t in TOPICS]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)
