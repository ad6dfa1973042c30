"""The named functions from which every solver is built: exact residuals, matrices at rest, Eqs. (T4.7)-(T4.9)."""

from collections.abc import Sequence

from flexapod.common.arrays import Array
from flexapod.mechanics.elements.drive_train import DriveTrain
from flexapod.mechanics.elements.element import MovingLeg, extra_loop_force
from flexapod.mechanics.elements.motor_loop import MotorLoop
from flexapod.mechanics.elements.mount import plate
from flexapod.mechanics.elements.servo import Servo
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.trial import hook_error
from flexapod.mechanics.leg.layout import LOAD_SIZE, Shapes, leg_parameters, payload_parameters
from flexapod.mechanics.leg.leg import leg
from flexapod.mechanics.leg.own_elements import parts_without_number, refuse_unfit
from flexapod.mechanics.leg.payload import (
    ball_closure,
    displaced_pose,
    joint_point,
    joint_wrench,
    load_force,
    newton_euler,
    plate_balance,
    plate_frame,
    pose_closure,
)
from flexapod.mechanics.symbolic.functions import NamedFunction, inverse_dynamics, mass_matrix
from flexapod.mechanics.symbolic.vocabulary import (
    SX,
    ChainRule,
    cross,
    depends_on,
    dot,
    gradient,
    hessian,
    jacobian,
    matrix33,
    substitute,
    symbol,
    symbols,
    vertcat,
    zeros,
)


def leg_functions(shapes: Shapes) -> list[NamedFunction]:
    """Residual, matrices at rest, energies and rates of the closure of one leg with the given shapes."""
    x = _Leg(shapes)
    x.refuse_unfit()
    looping = [x.looping()] if shapes.holds(MotorLoop) else []
    return [x.residual(), x.matrices(), x.energies(), x.closing(), *looping]


def leg_tangents(shapes: Shapes) -> NamedFunction:
    """dr/dq and dr/dv of a leg in motion (gyroscopic, centrifugal and convective terms included), Eq. (T4.9)."""
    x = _Leg(shapes)
    r = x.balance()
    return x.make_function("leg_tangents", x.moving(), [("r_q", jacobian(r, x.q)), ("r_v", jacobian(r, x.v))])


def leg_pushes(shapes: Shapes) -> NamedFunction:
    """Function of the terms that nonpotential forces of parts add to D and K, Eq. (T20.3)."""
    x = _Leg(shapes)
    D, K = x.nonpotential_slopes()
    D = substitute(D, (x.v,), (zeros(shapes.size),))
    return x.make_function("leg_pushes", [("q", x.q), ("p", x.p_vector)], [("D", D), ("K", K)])


def leg_carried(shapes: Shapes) -> NamedFunction:
    """Masses between the coordinates of a leg and the motion of the base that carries it, Eq. (T20.9)."""
    x = _Leg(shapes)
    first = shapes.index("g")
    M = mass_matrix(x.body.lagrangian)[first : first + 6, :]
    return x.make_function("leg_carried", [("q", x.q), ("p", x.p_vector)], [("M", M)])


def leg_tip(shapes: Shapes) -> NamedFunction:
    """Derivatives of the place of the tip by the coordinates of a leg, (3, n)."""
    x = _Leg(shapes)
    return x.make_function("leg_tip", [("q", x.q), ("p", x.p_vector)], [("J", x.by_q.jacobian(x.body.tip))])


def parts_of_elements(shapes: Shapes, values: Sequence[Array]) -> dict[Slot, list[str]]:
    """Parts of each external element that are no number for coordinates, rates and parameters of a leg."""
    x = _Leg(shapes)
    variables = x.variables()
    own = (one for one in shapes.elements if one.kind.at)
    return {one: parts_without_number(x.body.elements[one], x.damping_forces(one), variables, values) for one in own}


def leg_line(shapes: Shapes) -> NamedFunction:
    """The line from the base joint of a leg to its tip, (3,), and its derivatives by the leg's coordinates, (3, n)."""
    x = _Leg(shapes)
    line = x.body.tip - x.body.foot
    outputs = [("line", x.by_q.value(line)), ("J", x.by_q.jacobian(line))]
    return x.make_function("leg_line", [("q", x.q), ("p", x.p_vector)], outputs)


