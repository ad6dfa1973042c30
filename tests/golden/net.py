"""Prints of nine studies, to the bit: the C text of their equations, what kernels read, and what calls return.

A change that only moves things changes none of them. Bits differ between processors and compilers, so no print is kept
in the repository: each is compared with those of another checkout on the same machine,

    python -m tests.golden.net OTHER [studies]      # OTHER: folder of a checkout, say of the commit before

which prints what differs and ends with 1, or with those that were stored before,

    python -m tests.golden.net --store              # into build/net.json, with which the tests compare if it is there
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
from tests.helpers.texts import replaced

import flexapod as fx
from flexapod.model import preset_text
from flexapod.solve.kernel import generated_text
from flexapod.solve.modal.structural_damping import per_loss
from flexapod.solve.robot_system import robot_system

ROOT = Path(__file__).parents[2]
STORED = ROOT / "build" / "net.json"
MARCH = {"step": 5e-4, "duration": 0.05, "output_step": 5e-3}
SERVO = ('command = "position"', 'command = "servo"')
LOOP = 'loop = {{ stiffness = "5 kN m/rad", damping = "20 N m s/rad"{} }}\n'
RIPPLE = 'ripple = { torque = "0.05 N m", per_turn = 24, harmonics = [1, 0.3] }'
BRAKE = "brake = {"
MACHINES = {
    "ripple-integral": (
        SERVO,
        (BRAKE, LOOP.format(', integral = "20 kN m/(rad s)"') + f"motor = {{ {RIPPLE} }}\n{BRAKE}"),
    ),
    "ripple": ((BRAKE, f"motor = {{ torque_constant = '0.8 N m/A', {RIPPLE} }}\n{BRAKE}"),),
    "lag": (SERVO, (BRAKE, LOOP.format("") + f'motor = {{ bandwidth = "300 Hz" }}\n{BRAKE}')),
    "gap": (
        ('rigidity = "1130 N/um", preload = "1540 N"', 'stiffness = "850 N/um", backlash = "20 um"'),
        ("[simulation]", '[simulation]\nplay = "gap"'),
    ),
}
PRESETS = ("paper-robot", "machine-hexapod", "motion-base", "tripod", "nano-hexapod")
STUDIES = (*PRESETS, *MACHINES)


def text(name: str) -> str:
    """The study's text: a preset's, or the machine's with a part more."""
    if name in MACHINES:
        return replaced(preset_text("machine-hexapod"), *MACHINES[name])
    return preset_text(name)


def printed(*parts: object) -> str:
    """Hash of texts, numbers and arrays."""
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, np.ndarray) and part.dtype.kind not in "OUT":
            head, body = f"{part.dtype}{part.shape}", np.ascontiguousarray(part).tobytes()
        else:
            head, body = (
                type(part).__name__,
                (str(part.tolist()) if isinstance(part, np.ndarray) else str(part)).encode(),
            )
        digest.update(f"{head}:{len(body)}:".encode() + body)
    return digest.hexdigest()[:16]


def of_dataset(data) -> dict[str, str]:
    """Print of each variable: dimensions, unit, values."""
    return {
        name: printed(v.dims, v.attrs.get("units", ""), v.values)
        for name, v in sorted({**data.coords, **data.data_vars}.items())
    }


def prints(name: str) -> dict[str, str]:
    """All prints of a study, by what they are of."""
    study = fx.loads(text(name))
    system = robot_system(study.robot, study.simulation, per_loss(study.robot, study.simulation))
    found = {f"text.{part}": printed(words) for part, words in generated_text(system.kernel.shapes).items()}
    arrays = ("leg_p", "joint_p", "payload_p", "held", "hub_held")
    found |= {f"parameters.{part}": printed(getattr(system, part)) for part in arrays}
    calls = {"simulate": fx.simulate(study, **MARCH), "modes": fx.modes(study), "budget": fx.budget(study)}
    return found | {f"{call}.{key}": value for call, data in calls.items() for key, value in of_dataset(data).items()}


def elsewhere(root: Path, names: list[str]) -> dict[str, dict[str, str]]:
    """Prints of the studies as another checkout makes them."""
    paths = os.pathsep.join([str(root / "src"), str(root)])
    command = [sys.executable, "-m", "tests.golden.net", "--print", *names]
    environment = os.environ | {"PYTHONPATH": paths}
    said = subprocess.run(command, cwd=root, env=environment, stdout=subprocess.PIPE, text=True, check=True).stdout
    return json.loads(said)


def differences(here: dict[str, str], there: dict[str, str]) -> list[str]:
    """Names of the prints that are not the same, or in one of the two alone."""
    return sorted(key for key in here.keys() | there.keys() if here.get(key) != there.get(key))


def main(arguments: list[str]) -> int:
    """Compare with another checkout, store, or print."""
    if not arguments or (arguments[0] not in ("--print", "--store") and not Path(arguments[0], "tests").is_dir()):
        print(__doc__, file=sys.stderr)
        return 2
    names = arguments[1:] or list(STUDIES)
    here = {name: prints(name) for name in names}
    if arguments[0] == "--print":
        print(json.dumps(here))
        return 0
    if arguments[0] == "--store":
        STORED.parent.mkdir(exist_ok=True)
        STORED.write_text(json.dumps(here, indent=1), encoding="utf-8")
        return 0
    there = elsewhere(Path(arguments[0]).resolve(), names)
    wrong = {name: differences(here[name], there[name]) for name in names}
    for name, keys in wrong.items():
        print(f"{name}: {', '.join(keys) if keys else f'{len(here[name])} prints, the same'}")
    return int(any(wrong.values()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
