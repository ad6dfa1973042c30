"""What was written is kept, what follows from it is derived: a change in Python is the same change in the text."""

import re
import tomllib

import numpy as np
import pytest
from tests.helpers.samples import SAMPLES, sample_text
from tests.helpers.tables import plain

from flexapod.common.errors import InputError
from flexapod.common.tables.reference import reference
from flexapod.common.units import to_si
from flexapod.model import PRESETS, Study, loads, preset_text
from flexapod.model.file.fields import read_fields
from flexapod.model.file.key_trials import study_data
from flexapod.model.leg.circle import Circle
from flexapod.model.study.tolerances import RatioSpread

pytestmark = pytest.mark.property

TEXTS = {name: preset_text(name) for name in PRESETS} | {name: sample_text(name) for name in SAMPLES}
ENTRIES = {f"{entry.study} {entry.table} {entry.title}": entry for entry in reference().entries}
OF_ROBOT = ("payload", "leg", "geometry", "heat", "tolerances")
ENDS = ("base", "platform")


def steps(key):
    """Names and indices of a key path."""
    return [int(number) - 1 if number else name for name, number in re.findall(r"([\w-]+?)(?=[.\[]|$)|\[(\d+)\]", key)]


def numbers(text, path=None):
    """Key path and value [SI] of every number of a text."""
    for field in read_fields(text, path):
        for key, dimension in field.numbers if field.value is not None else ():
            value = field.value
            for step in steps(key)[len(steps(field.key)) :]:
                value = value[step]
            yield key, to_si(value, dimension, key=key)


def put(data, at, value):
    """Set a value in tables."""
    for step in at[:-1]:
        data = data[step]
    data[at[-1]] = value


def written(text, at, value, path):
    """The study of the text with another number in it."""
    data = tomllib.loads(text)
    put(data, at, value)
    return loads(plain(data), path=path)


def replaced(part, at, value, text):
    """The model with another number in it [SI], by `replace` all the way up; `text`: of the whole study."""
    if not at:
        return value
    name, rest = at[0], at[1:]
    if isinstance(part, np.ndarray):
        array = np.array(part)
        array[(name, name) if array.ndim == 2 and not rest else tuple(at)] = value  # a diagonal in short
        return array
    if isinstance(part, tuple):
        return tuple(replaced(x, rest, value, text) if i == name else x for i, x in enumerate(part))
    if isinstance(part, dict):
        return {**part, name: value}
    if isinstance(part, Study) and name in OF_ROBOT:
        return part.replace(robot=replaced(part.robot, at, value, text))
    special = SPECIAL.get((type(part).__name__, name))
    if special is not None:
        return part.replace(**special(part, rest, value, text))
    old = getattr(part, name, None)
    if old is None and hasattr(part.material, name):
        return part.replace(material=part.material.replace(**{name: value}))
    if not rest and isinstance(old, np.ndarray):  # one for all legs; of the inertia in a plane: a flat plate's
        return part.replace(**{name: np.full(old.shape, value) if old.ndim == 1 else value * (old / old.max())})
    if not rest and hasattr(old, "sigma"):
        return part.replace(**{name: {"sigma": value} if isinstance(old, RatioSpread) else old.replace(sigma=value)})
    if not rest and hasattr(old, "law"):  # a number is a constant law
        return part.replace(**{name: old.replace(value=value)})
    return part.replace(**{name: replaced(old, rest, value, text)})


def places(end):
    """Joints at an end of the legs, with another number of their circle or their rows."""

    def found(robot, at, value, text):
        table, joints = tomllib.loads(text)["robot"][end], np.array(getattr(robot, f"{end}_joints"))
        if at[0] == "joints":
            joints[at[1], at[2]] = value
            return {f"{end}_joints": joints}
        read = {key: to_si(x, "length", key=key) for key, x in table.items() if key == "radius"}
        read |= {key: to_si(x, "angle", key=key) for key, x in table.items() if key == "half_angle"}
        read |= {key: [to_si(x, "angle", key=key) for x in xs] for key, xs in table.items() if key == "angles"}
        put(read, at, value)
        circle = Circle(**read).joints(end, robot.plane)
        joints[: len(circle)] = circle  # legs with a place of their own are the last ones of these files
        return {f"{end}_joints": joints}

    return found


def legs(robot, at, value, text):
    """Legs of a table with another number in it, or their places."""
    tables = tomllib.loads(text)["leg"]
    if isinstance(tables, dict):
        of, at = [0] * robot.count, [0, *at]
    else:
        of = [i for i, table in enumerate(tables) for _ in range(table.get("count", 1))]
    table, *inside = at
    if inside[1:2] == ["at"]:
        name = f"{inside[0].split('_')[0]}_joints"
        return {name: replaced(getattr(robot, name), [of.index(table), inside[2]], value, text)}
    changed = (replaced(x, inside, value, text) if i == table else x for i, x in zip(of, robot.legs, strict=True))
    return {"legs": tuple(changed)}


