"""What carries a base joint: a slider on a rail or a crank on a shaft, Eqs. (T13.1)-(T13.3)."""

from types import SimpleNamespace

from flexapod.elements.frame import Energies, Frame
from flexapod.elements.rotations import about_axis
from flexapod.symbolic.vocabulary import cross, dot, matrix33, zeros


def carriage(kind: str, p: SimpleNamespace, qs: SimpleNamespace, vs: SimpleNamespace) -> tuple[Frame, Energies]:
    """Frame in which the base joint stands, and the energies of what carries it; ``kind``: "", "slider", "crank"."""
    R0 = matrix33(p.R0)
    if not kind:
        return Frame(origin=p.base, axes=R0, velocity=zeros(3), omega=zeros(3)), Energies()
    axis = p.carriage_axis
    if kind == "slider":
        frame = Frame(  # (T13.1)
            origin=p.base + axis * qs.chi, axes=R0, velocity=R0.T @ axis * vs.chi, omega=zeros(3)
        )
        return frame, Energies(
            kinetic=0.5 * p.carriage_mass * vs.chi**2, gravity=-p.carriage_mass * dot(p.gravity, frame.origin)
        )
    turn = about_axis(axis, qs.chi)
    axes, arm, shaft = turn @ R0, turn @ p.carriage_arm, p.base - p.carriage_arm
    frame = Frame(  # (T13.2)
        origin=shaft + arm,
        axes=axes,
        velocity=axes.T @ cross(axis, arm) * vs.chi,
        omega=R0.T @ axis * vs.chi,
    )
    weight = -p.carriage_mass * dot(p.gravity, shaft + turn @ p.carriage_com)
    return frame, Energies(kinetic=0.5 * p.carriage_inertia * vs.chi**2, gravity=weight)  # (T13.3)