class _Leg:
    """The inputs of the functions of a leg, its equations, and the springs of its drives by coordinate."""

    def __init__(self, shapes: Shapes) -> None:
        self.shapes = shapes
        self.p_vector, self.p = symbols(leg_parameters(shapes), "p")
        self.q, self.qs = symbols(shapes.layout, "q")
        self.v, self.vs = symbols(shapes.layout, "v")
        self.v_dot, self.lam = symbol("v_dot", shapes.size), symbol("lam", shapes.rows)
        self.command, self.pose, self.load = (
            symbol("command", shapes.commands),
            symbol("pose", 7),
            symbol("load", LOAD_SIZE),
        )
        self.body = leg(shapes, self.p, self.q, self.v, self.qs, self.vs)
        self.by_q = ChainRule(x=self.q, y=self.body.theta, of_x=self.body.turn)
        self.servos = {
            shapes.index(name): Servo(
                stiffness=getattr(self.p, f"{drive}_stiffness"),
                damping=getattr(self.p, f"{drive}_damping"),
                q=getattr(self.qs, name),
                v=getattr(self.vs, name),
                q_cmd=self.command[2 * i],
                v_cmd=self.command[2 * i + 1],
                more=self._asked_of(drive),
            )
            for i, (name, drive) in enumerate(shapes.drives)
        }

    def _asked_of(self, drive: str) -> SX | None:
        beside = drive == "rotor" and not self.shapes.holds(MotorLoop)
        return extra_loop_force(self.shapes.elements, self.p, self.qs) if beside else None

    @property
    def elements(self) -> tuple[Slot, ...]:
        """Elements of the kernel."""
        return self.shapes.elements

    def as_moving(self) -> MovingLeg:
        """Leg as hooks of elements read it."""
        rotor = self.servos.get(self.shapes.index("r")) if self.shapes.has("r") else None
        none = zeros(1)
        return MovingLeg(
            p=self.p, q=self.qs, v=self.vs, q_cmd=none if rotor is None else rotor.q_cmd,
            v_cmd=none if rotor is None else rotor.v_cmd, foot=self.body.foot, tip=self.body.tip,
            elements=self.elements, rate=lambda place: jacobian(place, self.q) @ self.v,
        )  # fmt: skip

    def nonpotential_forces(self) -> SX:
        """Sum of the elements' nonpotential terms in the balance of coordinates."""
        r, x = zeros(self.shapes.size), self.as_moving()
        for element in self.elements:
            for name, push in element.nonpotential_force(x).items():
                r[self.shapes.index(name)] += push
        return r

    def element_damping(self) -> dict[int, SX]:
        """Damping forces without a dissipation, by position; of coordinates of several numbers a column."""
        found: dict[int, SX] = {}
        for element in self.elements:
            for name, force in self.damping_forces(element).items():
                at = self.shapes.index(name)
                found[at] = found[at] + force if at in found else force
        return found

    def damping_forces(self, element: Slot) -> dict[str, SX]:
        """Damping forces of one element by coordinate."""
        found = element.damping_force(self.p, self.qs, self.vs)
        for name, force in found.items():
            size = dict(self.shapes.layout).get(name)
            if size != SX(force).numel():
                held = f"one of {size} numbers" if size else "that a leg does not have"
                raise hook_error(element.kind, "damping_force", f"is on a coordinate {held}", value=name)
        return {name: SX(force) for name, force in found.items()}

    def variables(self) -> tuple[tuple[str, SX], ...]:
        """Coordinates, rates and parameters by name."""
        return ("q", self.q), ("v", self.v), ("p", self.p_vector)

    def refuse_unfit(self) -> None:
        """Refuse external elements that have no equations of motion, with class and file."""
        variables = self.variables()
        for one in self.elements:
            if one.kind.at:
                refuse_unfit(one, self.body.elements[one], self.damping_forces(one), variables)

    def own_inertia(self) -> dict[int, tuple[SX | float, SX | float]]:
        """Mass and damper of coordinates that have them without an energy, by position."""
        found = (x for element in self.elements for x in element.inertia(self.p).items())
        return {self.shapes.index(name): pair for name, pair in found}

    def make_function(self, name: str, inputs: list[tuple[str, SX]], outputs: list[tuple[str, SX]]) -> NamedFunction:
        """Function of expressions that are differentiated."""
        here, value = self.body.present
        return NamedFunction(name, inputs, [(key, substitute(y, (here,), (value,))) for key, y in outputs])

    def moving(self) -> list[tuple[str, SX]]:
        """Inputs of what a leg in motion does."""
        state = [("q", self.q), ("v", self.v), ("v_dot", self.v_dot), ("lam", self.lam), ("command", self.command)]
        return [*state, ("p", self.p_vector), *self.outside()]

    def outside(self) -> list[tuple[str, SX]]:
        """External inputs of the leg: the payload's pose, or the load on a tip without payload."""
        if self.shapes.reads_pose:
            return [("pose", self.pose)]
        return [("load", self.load)] if self.shapes.has_tip_load else []

    def closure_terms(self, step: SX) -> tuple[SX, SX]:
        """Residual of the closure (of a point closure: the tip), and the wrench of ``lam`` on the payload."""
        if self.shapes.has("gamma1"):
            return pose_closure(self.body, self.qs, self.p, self.lam, self.pose, step)
        if self.shapes.reads_pose:
            return ball_closure(self.body, self.qs, self.p, self.lam, self.pose, step)
        return self.body.tip[: self.shapes.rows], zeros(0)

    def balance(self) -> SX:
        """Balance of one leg, M v_dot + h + J^T lam - Q, Eq. (T4.7); the joint takes -lam off the leg's tip.

        Of the drives only the springs are here: forces on driven and held coordinates are added by who knows them.
        """
        r = inverse_dynamics(self.body.lagrangian, self.v_dot)
        r += self.by_q.gradient(dot(self.closure_terms(zeros(6))[0], self.lam))
        if self.shapes.has_tip_load:
            r -= self.load_force()
        for i, servo in self.servos.items():
            r[i] -= servo.force
        for i, (mass, damper) in self.own_inertia().items():
            r[i] += mass * self.v_dot[i] + damper * self.v[i]
        for i, force in self.element_damping().items():
            r[i : i + force.numel()] += force
        return r + self.nonpotential_forces()

    def nonpotential_slopes(self) -> tuple[SX, SX]:
        """Derivatives by rates and by places, at rest, of what has no energy."""
        rows, still = self.nonpotential_forces(), zeros(self.shapes.size)
        for i, servo in self.servos.items():
            if servo.more is not None:
                rows[i] -= servo.more
        return jacobian(rows, self.v), substitute(jacobian(rows, self.q), (self.v,), (still,))

    def looping(self) -> NamedFunction:
        """Function of the unsymmetric terms of loops and lags in D and K, the measured place and its slope."""
        (D, K), place = self.nonpotential_slopes(), MotorLoop.place(self.as_moving())
        outputs = [("D", D), ("K", K), ("place", place), ("slope", jacobian(place, self.q).T)]
        return self.make_function("leg_loop", [("q", self.q), ("p", self.p_vector)], outputs)

    def residual(self) -> NamedFunction:
        """Balance, closure, powers (lost, given, of a load) and forces of the drives' springs."""
        loss = dot(self.v, gradient(self.body.lagrangian.dissipation, self.v))
        lost = sum((servo.damper_power for servo in self.servos.values()), loss)
        for i, force in self.element_damping().items():
            lost += dot(force, self.v[i : i + force.numel()])
        given = sum((servo.input_power for servo in self.servos.values()), zeros(1))
        given += sum(
            (x for element in self.elements if (x := element.input_power(self.as_moving())) is not None), zeros(1)
        )
        powers = [lost, given, *([dot(self.load_force(), self.v)] if self.shapes.has_tip_load else [])]
        gap, wrench = (self.by_q.value(x) for x in self.closure_terms(zeros(6)))
        meeting = [("gap", gap), ("wrench", wrench)] if self.shapes.reads_pose else [("tip", self.body.tip)]
        outputs = [("r", self.balance()), *meeting, ("powers", vertcat(*powers)), ("drive", self.forces())]
        return self.make_function("leg_residual", self.moving(), outputs)

    def load_force(self) -> SX:
        """Generalised force of the load on the tip."""
        return load_force(self.body, self.by_q, self.load)

    def forces(self) -> SX:
        """Forces of the drives' springs; of a stroke that is driven through springs theirs on it, Eq. (T15.11)."""
        forces = [servo.force for servo in self.servos.values()]
        if self.shapes.holds(MotorLoop):
            x = self.as_moving()
            forces[-1] += MotorLoop.force(x, MotorLoop.requested_force(x))
        if self.shapes.has("r"):
            series = self.body.elements[Slot(DriveTrain)]
            forces[0] -= gradient(series.strain, self.qs.l) + gradient(series.dissipation, self.vs.l)
        return vertcat(*forces)

    def matrices(self) -> NamedFunction:
        """M, D and K at rest under ``lam``, geometric stiffness included, and the closure's derivatives, Eq. (T4.8)."""
        e, step = self.body.lagrangian, symbol("step", 6)
        gap, wrench = self.closure_terms(step)
        here = _undisplaced(gap, step)
        D = self.damping()
        K = self.by_q.hessian(e.potential + dot(here, self.lam))
        if self.shapes.has_tip_load:
            K -= jacobian(self.load_force(), e.q)
        for i, servo in self.servos.items():
            D[i, i] += servo.damping
            K[i, i] += servo.stiffness
        M = mass_matrix(e)
        for i, (mass, damper) in self.own_inertia().items():
            M[i, i], D[i, i] = M[i, i] + mass, D[i, i] + damper
        outputs = [("M", M), ("D", D), ("K", K), ("J", self.by_q.jacobian(here))]
        if self.shapes.reads_pose:  # (T13.14)-(T13.15)
            outputs += [
                (name, self.by_q.value(_undisplaced(-jacobian(y, step), step)))
                for name, y in (("P", gap), ("H", wrench))
            ]
            outputs.append(("X", -self.by_q.jacobian(_undisplaced(wrench, step)).T))
        return self.make_function(
            "leg_matrices", [("q", self.q), ("lam", self.lam), ("p", self.p_vector), *self.outside()], outputs
        )

    def damping(self) -> SX:
        """Slope of what dissipations and damping forces do by the rates, at rest."""
        e = self.body.lagrangian
        D = hessian(e.dissipation, e.v)
        for i, force in self.element_damping().items():
            D[i : i + force.numel(), :] += jacobian(force, e.v)
        return substitute(D, (e.v,), (zeros(self.shapes.size),)) if depends_on(D, e.v) else D

    def closing(self) -> NamedFunction:
        """Function of the closure's residual and its rate (of a point closure: those of the tip)."""
        step, u = symbol("step", 6), symbol("u", 6)
        gap = self.closure_terms(step)[0]
        here = _undisplaced(gap, step)
        rate = self.by_q.jacobian(here) @ self.v
        inputs = [("q", self.q), ("v", self.v), ("p", self.p_vector), *self.outside()]
        if self.shapes.reads_pose:
            rate += self.by_q.value(_undisplaced(jacobian(gap, step), step)) @ u
            inputs.append(("u", u))
        return self.make_function("leg_closing", inputs, [("gap", self.by_q.value(here)), ("rate", rate)])

    def energies(self) -> NamedFunction:
        """Kinetic energy, potential of gravity and strain energy, the drives' springs included."""
        body = self.body
        strain = sum((servo.energy for servo in self.servos.values()), body.strain)
        return self.make_function(
            "leg_energies",
            [("q", self.q), ("v", self.v), ("command", self.command), ("p", self.p_vector)],
            [("energies", vertcat(body.lagrangian.kinetic, body.gravity, strain)), ("drive", self.forces())],
        )