def stiffness(joint, at, value, text):
    """Springs of a joint with another number in them: a number, a table, rows, a law."""
    if joint.rolling is not None:
        return {"rolling": joint.rolling.replace(**{at[0]: value})}
    k = np.array(joint.stiffness)
    if not at:
        k[range(3), range(3)] = value
    elif at[0] in ("damping", "loss"):
        return {f"stiffness_{at[0]}": value}
    elif at[0] == "axial":
        k[2, 2] = value
    elif at[0] == "radial":
        k[0, 0] = k[1, 1] = value
    else:
        k[tuple(at[-2:])] = value
    return {"stiffness": k}


def springs(leg, at, value, text):
    """Springs along a leg, by name: a number is the stiffness."""
    name, *inside = at
    found = (replaced(x, inside or ["stiffness"], value, text) if x.name == name else x for x in leg.springs)
    return {"springs": tuple(found)}


def wrench(load, at, value, text):
    """A wrench, whose six numbers may stand there without its table."""
    return {"wrench": replaced(load.wrench, at if isinstance(at[0], str) else ["value", *at], value, text)}


def turned(home, at, value, text):
    """How the platform is turned at home; in a plane by a number, about the normal."""
    rotation = home.rotation
    return {"rotation": replaced(rotation, at, value, text) if at else value * (rotation / rotation.max())}


def ends(name):
    """A range about home: one number is both of its ends."""

    def found(ranges, at, value, text):
        old = getattr(ranges, name)
        return {name: replaced(old, at, value, text) if at else np.array([-value, value])}

    return found


#: What stands in a text in another way than as a field of its own.
SPECIAL = {
    **{("Robot", end): places(end) for end in ENDS},
    ("Robot", "leg"): legs,
    ("Joint", "stiffness"): stiffness,
    ("Leg", "springs"): springs,
    **{("TravelRanges", name): ends(name) for name in ("each", "surge", "sway", "heave")},
    **{("RotationRanges", name): ends(name) for name in ("each", "roll", "pitch", "yaw")},
    ("Home", "rotation"): turned,
    **{(name, "wrench"): wrench for name in ("Load", "ActuatorLoad")},
    **{("Carriage", kind): lambda part, at, x, text: {"axis": replaced(part.axis, at, x, text)}
       for kind in ("slider", "crank")},
    ("Carriage", "radius"): lambda part, at, x, text: {"arm": part.arm * (x / np.linalg.norm(part.arm))},
}  # fmt: skip


def content(study):
    """All but its text and what is said of it."""
    return [getattr(study, name) for name in type(study).model_fields if name not in ("source_text", "path", "notes")]


def same(one, other, key):
    """Whether two studies are the same, to the bit; a crank's arm is computed of its radius, and rounded."""
    if not key.endswith("carriage.radius"):
        return content(one) == content(other)
    arms = ([leg.carriage.arm for leg in study.robot.legs if leg.carriage] for study in (one, other))
    return np.allclose(*arms, rtol=1e-12, atol=1e-15)


def outcome(make, *given):
    """What is made, or that it is refused."""
    try:
        return make(*given)
    except InputError:
        return None


def differences(text, table="", path=None):
    """Where a number that is changed by 5 % in Python is not the one changed in the text; how many were taken."""
    study, wrong, taken = loads(text, path=path), [], 0
    for key, value in numbers(text, path):
        if not re.sub(r"\[\d+\]", "", key).startswith(table):
            continue
        new, at = 1.05 * value or 1e-4, steps(key)
        ours, theirs = outcome(replaced, study, at, new, text), outcome(written, text, at, new, path)
        if ours is None or theirs is None:
            wrong += [f"{key}: refused on one side alone"] * (ours is not theirs)
            continue
        taken += 1
        wrong += [f"{key}: another study in Python"] * (not same(ours, theirs, key))
        again = loads(ours.source_text, path=path)
        wrong += [f"{key}: another study once it is written and read"] * (content(again) != content(ours))
        if key.startswith("leg[") and "count" in tomllib.loads(text)["leg"][0]:
            continue  # a number is that of a leg in a key, and of a table of several legs here
        variant = outcome(study.with_values, {key: new})
        wrong += [f"{key}: another variant"] * (variant is None or content(variant) != content(theirs))
    return wrong, taken


@pytest.mark.parametrize("name", TEXTS)
def test_a_number_changed_in_python_is_the_number_changed_in_the_text(name):
    wrong, taken = differences(TEXTS[name])
    assert not wrong, "\n".join(wrong)
    assert taken >= 10


def test_numbers_of_every_table_that_a_study_may_have(tmp_path):
    """The examples of the reference: every key of every table is in one of them."""
    for name, text in reference().files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    wrong, every = [], 0
    for name, entry in ENTRIES.items():
        found, taken = differences(plain(study_data(entry)), entry.table, tmp_path / "study.toml")
        wrong += [f"{name}: {words}" for words in found]
        every += taken
    assert not wrong, "\n".join(wrong)
    assert every > 900
