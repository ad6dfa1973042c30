"""Rows and tables that the form adds to a study file and takes out of it: everything else, comments too, stays."""

import tomllib

import pytest

from flexapod.app.browser.document import Document, read
from flexapod.app.browser.structure import structure_edits
from flexapod.model import PRESETS, preset_text

pytestmark = pytest.mark.unit

TEXT = preset_text("paper-robot")
HEAD = TEXT.split("[motion]")[0]
TAIL = "\n[simulation]\nmodes = 3  # as in the paper\n"
LISTED = """[motion]
type = "waypoints"  # from pose to pose
points = [
  { time = "1 s", roll = "5 deg" },  # there
  # and back
  { time = "1500 ms", roll = "0 deg" },
]
"""
ONE_LINE = (
    '[motion]\ntype = "waypoints"\npoints = [{ time = 1, roll = "5 deg" }, { time = 1.5, heave = 0.01 }]  # two\n'
)
TABLES = """[motion]
type = "waypoints"

[[motion.points]]  # there
time = "1 s"
roll = "5 deg"

# and back
[[motion.points]]
time = "1.5 s"
roll = "0 deg"
"""


def offered(document):
    return {offer.label: offer for offer in structure_edits(document)}


def taken(text, label):
    """The document after a button, which must be a valid study."""
    found = offered(Document(text, None))[label].apply(Document(text, None))
    assert read(found).error is None
    return found.text


def comments(text):
    return [line[line.index("#") :] for line in text.splitlines() if "#" in line]


@pytest.mark.parametrize("motion", [LISTED, ONE_LINE, TABLES])
def test_points_are_added_after_the_last_and_taken_out(motion):
    text = HEAD + motion + TAIL
    more = taken(text, "Add a point")
    before, after = (read(Document(t, None)).study.motion.points for t in (text, more))
    assert after[:2] == before
    assert after[2].time == pytest.approx(2.0)  # as much later as the second is after the first
    assert after[2].pose.tolist() == before[1].pose.tolist()
    assert comments(more) == comments(text)
    assert taken(more, "Take out points[3]").split() == text.split()
    less = taken(text, "Take out points[1]")
    assert read(Document(less, None)).study.motion.points == before[1:]
    gone = [c for c in comments(text) if c not in comments(less)]
    assert all(c.startswith("# there") for c in gone)  # what was said of the point that is gone, and nothing else
    assert not any(label.startswith("Take out points") for label in offered(Document(less, None)))


def test_a_point_can_be_the_first_one():
    """Who chooses waypoints for a robot that rolled has none yet: the reader asks for them, a button gives one."""
    text = HEAD + '[motion]\ntype = "waypoints"\nhold = "0.5 s"  # rest\n' + TAIL
    assert read(Document(text, None)).error.key == "motion.points"
    assert comments(taken(text, "Add a point")) == comments(text)
    combined = HEAD + '[motion]\ntype = "combined"\nduration = "1 s"\n' + TAIL
    assert read(Document(combined, None)).error.key == "motion.amplitudes"
    assert "amplitudes" in taken(combined, "Add amplitudes")


@pytest.mark.parametrize("name", ["paper-robot", "paper-robot-radii"])
def test_legs_come_apart_and_together(name):
    text = preset_text(name)
    apart = taken(text, "Six different legs")
    assert tomllib.loads(apart)["leg"] == [tomllib.loads(text)["leg"]] * 6
    assert comments(apart) == comments(text)
    assert read(Document(apart, None)).study.robot == read(Document(text, None)).study.robot
    changed = Document(apart, None).with_value("leg[4].piston.diameter", "30 mm").text
    together = taken(changed, "All legs as this one")
    assert together == text  # to the letter


def test_legs_with_inner_tables():
    piston = '\n[leg.piston]  # long\ndiameter = "27 mm"\nlength = "750 mm"\nmaterial = "steel"\n\n[motion]'
    lines = [line for line in TEXT.splitlines() if not line.startswith("piston = ")]
    text = "\n".join(lines).replace("\n[motion]", piston) + "\n"
    apart = taken(text, "Six different legs")
    assert tomllib.loads(apart)["leg"] == [tomllib.loads(text)["leg"]] * 6
    assert taken(apart, "All legs as this one") == text


def test_what_cannot_be_changed_line_by_line_is_refused_in_words():
    leg = tomllib.loads(TEXT)["leg"]
    dotted = "\n".join(f"leg.{k} = {v!r}" for k, v in leg.items() if not isinstance(v, dict)) + "\n"
    document = Document(dotted + '[robot]\ntype = "6-UPS"\n', None)
    apart = offered(document)["Six different legs"].apply(document)  # written anew
    assert tomllib.loads(apart.text)["leg"] == [tomllib.loads(dotted)["leg"]] * 6


def test_tables_that_a_file_leaves_out():
    more = taken(taken(TEXT, "Add [load]"), "Add [initial]")
    assert tomllib.loads(more) == {
        **tomllib.loads(TEXT), "load": {"wrench": [0] * 6}, "initial": {"start": "equilibrium"},
    }  # fmt: skip
    assert more.startswith(TEXT)
    assert taken(taken(more, "Take out [load]"), "Take out [initial]").split() == TEXT.split()


def test_a_text_that_is_no_toml_offers_nothing():
    assert structure_edits(Document("[robot", None)) == []
    for name in PRESETS:
        for offer in structure_edits(Document(preset_text(name), None)):
            assert read(offer.apply(Document(preset_text(name), None))).error is None


@pytest.mark.parametrize(
    ("kind", "label"),
    [("6-UPS", "Six different legs"), ("3-RPS", "Three different legs"), ("3-UPS+UP", "Four different legs")],
)
def test_as_many_legs_are_offered_as_the_type_says(kind, label):
    text = f'[robot]\ntype = "{kind}"\n[leg]\ndamping = 0.01\n'
    offer = next(offer for offer in structure_edits(Document(text, None)) if offer.place == "[leg]")
    assert offer.label == label
    assert len(tomllib.loads(offer.apply(Document(text, None)).text)["leg"]) == {"S": 6, "T": 3, "F": 4}[label[0]]


def test_legs_of_unlike_chains_are_not_made_alike():
    text = '[robot]\ntype = "3-UPS+UP"\n' + 4 * "[[leg]]\ndamping = 0.01\n"
    assert not [offer for offer in structure_edits(Document(text, None)) if "All legs" in offer.label]
