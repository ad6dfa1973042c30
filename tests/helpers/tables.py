"""Tables of study files by their classes, and written in letters of the tests' own."""

import json

from flexapod.common.tables.base import Frozen


def classes(base=Frozen):
    for cls in base.__subclasses__():
        if cls.__module__.startswith("flexapod."):  # not those of other tests
            yield cls
        yield from classes(cls)


UNITS = {"m": ("mm", -3), "mm": ("um", -3), "kg": ("g", -3), "N": ("kN", 3), "s": ("ms", -3), "GPa": ("MPa", -3)}


def plain(tables, number=repr):
    """A writer of TOML of the tests' own: one line for each key of a table at the top."""
    lines = []
    for name, table in tables.items():
        for item in table if isinstance(table, list) else [table]:
            lines.append(f"[[{name}]]" if isinstance(table, list) else f"[{name}]")
            lines += [f"{json.dumps(key)} = {_inline(value, number)}" for key, value in item.items()]
    return "\n".join(lines) + "\n"


def _inline(value, number):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {_inline(item, number)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_inline(item, number) for item in value) + "]"
    if isinstance(value, float):
        return number(value)
    return json.dumps(value, ensure_ascii=False)


def respelled(r, value):
    """The same tables, or nearly: numbers in other letters and units, keys in another order, some left out."""
    if isinstance(value, dict):
        names = [name for name in value if r.random() > 0.01]
        if r.random() < 0.3:
            r.shuffle(names)
        return {name: respelled(r, value[name]) for name in names}
    if isinstance(value, list):
        return [respelled(r, item) for item in value]
    if isinstance(value, str) and r.random() < 0.5:
        number, _, unit = value.partition(" ")
        if unit in UNITS and number.replace(".", "", 1).isdecimal():
            other, power = UNITS[unit]
            return f"{float(number) / 10**power * (1 + 1e-3 * r.randint(-3, 3)):.6g} {other}"
    if isinstance(value, float):
        return value * (1 + 1e-3 * r.randint(-3, 3))
    return value
