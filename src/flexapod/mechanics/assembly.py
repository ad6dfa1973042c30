"""The named functions from which every solver is built, Eqs. (T4.7)-(T4.9).

The residuals are exact. The matrices at rest serve equilibria, modes and the iterations of the time integration.
"""

from types import SimpleNamespace

from flexapod.mechanics.layout import COMMAND_SIZE, LEG_PARAMETERS, PAYLOAD_PARAMETERS, Shapes
from flexapod.mechanics.leg import Leg, leg
from flexapod.mechanics.payload import displaced_pose, joint_point, joint_wrench, newton_euler
from flexapod.symbolic.functions import NamedFunction
from flexapod.symbolic.lagrange import inverse_dynamics, mass_matrix
from flexapod.symbolic.vocabulary import (
    SX,
    cross,
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
    """Residual, matrices at rest and energies of one leg with the given shapes."""
    p_vector, p = symbols(LEG_PARAMETERS, "p")
    q, qs = symbols(shapes.layout, "q")
    v, vs = symbols(shapes.layout, "v")
    v_dot, lam, command = symbol("v_dot", shapes.size), symbol("lam", shapes.rows), symbol("command", COMMAND_SIZE)
    body = leg(shapes, p, q, v, qs, vs)
    e = body.lagrangian
    r = leg_residual(shapes, body, p, qs, vs, v_dot, lam, command)
    lost = dot(v, gradient(e.dissipation, v)) + p.drive_damping * (command[1] - vs.l) ** 2
    drive = servo_force(p, qs, vs, command)
    energies = vertcat(e.kinetic, body.gravity, body.strain + 0.5 * p.drive_stiffness * (command[0] - qs.l) ** 2)
    state = [("q", q), ("v", v)]
    parameters = [("command", command), ("p", p_vector)]
    return [
        NamedFunction(
            "leg_residual",
            [*state, ("v_dot", v_dot), ("lam", lam), *parameters],
            [("r", r), ("tip", body.tip), ("powers", vertcat(lost, drive * command[1])), ("drive", drive)],
        ),
        NamedFunction(
            "leg_matrices",
            [("q", q), ("lam", lam), ("p", p_vector)],
            [*matrices_at_rest(shapes, body, p, lam), ("J", jacobian(body.tip[: shapes.rows], q))],
        ),
        NamedFunction("leg_energies", [*state, *parameters], [("energies", energies), ("drive", drive)]),
    ]


def matrices_at_rest(shapes: Shapes, body: Leg, p: SimpleNamespace, lam: SX) -> list[tuple[str, SX]]:
    """Return M, D and K of a leg at rest under the joint force ``lam``, geometric stiffness included, Eq. (T4.8)."""
    e, drive = body.lagrangian, zeros(shapes.size, shapes.size)
    drive[shapes.l_index, shapes.l_index] = 1
    D = hessian(e.dissipation, e.v) + p.drive_damping * drive
    K = hessian(e.potential + dot(body.tip[: shapes.rows], lam), e.q) + p.drive_stiffness * drive
    return [("M", mass_matrix(e)), ("D", D), ("K", K)]


def leg_tangents(shapes: Shapes) -> NamedFunction:
    """dr/dq and dr/dv of a leg in motion (gyroscopic, centrifugal and convective terms included), Eq. (T4.9)."""
    p_vector, p = symbols(LEG_PARAMETERS, "p")
    q, qs = symbols(shapes.layout, "q")
    v, vs = symbols(shapes.layout, "v")
    v_dot, lam, command = symbol("v_dot", shapes.size), symbol("lam", shapes.rows), symbol("command", COMMAND_SIZE)
    body = leg(shapes, p, q, v, qs, vs)
    r = leg_residual(shapes, body, p, qs, vs, v_dot, lam, command)
    inputs = [("q", q), ("v", v), ("v_dot", v_dot), ("lam", lam), ("command", command), ("p", p_vector)]
    return NamedFunction("leg_tangents", inputs, [("r_q", jacobian(r, q)), ("r_v", jacobian(r, v))])


def leg_residual(
    shapes: Shapes,
    body: Leg,
    p: SimpleNamespace,
    qs: SimpleNamespace,
    vs: SimpleNamespace,
    v_dot: SX,
    lam: SX,
    command: SX,
) -> SX:
    """Balance of one leg, M v_dot + h + J^T lam - Q, Eq. (T4.7); the joint takes -lam off the leg's tip.

    Of the drives only the springs are here: forces on driven and held coordinates are added by who knows them.
    """
    r = inverse_dynamics(body.lagrangian, v_dot)
    r += gradient(dot(body.tip[: shapes.rows], lam), body.lagrangian.q)
    r[shapes.l_index] -= servo_force(p, qs, vs, command)
    return r


def servo_force(p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace, command: SX) -> SX:
    """Spring and damper between the commanded and the actual stroke, Eq. (T5.4); zero for a prescribed stroke."""
    return p.drive_stiffness * (command[0] - qs.l) + p.drive_damping * (command[1] - vs.l)


def joint_functions() -> list[NamedFunction]:
    """Point and wrench of a spherical joint of the platform, and their derivatives by the payload's step."""
    pose, step, lam, joint = symbol("pose", 7), symbol("step", 6), symbol("lam", 3), symbol("joint", 3)
    centre, R = displaced_pose(pose, step)
    point, wrench = joint_point(joint, centre, R), joint_wrench(joint, R, lam)
    inputs = [("pose", pose), ("lam", lam), ("joint", joint)]
    outputs = [("point", point), ("wrench", wrench)]
    matrices = [("P", jacobian(point, step)), ("H", -jacobian(wrench, step))]
    return [
        NamedFunction("joint_residual", inputs, [(name, _undisplaced(y, step)) for name, y in outputs]),
        NamedFunction("joint_matrices", inputs, [(name, _undisplaced(y, step)) for name, y in matrices]),
    ]


def _undisplaced(expression: SX, step: SX) -> SX:
    return substitute(expression, (step,), (zeros(6),))


def payload_functions() -> list[NamedFunction]:
    """Residual, matrices at rest and energies of the payload."""
    p_vector, p = symbols(PAYLOAD_PARAMETERS, "p")
    pose, step = symbol("pose", 7), symbol("step", 6)
    u, u_dot, net, wrench = (symbol(name, 6) for name in ("u", "u_dot", "net", "wrench"))
    _, R = displaced_pose(pose, step)
    r = newton_euler(p, R, u, u_dot, net, wrench)
    at_rest = substitute(r, (u, u_dot), (zeros(6), zeros(6)))
    T = 0.5 * p.mass * dot(u[:3], u[:3]) + 0.5 * dot(u[3:], matrix33(p.inertia) @ u[3:])
    tool_velocity = u[:3] + R @ cross(u[3:], p.tool)
    power = dot(wrench[:3], tool_velocity) + dot(wrench[3:], R @ u[3:])
    motion = [("pose", pose), ("u", u), ("u_dot", u_dot), ("net", net), ("wrench", wrench), ("p", p_vector)]
    matrices = [("M", jacobian(r, u_dot)), ("K", jacobian(at_rest, step))]
    return [
        NamedFunction("payload_residual", motion, [("r", _undisplaced(r, step)), ("power", _undisplaced(power, step))]),
        NamedFunction(
            "payload_matrices",
            [("pose", pose), ("wrench", wrench), ("p", p_vector)],
            [(name, _undisplaced(y, step)) for name, y in matrices],
        ),
        NamedFunction(
            "payload_energies",
            [("pose", pose), ("u", u), ("p", p_vector)],
            [("energies", vertcat(T, -p.mass * dot(p.gravity, pose[:3]), 0))],
        ),
    ]
