"""Legs of every kind with numbers, for the tests of elements and of their closures."""

from functools import cache

import numpy as np
from tests.helpers.layouts import layout

from flexapod.kinematics.rotations import quaternion
from flexapod.mechanics.elements.distribution import RotaryInertia
from flexapod.mechanics.elements.drive_train import DriveTrain
from flexapod.mechanics.elements.mount import BaseMounting, MovedBase, PlatformMounting
from flexapod.mechanics.elements.slot import Slot
from flexapod.mechanics.elements.soft_joint import SoftBase, SoftPlatform
from flexapod.mechanics.leg.kernel_functions import leg_functions
from flexapod.mechanics.leg.layout import leg_parameters
from flexapod.mechanics.shapes import axial_basis, lateral_basis
from flexapod.mechanics.symbolic.functions import Interpreted

GUIDE, CYLINDER = lateral_basis("tip-load", 2), lateral_basis("tip-load", 3, moment=True)
INSIDE = ("ga", "gb", "ha", "hb", "ka", "kb")
EVERYTHING = {"closure": "pose", "spin": True, "torsion": True}
KINDS = {
    "point": {},
    "slider": {"carriage": "slider"},
    "crank": {"carriage": "crank"},
    "pose": {"closure": "pose"},
    "pose with spin and twist": EVERYTHING,
    "pose on a slider": EVERYTHING | {"carriage": "slider"},
    "pose on a crank": EVERYTHING | {"carriage": "crank"},
    "flexures on a crank": EVERYTHING | {"carriage": "crank", "flexure": True},
    "point between soft joints": {"elements": (Slot(SoftBase), Slot(SoftPlatform))},
    "pose between soft joints": EVERYTHING | {"elements": (Slot(SoftBase), Slot(SoftPlatform))},
    "soft joints and flexures": {"closure": "pose", "flexure": True, "elements": (Slot(SoftBase), Slot(SoftPlatform))},
    "point behind a screw": {"elements": (Slot(DriveTrain),)},
    "pose behind a screw": EVERYTHING | {"elements": (Slot(SoftBase), Slot(DriveTrain))},
    "point on frames that move": {"elements": tuple(map(Slot, (MovedBase, BaseMounting, PlatformMounting)))},
    "slider on a base that moves": {"elements": (Slot(MovedBase),), "carriage": "slider"},
    "pose on a crank on frames that move": EVERYTHING
    | {"carriage": "crank", "elements": (Slot(BaseMounting), Slot(PlatformMounting))},
    "point in a guide": {"guide": GUIDE},
    "point in a cylinder that bends": {"cylinder": CYLINDER},
    "point in a guide of a cylinder": {"guide": GUIDE, "cylinder": CYLINDER},
    "pose in a guide of a cylinder": EVERYTHING | {"guide": GUIDE, "cylinder": CYLINDER, "elements": (Slot(SoftBase),)},
    "point with a thick piston": {"elements": (Slot(RotaryInertia),)},
    "tip body": {"closure": "none", "torsion": True, "tip_body": True},
    "planar": {"closure": "none", "planar": True, "tip_body": True},
}


def rotation(rng):
    """A random rotation."""
    R, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return R * np.sign(np.linalg.det(R))


PHYSICS = {
    "piston_turning": [0.02, 0.03],
    "rhoA": 4.466, "EI": 5217.4, "EA": 1.1451e7, "Lp": 0.75, "mouth": 0.315, "piston_axial_inertia": 4e-3,
    "cylinder_mass": 3.0, "cylinder_com": 0.157, "cylinder_inertia": 0.0248, "cylinder_axial_inertia": 0.002,
    "zeta": 0.005, "damping_time": 1e-4, "drive_stiffness": 3e5, "drive_damping": 40.0,
    "gravity": [1.0, 2.0, -9.0], "base": [0.1, 0.2, 0.05], "tip_mass": 0.7, "tip_inertia": 0.02,
    "carriage_mass": 1.3, "carriage_axis": np.array([2.0, 1.0, 2.0]) / 3, "carriage_stiffness": 2e4,
    "carriage_damping": 9.0,
    "carriage_inertia": 0.05, "carriage_com": [0.02, 0.05, -0.03], "carriage_arm": [0.05, 0.1, -0.1],
    "cylinder_spins": 1.0, "GJ": 900.0, "tip_axial_inertia": 0.01, "joint": [0.1, -0.2, 0.05], "L_c": 0.3,
    "base_stiffness": [30.0, 40.0, 20.0], "base_home": [0.1, -0.1, 0.05],
    "gamma_stiffness": [35.0, 25.0, 15.0], "gamma_home": [0.02, 0.01, -0.03],
    "base_damping": [0.3, 0.4, 0.2], "gamma_damping": [0.5, 0.1, 0.6],
}  # fmt: skip


