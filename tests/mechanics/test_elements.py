"""Every element of a leg keeps one contract: balance of power, mass, a turned world, the rigid limit, a theory page."""

from pathlib import Path

import numpy as np
import pytest
from tests.helpers import legs_of_all_kinds as legs

from flexapod.kinematics.rotations import displace_pose, matrix, quaternion

pytestmark = pytest.mark.contract

ROOT = Path(__file__).parents[2]
KINDS = list(legs.KINDS)
SEEDS = range(4)
every_kind = pytest.mark.parametrize("kind", KINDS)
every_pose = pytest.mark.parametrize(
    "kind", [kind for kind in KINDS if legs.KINDS[kind].get("closure") == "pose" or "frames" in kind]
)


def joint_force(ours, x):
    """J^T lam, what the closure takes off a leg."""
    J = legs.call(ours, "leg_matrices", x)["J"]
    return J.T @ x["lam"] if ours.rows else np.zeros(ours.size)


def along(x, command_rate, h):
    """The state a time h later."""
    q, v = x["q"] + h * x["v"] + 0.5 * h**2 * x["v_dot"], x["v"] + h * x["v_dot"]
    return x | {"q": q, "v": v, "command": x["command"] + h * command_rate}


def slope(f, h=1e-5):
    """Derivative of f at 0, of fourth order."""
    return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h)


@every_kind
@pytest.mark.parametrize("seed", SEEDS)
def test_power_balances(kind, seed):
    # d(T + V)/dt + lost = given + power of the forces on the coordinates, whatever the motion.
    ours = legs.shapes(kind)
    x = legs.state(ours, seed, 1e-2)
    rates = np.zeros(ours.commands)
    rates[::2] = x["command"][1::2]
    found = legs.call(ours, "leg_residual", x)
    lost, given = found["powers"][0], found["powers"][1:].sum()  # a load's power last
    change = slope(lambda h: legs.call(ours, "leg_energies", along(x, rates, h))["energies"].sum())
    power = x["v"] @ (found["r"] - joint_force(ours, x))
    # Differences of fourth order at 1e-5 s leave 1e-9 of what moves: rounding of energies of some thousand joules.
    scale = np.abs(x["v"] * found["r"]).sum() + abs(given) + lost
    assert change + lost == pytest.approx(given + power, abs=1e-7 * scale)
    assert lost >= 0


@every_kind
@pytest.mark.parametrize("seed", SEEDS)
def test_mass_and_damping_are_not_negative(kind, seed):
    ours = legs.shapes(kind)
    found = legs.call(ours, "leg_matrices", legs.state(ours, seed))
    for name in "MD":
        values = np.linalg.eigvalsh(0.5 * (found[name] + found[name].T))
        assert values[0] > -1e-12 * values[-1]
        np.testing.assert_allclose(found[name], found[name].T, atol=1e-12 * values[-1])


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "planar" and "that move" not in kind])
def test_a_turned_world_gives_the_same_numbers(kind):
    ours, W = legs.shapes(kind), legs.rotation(np.random.default_rng(9))
    given = legs.numbers(2)
    there = given | {
        name: W @ given[name] for name in ("gravity", "base", "carriage_axis", "carriage_com", "carriage_arm", "R0")
    }
    x = legs.state(ours, 2, given=given)
    y = x | {"p": legs.parameters(ours, there)}
    y["pose"] = np.concatenate([W @ x["pose"][:3], quaternion(W @ matrix(x["pose"][3:]))])
    if ours.rows:
        y["lam"] = np.concatenate([W @ x["lam"][:3], x["lam"][3:]])
    y["load"] = np.concatenate([W @ x["load"][:3], W @ x["load"][3:6], x["load"][6:]])
    here, moved = (legs.call(ours, "leg_residual", z) for z in (x, y))
    for name in ("r", "powers", "drive"):
        np.testing.assert_allclose(moved[name], here[name], rtol=1e-10, atol=1e-10)
    for name in {"tip", "gap", "wrench"} & set(here):
        np.testing.assert_allclose(moved[name], np.concatenate([W @ here[name][:3], here[name][3:]]), atol=1e-12)
    energies = [legs.call(ours, "leg_energies", z)["energies"] for z in (x, y)]
    np.testing.assert_allclose(energies[1], energies[0], rtol=1e-11)


STIFF = {
    "drive_stiffness": ("l",), "EA": ("c",), "EI": ("a", "b"), "GJ": ("t",), "carriage_stiffness": ("chi",),
    "base_stiffness": ("alpha", "beta", "spin"), "gamma_stiffness": ("gamma1", "gamma2", "gamma3"),
    "base_flexure": ("u1", "u2", "u3", "alpha", "beta", "spin"),
    "platform_flexure": ("e1", "e2", "e3", "gamma1", "gamma2", "gamma3"),
    "rotor_stiffness": ("r",), "base_soft": ("u1", "u2", "u3"), "platform_soft": ("e1", "e2", "e3"),
}  # fmt: skip


