"""The claims table: verdicts follow from numbers, and the README says what the program says."""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.paper_parts import coarse_parts, coarse_study

from flexapod.study.paper.claim import BREAKS, HOLDS, IN_PART, NOT, OPEN, REACHES
from flexapod.study.paper.claims import claims, markdown
from flexapod.study.paper.study import STEPS

pytestmark = pytest.mark.xdist_group("claims")  # one process computes the parts
README = Path(__file__).parents[2] / "README.md"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")


@pytest.fixture(scope="module")
def table():
    return {claim.where: claim for claim in claims(coarse_study())}


def test_the_parts_are_those_of_replicate():
    assert list(coarse_parts()) == [step.name for step in STEPS]


def test_every_row_is_filled_and_appears_once(table):
    assert len(table) == len(claims(coarse_study()))
    for claim in table.values():
        assert all((claim.where, claim.says, claim.ours, claim.verdict, claim.reason))
        assert "nan" not in (claim.ours + claim.reason).lower()


def test_readme_says_what_the_program_says():
    """Made by `flexapod replicate --out DIR`, then the table of DIR/claims.md copied into the README.

    Words must be equal. Numbers of the coarse steps used here lie within 10 % of those of the table: they are printed
    with two or three digits, and peaks of a ringing robot depend on the step.
    """
    chapter = README.read_text(encoding="utf-8").split("## The paper's claims, one by one")[1]
    page = "\n".join(line for line in chapter.splitlines() if line.startswith("|")) + "\n"
    ours = markdown(claims(coarse_study()))
    assert NUMBER.sub("#", page).split("\n") == NUMBER.sub("#", ours).split("\n")
    printed, found = (np.array([float(n) for n in NUMBER.findall(text)]) for text in (page, ours))
    np.testing.assert_allclose(found, printed, rtol=0.1)


def test_headline_is_micrometres(table):
    assert table["Fig. 9, section 4.1"].verdict == NOT
    # Values of an independent estimate by rigid statics: 16 um of sag and a few of inertia.
    peak = np.abs(coarse_parts()["robot"].com_deviation).max("time").values
    assert np.all(peak < [1e-5, 2e-5, 4e-5])


def test_road_to_the_singularity(table):
    verdicts = [table[f"Half-angles {angle} deg"].verdict for angle in (5, 10, 15, 20, 25, 27, 28, 29)]
    assert verdicts == [NOT] * 6 + [REACHES, BREAKS]
    assert "singular pose at 17.0 deg of roll" in table["Half-angles 29 deg"].ours
    assert "beyond 18.7 deg no equilibrium" in table["Half-angles 29 deg"].ours


@pytest.mark.parametrize("name", ["half-angles", "half-angles-radii"])
def test_deviation_grows_towards_the_singularity(name):
    data = coarse_parts()[name]
    whole = data.deviation_peak.max("axis").values
    good = np.isfinite(whole)
    assert np.all(np.diff(whole[good][1:]) > 0)
    frequency = data.lowest_frequency.values[3:]
    assert np.all(np.diff(frequency[np.isfinite(frequency)]) < 0) and np.isfinite(frequency[:-1]).all()


def test_rows_that_hold(table):
    assert table["Fig. 8"].verdict == table["Table 2"].verdict == table["Section 3"].verdict == HOLDS
    assert table["Figs. 3-4, printed curves"].verdict == OPEN
    assert (table["Fig. 3"].verdict, table["Fig. 4"].verdict) == (IN_PART, HOLDS)


def test_shapes_of_equation_2_have_the_norm_that_the_row_prints(table):
    # alpha^2 = 1.855645, 0.964064, 1.001553 in closed form.
    printed = [float(n) for n in re.findall(r"\d\.\d{4}", table["Eq. 2"].ours)]
    np.testing.assert_allclose(printed, [1.855645, 0.964064, 1.001553], atol=6e-5)


def test_leg_errors_for_the_papers_deviation():
    # A turn by 0.030 rad moves the joints of a circle of 0.15 m by at most 4.5 mm: the legs by less.
    errors = coarse_parts()["assumptions"].length_error.values
    assert 1e-3 < np.abs(errors).max() < 4.5e-3


def test_row_is_one_line_of_markdown():
    lines = markdown(claims(coarse_study())).splitlines()
    assert {line.count(" | ") for line in lines} == {4}
