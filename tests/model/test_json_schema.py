"""The JSON schema of study files takes what loads and marks keys and words that no file has."""

import json
import random
import tomllib
from pathlib import Path

import pytest
from tests.helpers.tables import respelled
from tools.damaged import WHOLE
from typer.testing import CliRunner

from flexapod.app.cli.cli import app
from flexapod.common.tables.reference import reference
from flexapod.model import PRESETS, preset_text
from flexapod.model.file.json_schema import json_schema
from flexapod.model.file.key_trials import study_data

pytestmark = pytest.mark.unit

EXAMPLES = Path(__file__).parents[2] / "examples"
STUDIES = {name: preset_text(name) for name in PRESETS}
STUDIES |= {str(path.relative_to(EXAMPLES)): path.read_text(encoding="utf-8") for path in EXAMPLES.rglob("*.toml")}
STUDIES |= {name: parts["study.toml"] for name, parts in WHOLE.items() if "study.toml" in parts}
DATA = {name: tomllib.loads(text) for name, text in STUDIES.items()}
DATA = {name: data for name, data in DATA.items() if "robot" in data or "actuator" in data}  # no sweeps
DATA |= {f"{e.study} {e.table} {e.title}": study_data(e) for e in reference().entries}
KINDS = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float)}


@pytest.fixture(scope="module")
def schema():
    return json.loads(json_schema())


def wrong(value, schema, path=""):
    """Where a value is not as a schema says: the words of draft 07 that ours has, as its text defines them."""
    if "anyOf" in schema:
        tried = [list(wrong(value, form, path)) for form in schema["anyOf"]]
        yield from min(tried, key=len) if all(tried) else ()
    kinds = schema.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    if kinds and not any(isinstance(value, KINDS[k]) and (k == "boolean") == isinstance(value, bool) for k in kinds):
        yield path
        return
    if "enum" in schema and value not in schema["enum"]:
        yield path
    if isinstance(value, int | float) and not isinstance(value, bool):
        low, high = schema.get("minimum", value), schema.get("maximum", value)
        above, below = schema.get("exclusiveMinimum", value - 1), schema.get("exclusiveMaximum", value + 1)
        if not (low <= value <= high and above < value < below):
            yield path
    for i, item in enumerate(value if isinstance(value, list) else ()):
        yield from wrong(item, schema.get("items", {}), f"{path}[{i}]")
    for name, item in value.items() if isinstance(value, dict) else ():
        known, others = schema.get("properties", {}), schema.get("additionalProperties", {})
        inner = known.get(name, others)
        yield from [f"{path}.{name}"] if inner is False else wrong(item, inner, f"{path}.{name}")


@pytest.mark.parametrize("name", DATA)
def test_what_loads_is_taken(name, schema):
    assert not list(wrong(DATA[name], schema))


def test_studies_in_other_words_are_taken(schema):
    for seed in range(300):
        r = random.Random(seed)
        name = r.choice(list(DATA))
        assert not list(wrong(respelled(r, DATA[name]), schema)), (seed, name)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("robot", "typ"), "6-UPS"),
        (("leg", "drive", "type"), "servos"),
        (("leg", "piston", "diametre"), "27 mm"),
        (("leg", "stroke", "max"), -1),
        (("payload", "mass"), 0),
        (("simulation", "modes"), 2.5),
        (("motion", "pivot"), "here"),
        (("legs",), {}),
    ],
)
def test_what_no_file_has_is_marked(path, value, schema):
    data = tomllib.loads(preset_text("paper-robot"))
    inner = data
    for name in path[:-1]:
        inner = inner[name]
    inner[path[-1]] = value
    assert list(wrong(data, schema)) == ["".join(f".{name}" for name in path)]


def test_keys_have_their_words_and_the_file_is_the_same_every_time(schema, tmp_path):
    nut = schema["properties"]["leg"]["anyOf"][0]["properties"]["drive"]["properties"]["nut"]["properties"]
    assert nut["stiffness"]["description"] == "along the screw" and nut["stiffness"]["exclusiveMinimum"] == 0
    file = tmp_path / "schema.json"
    assert CliRunner().invoke(app, ["keys", "--schema", str(file)]).stdout.strip().endswith("written.")
    assert file.read_text(encoding="utf-8") == json_schema()
