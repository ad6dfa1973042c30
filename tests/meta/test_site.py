"""The sources of the site: links lead inside; every public name, command, table and variable has a page."""

import re

import pytest
from docs.site import commands, gallery, python, stage, studyfile, variables
from tests.golden.refusals import READERS, rows, samples, unpacked

import flexapod as fx
from flexapod.analysis.results.variables import VARIABLES
from flexapod.app.cli.cli import HOMES
from flexapod.app.cli.commands_study import titles
from flexapod.common.errors import InputError
from flexapod.common.tables.reference import plain_path, reference

pytestmark = pytest.mark.meta

NO_KEY = ("unknown key", "lies too deep", "has too many digits")


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    return stage.staged(tmp_path_factory.mktemp("site"))


def test_every_public_name_is_on_a_page_and_nothing_else_is_public():
    public = {name for name in dir(fx) if not name.startswith("__")} | {"__version__"}
    assert public == set(fx.__all__) == python.on_pages()
    assert len(python.FIRST) == 10 and set(python.FIRST) <= python.on_pages()


def test_every_command_has_a_page():
    assert len(commands.pages()) == len(HOMES) + 1
    text = commands.pages()[commands.FOLDER / "run.md"]
    assert "`--format FORMATS`" in text and "[default: png]" in text


def test_every_table_of_the_study_file_is_on_one_page():
    text = "\n".join(studyfile.pages().values())
    missing = [e.table for e in reference().entries if f"`{e.table}`" not in text]
    assert not missing


def test_every_variable_is_on_one_page():
    rows = [
        row
        for page in variables.pages().values()
        for row in re.findall(r"^\| `(\w+)` \|.*\| .* \|", page, re.MULTILINE)
    ]
    assert set(VARIABLES) <= set(rows)


def test_every_result_of_a_linear_system_says_what_it_is():
    words = {
        f"{call} {name}": x.attrs.get("long_name") for call, d in variables.linear().items() for name, x in d.items()
    }
    assert len(words) > 30 and not [name for name, said in words.items() if not said]


def test_the_key_of_every_refusal_leads_to_a_page():
    """A key that there is, on the page of its table; a name of the user's own by the table that it stands in."""
    listed = studyfile.pages()[studyfile.FOLDER / "keys.md"]
    keys = set(re.findall(r"^\| `([\w.]+)` \|", listed, re.MULTILINE))
    tables = {key.rpartition(".")[0] for key in keys}
    tables |= {table.partition(".")[0] for table in tables}
    places = {place.name for place in studyfile.pages()}
    assert set(re.findall(r"\]\(([\w-]+\.md)\) \|$", listed, re.MULTILINE)) <= places
    lost = []
    for row in rows()[::12]:
        try:
            READERS[row["reader"]](unpacked(row, samples()))
        except InputError as error:
            key = plain_path(str(error.key or "")).strip("[]")
            if key.partition(".")[0] not in tables or error.what in NO_KEY:
                continue  # no study file has it: the message lists what there is
            above = [key, key.rpartition(".")[0], "leg.springs" if key.startswith("leg.springs.") else ""]
            if not any(name in keys or name in tables for name in above):
                lost.append(row["message"])
    assert not lost


def test_links_between_pages_lead_somewhere(sources):
    for page in sources.rglob("*.md"):
        for link in re.findall(r"\]\((?!https?:|mailto:|#)([^)#\s]+)", page.read_text(encoding="utf-8")):
            assert (page.parent / link).exists(), f"{page.relative_to(sources)}: {link}"


def test_every_page_is_in_a_table_of_contents(sources):
    pages = {
        p.relative_to(sources).with_suffix("").as_posix(): p.read_text(encoding="utf-8") for p in sources.rglob("*.md")
    }
    listed = {"index"}
    for name, text in pages.items():
        for block in re.findall(r"```\{toctree\}\n(.*?)```", text, re.DOTALL):
            names = [
                re.sub(r".*<(.*)>", r"\1", line) for line in block.splitlines() if line and not line.startswith(":")
            ]
            listed |= {stage.to_root(name, found) for found in names}
    listed |= {path.relative_to(sources).with_suffix("").as_posix() for path in sources.rglob("*.py")}
    assert not sorted(set(pages) - listed)


def test_every_example_and_notebook_is_in_the_gallery():
    assert gallery.titles("gallery") == titles("--example") and gallery.titles("notebooks") == titles("--notebook")
