"""Parts of a document by hand: what they look like on a terminal, on a page and as data."""

import json
from pathlib import Path

import pytest

from flexapod.common.quantities import columns, sentence
from flexapod.output.text import html
from flexapod.output.text.parts import Bullets, Chapter, Lines, Remarks, Text, TextTable
from flexapod.output.text.terminal import print_answer, print_items

pytestmark = pytest.mark.unit

LEGS = TextTable(["force [N]", "kind"], [["1", "2.50", "strut"], ["10", "12.00", "<piston>"]], left=(0, 2), of="leg")


def printed(capsys, *items, **more):
    print_items(items, **more)
    return [line.rstrip() for line in capsys.readouterr().out.splitlines()]


def test_a_table_in_a_section_is_set_in_and_names_its_rows(capsys):
    assert printed(capsys, "Before.", Chapter("Legs", [LEGS, "After."])) == [
        "Before.",
        "",
        "Legs",
        "          force [N]  kind",
        "  leg 1        2.50  strut",
        "  leg 10      12.00  <piston>",
        "  After.",
    ]


def test_a_section_with_nothing_in_it_is_left_out_unless_its_title_says_something(capsys):
    assert printed(capsys, Chapter("Nothing", iter(())), Chapter("5 of 5 poses.", [], close=True)) == ["5 of 5 poses."]
    assert html.parts([Chapter("Nothing", iter(()))]) == ""


@pytest.mark.parametrize(("verbose", "lines"), [
    (False, ["Warning: It is so", "Warning: One", "More about these remarks: --verbose."]),
    (True, ["Warning: It is so. Because of that", "Warning: One"]),
])  # fmt: skip
def test_remarks_say_the_rest_when_it_is_asked_for(capsys, verbose, lines):
    told = Remarks(["It is so. Because of that", "One"], "Warning: ")
    assert printed(capsys, told, verbose=verbose) == lines
    page = html.parts([told])
    assert page == "<ul><li><details><summary>It is so</summary>Because of that</details></li><li>One</li></ul>"


def test_lines_of_a_file_and_lists(capsys):
    assert printed(capsys, Chapter("File", [Lines("a = 1\n\nb = 2")]), Bullets(["One.", "Two."])) == [
        "", "File", "    a = 1", "", "    b = 2", "One.", "Two.",
    ]  # fmt: skip
    folded = html.parts([Lines("a < 1", "File")])
    assert folded.startswith("<details><summary>File</summary>") and "a &lt; 1</pre></details>" in folded


def test_a_page_escapes_all_but_its_own_markup():
    page = html.parts(["1 < 2", Text("beside", "soft"), LEGS, TextTable((), [("a", "b")]), html.Html("<nav></nav>")])
    assert page.startswith('<p>1 &lt; 2</p>\n<p class="soft">beside</p>\n<table><thead><tr><th>Leg</th>')
    assert '<td data-label="kind">&lt;piston&gt;</td>' in page
    assert "<tr><td>a</td><td>b</td></tr>" in page and page.endswith("<nav></nav>")


def test_marks_are_styles_of_cells():
    page = html.parts([TextTable(("Case", "Verdict"), [("one", "pass")], marks={"pass": "good"})])
    assert '<td data-label="Verdict" class="good">pass</td>' in page


def test_an_answer_is_words_or_data(capsys):
    found = {"share": float("nan"), "files": [Path("a.nc")], "kinds": ("x", 1)}
    print_answer(["Found."], lambda: found, json=True)
    assert json.loads(capsys.readouterr().out) == {"share": None, "files": ["a.nc"], "kinds": ["x", 1]}
    print_answer(["Found."], lambda: pytest.fail("no data are asked for"), json=False)
    assert capsys.readouterr().out == "Found.\n"
    print_answer((pytest.fail("no words are asked for") for _ in "x"), lambda: found, json=True)


def test_columns_of_one_unit_and_sentences():
    assert columns("m", [4.33e-6, 1.2e-5], [9e-7]) == ["µm", ["4.33", "12.00"], ["0.90"]]
    assert sentence("it moves") == "It moves."
