"""A payload on six springs under sampled controllers by hand, exact from sample to sample."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from flexapod.control import StateSpace

M, K, C, F = 10.0, 2e6, 30.0, 5.0  # kg, N/m, N s/m of each leg, N
T = 5e-4
LEGS = tuple(range(1, 7))
FORCES = tuple(f"force-sensor:drive:{i}" for i in LEGS)
STROKES = tuple(f"stroke:{i}" for i in LEGS)
DRIVES = tuple(f"drive:{i}" for i in LEGS)
STUDY = f"""
[robot]
type = "6-UPS"
base = {{ radius = "250 mm", half_angle = "10 deg" }}
platform = {{ radius = "150 mm", half_angle = "10 deg" }}
home_height = "0.9 m"
gravity = [0, 0, 0]
[payload]
mass = {M}
inertia = [0.2, 0.2, 0.3]
com = [0, 0, 0]
[leg]
cylinder = {{ mass = 0, com = 0, inertia = 0, mouth = "0.3 m" }}
piston = {{ length = "0.75 m", EA = 1e8, EI = 1e4, rhoA = 0 }}
stroke = {{ min = "0.7 m", max = "1.05 m" }}
drive = {{ type = "servo", stiffness = {K}, damping = {C} }}
[motion]
type = "heave"
amplitude = 0
duration = "10 ms"
hold = "90 ms"
[load]
wrench = {{ law = "step", amplitude = [0, 0, {F}, 0, 0, 0], time = "{2 * T} s" }}
[simulation]
fidelity = "rigid"
output_step = "{T} s"
step = "{T / 10} s"
"""


@dataclass(frozen=True)
class Law:
    """x_next = A x + B y, u = C x + D y for each leg alike."""

    a: float
    b: float
    c: float
    d: float
    readings: tuple[str, ...] = FORCES

    def system(self) -> StateSpace:
        """The law of all legs."""
        each = np.eye(6)
        return StateSpace(
            A=self.a * each, B=self.b * each, C=self.c * each, D=self.d * each, inputs=self.readings, outputs=DRIVES,
            states=tuple("abcdef"), units={}, sample=T,
        )  # fmt: skip


def integral(gain: float, leak: float = 0.0) -> Law:
    """Force fed back by the sum of readings before: u = - g T (sum of readings)."""
    return Law(a=np.exp(-leak * T), b=-gain * T, c=1.0, d=0.0)


def summed_with_today(gain: float, leak: float = 0.0) -> Law:
    """The same with the reading of the present sample in it."""
    keep = np.exp(-leak * T)
    return Law(a=keep, b=-gain * T * keep, c=1.0, d=-gain * T)


def height() -> float:
    """Cosine of the legs against the vertical."""
    low, high = np.deg2rad([10.0, 60 - 10.0])  # joints on the base at 0 +- 10, on the platform at 60 +- 10
    foot, head = 0.25 * np.array([np.cos(low), np.sin(low)]), 0.15 * np.array([np.cos(high), np.sin(high)])
    return 0.9 / np.sqrt(0.81 + np.sum((head - foot) ** 2))


class Heave:
    """The payload along z on six springs under forces that are held, z'' = (6 s (u - s (k z + c z')) + F) / m."""

    def __init__(self, mass=M):
        s = self.s = height()
        A = np.array([[0.0, 1.0], [-6 * s**2 * K / mass, -6 * s**2 * C / mass]])
        B = np.array([[0.0, 0.0], [6 * s / mass, 1 / mass]])
        whole = expm(T * np.block([[A, B], [np.zeros((2, 4))]]))
        self.A, self.B = whole[:2, :2], whole[:2, 2:]
        self.force = -s * np.array([K, C])  # of a leg, but for u

    def run(self, law, count, delay=0, quantum=0.0, most=np.inf):
        """z just before samples 0 to count, readings and outputs of one leg there."""
        x, state, u, queue = np.zeros(2), 0.0, 0.0, [0.0] * delay
        z, read, held = [], [], []

        def reading():
            y = self.force @ x + u if law.readings is FORCES else self.s * x[0]
            return quantum * np.rint(y / quantum) if quantum else y

        for k in range(count):
            z.append(x[0])
            foreseen = delay > 0 or law.d == 0  # u does not need today's reading, which is then read under it
            if not foreseen:
                queue.append(reading())
            u = float(np.clip(law.c * state + law.d * (queue[0] if queue else 0.0), -most, most))
            if foreseen:
                queue.append(reading())
            read.append(queue[-1])
            state = law.a * state + law.b * queue.pop(0)
            held.append(u)
            x = self.A @ x + self.B @ np.array([u, F * (k >= 2)])
        return np.array(z), np.array(read), np.array(held)

    def poles(self, law):
        """Of the closed loop from sample to sample, without a delay."""
        down, b, loop = self.force, self.B[:, 0], np.zeros((4, 4))
        if law.d == 0:
            loop[:2, :2], loop[:2, 2] = self.A, b * law.c
            loop[2, :3] = [*(law.b * down), law.a + law.b * law.c]
            return np.linalg.eigvals(loop[:3, :3])
        # y = down x + u before: u before is a state as well
        loop[:2, :2], loop[:2, 2], loop[:2, 3] = self.A + np.outer(b, law.d * down), b * law.c, b * law.d
        loop[2] = [*(law.b * down), law.a, law.b]
        loop[3] = [*(law.d * down), law.c, law.d]
        return np.linalg.eigvals(loop)


def heave(data):
    return data.tool_deviation.values[:, 2]


LAWS = {
    "force, its sum": (integral(60.0, leak=20.0), {}, {}),
    "force, its sum with today's": (summed_with_today(60.0, leak=20.0), {}, {}),
    "and late": (summed_with_today(60.0, leak=20.0), {"delay_samples": 2}, {"delay": 2}),
    "one sample late": (integral(60.0, leak=20.0), {"delay_samples": 1}, {"delay": 1}),
    "three samples late": (integral(60.0, leak=20.0), {"delay_samples": 3}, {"delay": 3}),
    "stroke": (Law(a=0.0, b=1.0, c=300 / T, d=-300 / T, readings=STROKES), {}, {}),
    "limited": (integral(60.0, leak=20.0), {"saturate": {"drive": 0.5}}, {"most": 0.5}),
    "in steps": (integral(60.0, leak=20.0), {"quantise": 1e-3}, {"quantum": 1e-3}),
}
PID = """
[control]
law = "{law}"
proportional = {proportional}
integral = {integral}
derivative = {derivative}
low_pass = 500
sample = {T}
"""
