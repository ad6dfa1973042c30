"""The claims table: verdicts follow from numbers, and docs/paper.md says what the program says."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from tests.helpers.paper_parts import part, study_parts, whole_study

from flexapod.verification.paper import claims_actuator
from flexapod.verification.paper.claim import BREAKS, HOLDS, IN_PART, MISSES, NOT, OPEN
from flexapod.verification.paper.claims import claims, claims_markdown
from flexapod.verification.paper.study import STEPS, PaperStudy

pytestmark = [pytest.mark.unit, pytest.mark.xdist_group("claims")]  # one process computes the parts
PAGE, README = (Path(__file__).parents[2] / name for name in ("docs/paper.md", "README.md"))
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")


@pytest.fixture(scope="module")
def table():
    return {claim.where: claim for claim in claims(whole_study())}


def test_the_parts_are_those_of_replicate():
    assert list(study_parts()) == [step.name for step in STEPS]


def test_every_row_is_filled_and_appears_once(table):
    assert len(table) == len(claims(whole_study()))
    for claim in table.values():
        assert all((claim.where, claim.says, claim.ours, claim.verdict, claim.reason))
        assert "nan" not in (claim.ours + claim.reason).lower()


def nudged(factor):
    """The table with all values of all parts, but for those of time and kind, changed by a share of themselves."""
    parts = {
        name: data.assign({key: factor * values for key, values in data.data_vars.items() if values.dtype.kind == "f"})
        for name, data in study_parts().items()
    }
    return claims_markdown(claims(PaperStudy(parts=parts))).splitlines()


def test_page_says_what_the_program_says():
    """Made by `flexapod replicate --out DIR`, then the table of DIR/claims.md copied into docs/paper.md.

    Equal to the letter, numbers as they are rounded. Another processor's last bits may move a number over the edge of
    its rounding: what a change of 1e-4 of the values would print is allowed, the tolerance of the runs.
    """
    text = PAGE.read_text(encoding="utf-8").split("\n## Claims, one by one\n")[1]
    page = text[text.index("### ") :].splitlines()
    ours = claims_markdown(claims(whole_study())).splitlines()
    assert len(page) == len(ours)
    off = [(theirs, mine) for theirs, mine in zip(page, ours, strict=True) if theirs != mine]
    if off:
        around = [dict(zip(ours, nudged(factor), strict=True)) for factor in (1 - 1e-4, 1 + 1e-4)]
        for theirs, mine in off:
            assert NUMBER.sub("#", theirs) == NUMBER.sub("#", mine)
            printed, *found = (NUMBER.findall(row) for row in (theirs, mine, *(table[mine] for table in around)))
            for number, *choices in zip(printed, *found, strict=True):
                assert number in choices


def test_words_of_page_and_readme_have_the_numbers_of_the_run():
    """Largest deviations, sag, vibration, stiffness, price of the welded joints: as they are rounded in the words."""
    page, readme = (" ".join(path.read_text(encoding="utf-8").split()) for path in (PAGE, README))
    robot, welded = part("robot"), part("welded").sel(reading="radii", arm=0.373, roll=17.0)
    deviation = 1e6 * robot.com_deviation.values
    _, y, z = np.abs(deviation).max(axis=0)
    rest = robot.time >= 1.0
    tips, payload = (
        1e6 * float((robot[name][rest].max("time") - robot[name][rest].min("time")).max())
        for name in ("tip_deflection", "com_deviation")
    )
    hang = 1e6 * float(np.abs(robot.tip_deflection[0]).max())
    assert f"{y:.1f} µm in Y and {z:.1f} µm in Z" in page
    assert f"{abs(deviation[0, 2]):.1f} of {z:.1f} µm in Z are there at rest" in page
    assert (
        f"by {tips:.1f} µm from peak to peak (at rest they hang {hang:.0f} µm off), the payload by {payload:.2f}"
        in page
    )
    assert f"EA / 750 mm = {2e11 * np.pi / 4 * 0.027**2 / 0.75 / 1e6:.0f} N/µm" in page
    off = np.linalg.norm(deviation, axis=1)
    assert f"by up to {off.max():.0f} µm" in readme and f"{off[0]:.0f} µm are sag at rest" in readme
    price = f"{1e-9 * float(welded.stress):.1f} GPa in the pistons, slopes of {float(welded.slope):.1f}"
    assert price in readme


def test_headline_is_micrometres(table):
    assert table["Fig. 9, section 4.1"].verdict == NOT
    # Values of an independent estimate by rigid statics: 16 um of sag and a few of inertia.
    peak = np.abs(part("robot").com_deviation).max("time").values
    assert np.all(peak < [1e-5, 2e-5, 4e-5])


def test_road_to_the_singularity(table):
    verdicts = [table[f"Half-angles {angles} deg"].verdict for angles in ("5 to 25", 27, 28, 29)]
    assert verdicts == [MISSES] * 3 + [BREAKS]  # at 28 deg y is 36 mm where the paper has 5
    assert "10 deg: y 9.39 µm, z 19.3 µm" in table["Half-angles 5 to 25 deg"].ours
    assert "singular pose at 17.0 deg of roll" in table["Half-angles 29 deg"].ours
    assert "beyond 18.7 deg no equilibrium" in table["Half-angles 29 deg"].ours


@pytest.mark.parametrize("name", ["half-angles", "half-angles-radii"])
def test_deviation_grows_towards_the_singularity(name):
    data = part(name)
    whole = data.deviation_peak.max("axis").values
    good = np.isfinite(whole)
    assert np.all(np.diff(whole[good][1:]) > 0)
    frequency = data.lowest_frequency.values[3:]
    assert np.all(np.diff(frequency[np.isfinite(frequency)]) < 0) and np.isfinite(frequency[:-1]).all()


def test_rows_that_hold(table):
    assert table["Fig. 8"].verdict == table["Table 2"].verdict == table["Section 3"].verdict == HOLDS
    assert table["Figs. 3-4, printed curves"].verdict == OPEN
    assert (table["Fig. 3"].verdict, table["Fig. 4"].verdict) == (IN_PART, HOLDS)


def test_what_is_backed_out_is_not_taken_for_evidence(table):
    roll, abstract = table["What would give it: roll"], table["Abstract"]
    assert "by construction and shows nothing" in roll.reason and "says nothing" in abstract.reason
    assert not any("where they come from" in row.reason or "tuned" in row.reason for row in table.values())


def test_a_row_keeps_to_one_elastic_length(table):
    """750 mm stretch in the model, 600 mm are printed: 153 and 191 N/um, 596 and 745 kN for 3.9 mm."""
    elastic, legs = table["Table 3, elastic length"], table["What would give it: legs"]
    assert "750 mm that stretch" in elastic.ours and "153 N/µm" in elastic.ours and "191 N/µm" in elastic.ours
    assert "153 N/µm over its 750 mm" in table["Fig. 9, section 4.1"].reason
    needed = float(re.search(r"600 mm of piston need (\d+) kN", legs.reason)[1])
    assert needed == pytest.approx(1.1451e8 / 0.6 * 3.91e-3 / 1e3, rel=0.01)


def test_vibration_is_told_apart_from_sag(table):
    """At rest tips hang 37 um off; after the roll they vibrate by 1.6 um from peak to peak, the payload by 0.23 um."""
    row = table["Title, section 4.1"]
    tips, payload = re.search(r"tips vibrate by ([\d.]+) µm, the payload by (\d+) nm", row.ours).groups()
    assert float(tips) == pytest.approx(1.6, rel=0.1) and float(payload) == pytest.approx(234, rel=0.1)
    assert "37 µm off at rest, 48 µm at most" in row.reason and "Below its Euler load" in row.reason


def test_a_jump_would_show_in_the_forces(table):
    row = table["Start with a jump"]
    assert "3.08 mJ" in row.reason
    energy, force = re.search(r"up to ([\d.]+) J and drive forces of up to (\d+) kN", row.reason).groups()
    assert float(energy) == pytest.approx(4.37, rel=0.1) and float(force) == pytest.approx(20.6, rel=0.1)


def test_readings_of_the_travel(table):
    numbers = [int(n) for n in re.findall(r"(\d+) mm", table["Fig. 7"].ours)]
    assert numbers == [64, 124, 140, 262, 262]
    assert table["Fig. 7"].verdict == IN_PART


def test_shapes_of_equation_2_have_the_norm_that_the_row_prints(table):
    # alpha^2 = 1.855645, 0.964064, 1.001553 in closed form.
    printed = [float(n) for n in re.findall(r"\d\.\d{4}", table["Eq. 2"].ours)]
    np.testing.assert_allclose(printed, [1.855645, 0.964064, 1.001553], atol=6e-5)


def test_leg_errors_for_the_papers_deviation():
    # A turn by 0.030 rad moves the joints of a circle of 0.15 m by at most 4.5 mm: the legs by less.
    errors = part("assumptions").length_error.values
    assert 1e-3 < np.abs(errors).max() < 4.5e-3


def test_row_is_one_line_of_markdown():
    lines = [line for line in claims_markdown(claims(whole_study())).splitlines() if line.startswith("|")]
    assert {line.count(" | ") for line in lines} == {4} and len(lines) == len(claims(whole_study())) + 3 * 2


def test_norms_of_the_papers_shapes_by_tables(monkeypatch):
    # Clamped-free shapes cosh - cos - s (sinh - sin) have the norm 1, s = 0.734096, 1.018467, 0.999224 (Blevins 1979);
    # those of Eq. 2 are larger by 1 / s. Printed to 1e-4.
    shapes = [SimpleNamespace(eps=eps) for eps in (1.87510407, 4.69409113, 7.85475744)]
    monkeypatch.setattr(claims_actuator, "clamped_free", lambda _: shapes)
    (claim,) = claims_actuator._shapes.claims(PaperStudy(parts={}))
    norms = [float(x) for x in NUMBER.findall(claim.ours.split("alpha^2 =")[1])[:3]]
    np.testing.assert_allclose(norms, np.array([0.734096, 1.018467, 0.999224]) ** -2, atol=1e-4)