def joint_functions() -> list[NamedFunction]:
    """Point and wrench of a spherical joint of the platform, their derivatives by its step, and the point's rate."""
    u = symbol("u", 6)
    pose, step, lam, joint = symbol("pose", 7), symbol("step", 6), symbol("lam", 3), symbol("joint", 3)
    centre, R = displaced_pose(pose, step)
    point, wrench = joint_point(joint, centre, R), joint_wrench(joint, R, lam)
    inputs = [("pose", pose), ("lam", lam), ("joint", joint)]
    outputs = [("point", point), ("wrench", wrench)]
    matrices = [("P", jacobian(point, step)), ("H", -jacobian(wrench, step))]
    return [
        NamedFunction("joint_residual", inputs, [(name, _undisplaced(y, step)) for name, y in outputs]),
        NamedFunction("joint_matrices", inputs, [(name, _undisplaced(y, step)) for name, y in matrices]),
        NamedFunction(
            "joint_closing",
            [("pose", pose), ("u", u), ("joint", joint)],
            [("point", _undisplaced(point, step)), ("rate", _undisplaced(jacobian(point, step), step) @ u)],
        ),
    ]


def _undisplaced(expression: SX, step: SX) -> SX:
    return substitute(expression, (step,), (zeros(6),))


def payload_functions(shapes: Shapes) -> list[NamedFunction]:
    """Residual, matrices at rest and energies of the payload, with the plate below it if it is on a mount."""
    p_vector, p = symbols(payload_parameters(shapes), "p")
    pose, step = symbol("pose", 7), symbol("step", 6)
    u, u_dot, net, wrench = (symbol(name, 6) for name in ("u", "u_dot", "net", "wrench"))
    m = tuple(symbol(name, shapes.plate) for name in ("m", "m_rate", "m_acceleration"))
    names, still = ("m", "m_rate", "m_acceleration"), [zeros(shapes.plate)] * 2
    _, R = displaced_pose(pose, step)
    r = newton_euler(p, R, u, u_dot, net, wrench)
    T = 0.5 * p.mass * dot(u[:3], u[:3]) + 0.5 * dot(u[3:], matrix33(p.inertia) @ u[3:])
    weight = -p.mass * dot(p.gravity, pose[:3])
    if shapes.plate:
        r = vertcat(r, zeros(6)) + plate_balance(p, R, u, u_dot, m)
        below = plate(plate_frame(p, R, u, *m[:2]), zeros(3), p.plate_mass, p.plate_inertia, p.plate_weighs * p.gravity)
        T, weight = T + below.kinetic, weight + below.gravity - p.plate_weighs * dot(p.gravity, pose[:3])
    at_rest = substitute(r, (u, u_dot, *m[1:]), (zeros(6), zeros(6), *still))
    tool_velocity = u[:3] + R @ cross(u[3:], p.tool)
    power = dot(wrench[:3], tool_velocity) + dot(wrench[3:], R @ u[3:])
    motion = [("pose", pose), ("u", u), ("u_dot", u_dot), ("net", net), ("wrench", wrench), ("p", p_vector)]
    plates = list(zip(names, m, strict=True)) if shapes.plate else []
    matrices = [("M", jacobian(r, vertcat(u_dot, m[2]))), ("K", jacobian(at_rest, vertcat(step, m[0])))]
    energies = _undisplaced(vertcat(T, weight, 0), step)
    return [
        NamedFunction(
            "payload_residual",
            [*motion, *plates],
            [("r", _undisplaced(r, step)), ("power", _undisplaced(power, step))],
            alone=True,
        ),
        NamedFunction(
            "payload_matrices",
            [("pose", pose), ("wrench", wrench), ("p", p_vector), *plates[:1]],
            [(name, _undisplaced(substitute(y, m[1:], still), step)) for name, y in matrices],
            alone=True,
        ),
        NamedFunction(
            "payload_energies",
            [("pose", pose), ("u", u), ("p", p_vector), *plates[:2]],
            [("energies", energies)],
            alone=True,
        ),
    ]