def springs(seed):
    """A 6x6 stiffness that couples everything."""
    root = np.random.default_rng(seed).normal(size=(6, 6)) * [1e3, 1e3, 1e3, 6, 6, 6]
    return root.T @ root


PHYSICS |= {
    "base_flexure": springs(1), "platform_flexure": springs(2),
    "base_flexure_damping": 1e-3 * springs(3), "platform_flexure_damping": 1e-3 * springs(4),
}  # fmt: skip
PHYSICS |= {
    "series_stiffness": 4e5, "series_softening": [0.4, -0.3], "series_home": 0.85, "series_damping": 70.0,
    "rotor_mass": 300.0, "rotor_stiffness": 2e5, "rotor_damping": 30.0,
}  # fmt: skip
PHYSICS |= {
    "guide_reach": 1.065, "guide_rhoA": 4.466, "guide_EI": 5217.4, "guide_stiffness": [3e5, 4e5],
    "guide_damping": [30.0, 50.0], "cylinder_length": 0.315, "cylinder_EI": 2e4, "cylinder_rhoA": 4.0,
    "cylinder_turning": 3e-3,
    "mounted_mass": 1.2, "mounted_com": 0.12, "mounted_inertia": 0.006,
}  # fmt: skip
for end, k in (("base", 1.0), ("platform", 1.3)):
    PHYSICS |= {f"{end}_mount_stiffness": k * springs(5), f"{end}_mount_damping": 1e-3 * k * springs(6)}
    PHYSICS |= {f"{end}_soft": [1e6 * k, 3e6 * k], f"{end}_soft_damping": [300.0 * k, 200.0 * k]}
PHYSICS |= {
    "base_motion_at": [0.03, -0.02, 0.1], "base_mount_at": [0.1, 0.04, -0.1], "platform_mount_at": [-0.02, 0.05, -0.1],
    "base_plate_mass": 4.0, "base_plate_weighs": 3.0, "base_plate_inertia": np.diag([0.2, 0.3, 0.4]) + 0.02,
}  # fmt: skip


@cache
def shapes(kind, *, modes=3, axial=2, basis="tip-load"):
    lateral, switches = lateral_basis(basis, modes), KINDS[kind]
    other = lateral_basis(basis, 0) if switches.get("planar") else lateral
    return layout(a=lateral, b=other, axial=axial_basis(axial), **switches)


@cache
def functions(ours):
    """The functions of a leg by name, interpreted."""
    return {
        f.name: (Interpreted(f), [name for name, _ in f.inputs], [name for name, _ in f.outputs])
        for f in leg_functions(ours)
    }


def call(ours, name, values):
    """Outputs of a function of a leg by name; ``values`` by input."""
    function, inputs, outputs = functions(ours)[name]
    return dict(zip(outputs, function(*(values[x] for x in inputs)), strict=True))


def numbers(seed, **changed):
    """Physical numbers of a leg with frames of its own."""
    rng = np.random.default_rng(seed)
    frames = {name: rotation(rng) for name in ("R0", "platform_frame", "leg_frame")}
    return PHYSICS | frames | changed


def parameters(ours, given):
    """Numbers as the kernel reads them: matrices column by column."""
    return np.concatenate([np.asarray(given[name], dtype=float).T.ravel() for name, _ in leg_parameters(ours)])


def state(ours, seed, amplitude=1e-3, given=None):
    """A random state of a leg and all that its functions read."""
    rng = np.random.default_rng(seed)
    given = given or numbers(seed)
    q, v = rng.uniform(-0.5, 0.5, ours.size), rng.normal(size=ours.size)
    q[ours.l_index] = rng.uniform(0.8, 0.95)
    for name in ("c", "a", "b", "t", "u1", "u2", "u3", "e1", "e2", "e3", *INSIDE):
        if ours.has(name):
            part = slice(ours.index(name), ours.index(name) + dict(ours.layout)[name])
            size = amplitude / (50 if name in INSIDE else 1)  # which lean the whole piston
            q[part] = size * rng.uniform(-1, 1, q[part].shape)
            v[part] = 30 * size * rng.uniform(-1, 1, q[part].shape)
    return {
        "q": q, "v": v, "v_dot": rng.normal(size=ours.size), "lam": 50 * rng.normal(size=ours.rows),
        "command": np.tile([0.9, 0.1], ours.commands // 2), "p": parameters(ours, given),
        "pose": np.concatenate([rng.normal(size=3), quaternion(rotation(rng))]), "load": rng.normal(size=12),
    }  # fmt: skip


def pieces(ours, column):
    """Coordinates by name: numbers, and arrays of amplitudes."""
    found = {}
    for name, size in ours.layout:
        i = ours.index(name)
        found[name] = column[i : i + size] if name in ("a", "b", "c", *INSIDE) else column[i]
    return found