@pytest.mark.parametrize("element", STIFF)
def test_an_endlessly_stiff_element_is_a_rigid_one(element):
    # Compliance of the tip under loads: held coordinates are the limit, and the way there is one over the stiffness.
    first, _, last = element.partition("_")
    kinds = {"flexure": "flexures on a crank", "soft": "pose between soft joints", "rotor": "pose behind a screw"}
    ours = legs.shapes(kinds.get(last, kinds.get(first, "pose on a slider")))
    held = [i for i, name in enumerate(n for n, size in ours.layout for _ in range(size)) if name in STIFF[element]]
    free = np.setdiff1d(np.arange(ours.size), held)
    home = {"base_home": np.zeros(3), "gamma_home": np.zeros(3), "gravity": np.zeros(3)}

    def compliance(factor, kept):
        given = legs.numbers(4, **home)
        x = legs.state(ours, 4, 0.0, given | {element: factor * np.asarray(given[element])})
        x["q"][[i for i in range(ours.size) if i != ours.l_index]] = 0.0
        x["lam"][:] = 0.0
        found = legs.call(ours, "leg_matrices", x)
        K, J = found["K"][np.ix_(kept, kept)], found["J"][:, kept]
        return J @ np.linalg.solve(K, J.T)

    rigid = compliance(1.0, free)
    gaps = [np.linalg.norm(compliance(factor, np.arange(ours.size)) - rigid) for factor in (1e5, 1e6)]
    assert gaps[0] < 0.1 * np.linalg.norm(rigid)
    assert gaps[0] / gaps[1] == pytest.approx(10, rel=1e-2)


@every_kind
@pytest.mark.parametrize("seed", SEEDS)
def test_matrices_are_the_derivatives_of_the_residual(kind, seed):
    # At rest, under forces at the joint or loads on the tip: geometric stiffness is in. Rates and accelerations enter
    # as polynomials of low degree, of which differences over 1 are exact.
    ours = legs.shapes(kind)
    x = legs.state(ours, seed, 1e-2)
    x["v"], x["v_dot"] = np.zeros(ours.size), np.zeros(ours.size)
    found = legs.call(ours, "leg_matrices", x)
    for kept, name, h in (("K", "q", 1e-3), ("D", "v", 1.0), ("M", "v_dot", 1.0)):

        def residual(step, name=name):
            return legs.call(ours, "leg_residual", x | {name: x[name] + step})["r"]

        reference = np.array([slope(lambda h, e=e, r=residual: r(h * e), h) for e in np.eye(ours.size)]).T
        np.testing.assert_allclose(found[kept], reference, atol=1e-8 * np.abs(reference).max())


@every_pose
@pytest.mark.parametrize("seed", SEEDS)
def test_derivatives_of_a_pose_closure(kind, seed):
    # Central differences of fourth order at 1e-3 and their rounding: 1e-9 of the largest entry.
    ours = legs.shapes(kind)
    x = legs.state(ours, seed, 1e-2)
    x["v"], x["v_dot"] = np.zeros(ours.size), np.zeros(ours.size)
    found = legs.call(ours, "leg_matrices", x)

    def at(q=0.0, step=None):
        pose = x["pose"] if step is None else displace_pose(x["pose"], step)
        return legs.call(ours, "leg_residual", x | {"q": x["q"] + q, "pose": pose})

    def by_q(name):
        return np.array([slope(lambda h, e=e: at(q=h * e)[name], 1e-3) for e in np.eye(ours.size)]).T

    def by_step(name):
        return np.array([slope(lambda h, e=e: at(step=h * e)[name], 1e-3) for e in np.eye(6)]).T

    # X twice: what a coordinate does to the payload's wrench, and what a step of the payload does to the leg's balance.
    expected = [("J", by_q("gap")), ("P", -by_step("gap")), ("H", -by_step("wrench"))]
    expected += [("X", -by_q("wrench").T), ("X", by_step("r"))]
    for name, reference in expected:
        np.testing.assert_allclose(found[name], reference, atol=1e-8 * np.abs(reference).max(), err_msg=name)
    wrench = legs.call(ours, "leg_residual", x)["wrench"]
    np.testing.assert_allclose(wrench, found["P"].T @ x["lam"], rtol=1e-12, atol=1e-11)


@pytest.mark.parametrize("seed", range(20))
def test_a_pose_closure_without_moments_is_a_point_closure(seed):
    point, pose = legs.shapes("point"), legs.shapes("pose")
    names = (f"{end}_{what}" for end in ("base", "gamma") for what in ("stiffness", "damping"))
    given = legs.numbers(seed, **dict.fromkeys(names, np.zeros(3)))
    y = legs.state(pose, seed, 1e-2, given)
    n = point.size
    y["lam"][3:] = 0.0
    x = (
        y
        | {name: y[name][:n] for name in ("q", "v", "v_dot")}
        | {"lam": y["lam"][:3], "p": legs.parameters(point, given)}
    )
    ball, ours = (legs.call(s, "leg_residual", z) for s, z in ((point, x), (pose, y)))
    np.testing.assert_allclose(ours["r"], np.concatenate([ball["r"], np.zeros(3)]), rtol=1e-12, atol=1e-12)
    joint = x["pose"][:3] + matrix(x["pose"][3:]) @ given["joint"]
    np.testing.assert_allclose(ours["gap"][:3], ball["tip"] - joint, rtol=1e-12, atol=1e-14)
    for name in ("powers", "drive"):
        np.testing.assert_allclose(ours[name], ball[name], rtol=1e-12)
    M, K = (legs.call(pose, "leg_matrices", y)[name] for name in "MK")
    ball = legs.call(point, "leg_matrices", x)
    np.testing.assert_allclose(M[:n, :n], ball["M"], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(K[:n, :n], ball["K"], rtol=1e-12, atol=1e-12 * np.abs(K).max())
    assert not M[n:].any() and not K[n:].any()


FRAMEWORK = (
    "element.py",
    "registry.py",
    "slot.py",
    "trial.py",
)  # what an element is, which there are, where, if they do


@pytest.mark.parametrize(
    "path",
    sorted(path for path in (ROOT / "src/flexapod/mechanics/elements").glob("[a-z]*.py") if path.name not in FRAMEWORK),
    ids=lambda path: path.stem,
)
def test_every_element_has_its_theory(path):
    pages = "\n".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs/theory").glob("*.md"))
    assert f"`{path.name}`" in pages or f"`mechanics/elements/{path.name}`" in pages
