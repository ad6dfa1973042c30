"""`flexapod replicate`: what it leaves on disk."""

import csv
import re
from html.parser import HTMLParser

import pytest
from tests.helpers.paper_parts import at_hand, study_parts, whole_study

from flexapod.analysis import open_results
from flexapod.common.errors import InputError
from flexapod.verification.paper import outputs as app_replicate
from flexapod.verification.paper import study as paper
from flexapod.verification.paper.outputs import replicate

pytestmark = [pytest.mark.cli, pytest.mark.xdist_group("claims")]  # one process computes the parts
ANGLES = (10.0, 29.0)


class Body(HTMLParser):
    """First text of the body, all text, all sources and links."""

    def __init__(self):
        super().__init__()
        self.texts, self.links, self.inside = [], [], False

    def handle_starttag(self, tag, attrs):
        self.inside |= tag == "body"
        self.links += [value for name, value in attrs if name in ("src", "href")]

    def handle_data(self, data):
        if self.inside and data.strip():
            self.texts.append(data.strip())


def read_page(path):
    body = Body()
    body.feed(path.read_text(encoding="utf-8"))
    return body


@pytest.fixture
def coarse(monkeypatch):
    """The steps of the study, with results at hand."""
    steps = tuple(
        paper.StudyPart(
            name=s.name, words=s.words, weight=s.weight, compute=lambda _, name=s.name: study_parts(ANGLES)[name]
        )
        for s in paper.STEPS
    )
    monkeypatch.setattr(paper, "STEPS", steps)
    return steps


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("replicate")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(app_replicate, "compute", at_hand(whole_study(ANGLES)))
        replicate(place, formats=("png", "svg"))
    return place


def test_figures_of_the_paper_are_there_as_png_and_svg(folder):
    names = {"actuator-response", "roll-law", "robot-end", "leg-lengths", "forces-rigid", "com-path", "modes-bending"}
    names |= {"deviation-by-cause", "tip-deflections", "energies", "half-angles", "velocity-jump", "actuator-solid"}
    names |= {"light-pistons", "welded", "commands-ahead", "shaped-roll", "force-feedback", "joint-friction"}
    names |= {"error-budget"}
    for name in names:
        assert (folder / "figures" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
        assert "</svg>" in (folder / "figures" / f"{name}.svg").read_text(encoding="utf-8")


def test_data_are_there_as_netcdf_and_csv(folder):
    for name, data in study_parts(ANGLES).items():
        assert set(open_results(folder / "data" / f"{name}.nc").data_vars) == set(data.data_vars)
        with (folder / "data" / f"{name}.csv").open(encoding="utf-8", newline="") as file:
            assert len(list(csv.reader(file))) > 1


def test_values_without_time_name_their_labels(folder):
    rows = (folder / "data" / "half-angles.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "variable,labels,value,unit"
    peak = float(study_parts(ANGLES)["half-angles"].deviation_peak.sel(half_angle=10.0, axis="z"))
    assert f"deviation_peak,half_angle=10.0 axis=z,{peak:.10g},m" in rows


def test_a_value_without_labels_is_a_row(folder):
    """A count stopped the whole with a ValueError of pandas."""
    rows = (folder / "data" / "tolerances.csv").read_text(encoding="utf-8").splitlines()
    assert "sample_count,,1000,1" in rows


def test_first_sentence_gives_deviation_and_cause(folder):
    first = read_page(folder / "report.html").texts[0]
    assert re.search(r"misses its rigid path by up to [\d.]+\s[µm]", first)
    assert "largest cause is stretch of the pistons" in first


def test_report_is_self_contained(folder):
    links = read_page(folder / "report.html").links
    assert links and all(link.startswith(("data:", "#")) for link in links)
    assert (folder / "report.html").stat().st_size < 10e6  # what mail servers take


def test_report_gives_claims_open_values_and_how_to_repeat(folder):
    texts = " ".join(read_page(folder / "report.html").texts)
    for words in ("does not hold", "no equilibrium", "flexapod replicate --out DIR", "leg.cylinder.mass", "numpy"):
        assert words in texts
    assert "the paper gives no cylinder; 3 kg is a steel tube of this size" in texts
    assert (folder / "claims.md").read_text(encoding="utf-8").startswith("### The paper's own claims\n\n22 rows: ")


def test_progress_rises_to_one(coarse, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(app_replicate, "paper_figures", lambda *_: {})
    replicate(tmp_path, progress=lambda words, share: seen.append((words, share)))
    shares = [share for _, share in seen]
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] == pytest.approx(0.75)
    assert "robot with flexible legs" in {words for words, _ in seen}


def test_interrupt_leaves_what_is_done_and_no_old_report(coarse, tmp_path, monkeypatch):
    def stop(_):
        raise KeyboardInterrupt

    changed = [step if step.name != "modes" else paper.StudyPart(name="modes", words="", weight=1, compute=stop)
               for step in coarse]  # fmt: skip
    monkeypatch.setattr(paper, "STEPS", tuple(changed))
    (tmp_path / "report.html").write_text("of an older run", encoding="utf-8")
    with pytest.raises(KeyboardInterrupt):
        replicate(tmp_path)
    done = {path.name for path in (tmp_path / "data").iterdir()}
    assert {"robot.nc", "robot.csv", "robot-lumped.nc"} <= done
    assert not {name for name in done if name.startswith((".", "modes", "jump"))}
    assert not (tmp_path / "report.html").exists()


def test_folder_that_is_a_file_is_refused(coarse, tmp_path):
    (tmp_path / "out").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="cannot be"):
        replicate(tmp_path / "out")
