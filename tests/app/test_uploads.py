"""An uploaded study reads no file but the tables that were sent with it, whatever key names which file, and how."""

import json
import re
from pathlib import Path

import pytest

from flexapod import model
from flexapod.app.browser.document import Document, edit_values
from flexapod.app.browser.header import open_source
from flexapod.app.browser.uploads import read_upload
from flexapod.common.errors import InputError
from flexapod.common.tables.columns import columns_of
from flexapod.common.tables.named_files import NamedFiles
from flexapod.common.tables.reference import reference
from flexapod.common.tables.section import Section
from flexapod.common.tables.table import Table
from flexapod.common.tables.toml import toml_text
from flexapod.model.file.key_trials import study_data

pytestmark = pytest.mark.contract

NAME = re.compile(r'"([\w-]+\.(?:csv|json))"')  # of a table, in the examples of the reference
EXAMPLES = {
    f"{entry.table} {entry.title}".strip(): text
    for entry in reference().entries
    if NAME.search(text := toml_text(study_data(entry)))
}
SECRET = "SECRET" * 100


def kinds(kind=Table):
    """All classes of tables that flexapod has."""
    for inner in kind.__subclasses__():
        yield from [inner] if inner.__module__.startswith("flexapod.") else []
        yield from kinds(inner)


@pytest.fixture
def read_of(monkeypatch):
    """Class and key of every file that is asked for while a study is read."""
    found, asked, read, stored = set(), [], Section.read, Section._stored

    def reading(section, kind, **options):
        asked.append(kind)
        try:
            return read(section, kind, **options)
        finally:
            asked.pop()

    def storing(section, name):
        found.add((asked[-1], name))
        return stored(section, name)

    monkeypatch.setattr(Section, "read", reading)
    monkeypatch.setattr(Section, "_stored", storing)
    return found


def write(folder):
    folder.mkdir()
    for file, text in reference().files.items():
        (folder / file).write_text(text)
    return folder


def forms(name, folder, outside):
    """Ways to a file that was not sent; where it is one that can be read, it is as it should be."""
    (folder / f"link-{name}").symlink_to(outside / name)
    (folder / "inner").mkdir()
    (folder / "inner" / name).write_text((outside / name).read_text())
    (folder / "round").symlink_to(outside)
    (folder / "zero.csv").symlink_to("/dev/zero")
    (folder / f".{name}").write_text((outside / name).read_text())
    return [
        str(outside / name), f"../outside/{name}", f"./{name}", f"inner/{name}", f"inner\\{name}", f"round/{name}",
        f"link-{name}", f".{name}", f"{folder}/{name}", f"inner/../{name}", f"..\\outside\\{name}", f"C:\\{name}",
        f"file://{outside / name}", f"file:{outside / name}", f"~/{name}", f"~root/{name}", f"$HOME/{name}",
        "/proc/self/environ", "/dev/stdin", "/dev/zero", "zero.csv", "/etc/passwd", "", ".", "..", "round", "inner",
        f"{name}\0", f"{name}\n", "a" * 5000, f"http://localhost/{name}", "not-there.csv",
    ]  # fmt: skip


def test_every_key_that_takes_a_file_is_marked_and_has_an_example(read_of, tmp_path):
    """So that a new one is among those that are tried below."""
    sent = write(tmp_path / "sent")
    for text in EXAMPLES.values():
        read_upload("a.toml", text.encode(), sent)
    marked = {(kind, c.name) for kind in kinds() for c in columns_of(kind).values() if c.file}
    assert read_of == marked
    assert len(marked) >= 9


@pytest.mark.parametrize("title", EXAMPLES)
def test_no_form_of_a_name_leads_to_what_was_not_sent(title, tmp_path):
    text = EXAMPLES[title]
    sent, outside = write(tmp_path / "sent"), write(tmp_path / "outside")
    study = read_upload("a.toml", text.encode(), sent)
    names = sorted(set(NAME.findall(text)))
    for number, name in enumerate(names):
        folder = write(tmp_path / f"sent {number}")
        for form in forms(name, folder, outside):
            changed = text.replace(f'"{name}"', json.dumps(form))
            assert changed != text
            with pytest.raises(InputError) as refused:
                read_upload("a.toml", changed.encode(), folder)
            assert "was not sent" in str(refused.value) or "VC-A" in str(refused.value), form  # a curve of the floor
            assert "time" not in str(refused.value)
            assert len(str(refused.value)) < 600
    assert study.text == text


@pytest.mark.parametrize("form", ["/proc/self/environ", "../outside/path.csv", "heat.csv "])
def test_who_changes_a_study_on_the_page_names_no_other_file(form, tmp_path):
    """What a visitor types is no more trusted than what he sends, in the study that all begin with as in his own."""
    title = "motion a table"
    sent, outside = write(tmp_path / "sent"), write(tmp_path / "outside")
    (outside / "study.toml").write_text(EXAMPLES[title])
    for document in (
        read_upload("a.toml", EXAMPLES[title].encode(), sent),
        open_source(outside / "study.toml").document.with_folder(sent),
    ):
        assert edit_values(document, {"motion.hold": 1.0}).study is not None
        assert "was not sent" in str(edit_values(document, {"motion.file": form}).error)
    assert "was not sent" in str(edit_values(Document(EXAMPLES[title], str(outside / "study.toml")), {}).error)


def test_a_table_that_was_sent_is_read_and_long_cells_are_cut(tmp_path):
    sent = write(tmp_path / "sent")
    text = EXAMPLES["motion a table"].encode()
    for table in (
        SECRET, f"time [s], {SECRET} [deg]\n0, 0\n", f"time [s], roll [{SECRET}]\n0, 0\n",
        f"time [s], roll [deg]\n0, {SECRET}\n", f"{SECRET} [s], roll [deg]\n0, 1\n",
    ):  # fmt: skip
        (sent / "path.csv").write_text(table)
        with pytest.raises(InputError) as refused:
            read_upload("a.toml", text, sent)
        said = json.dumps(refused.value.as_dict()) + str(refused.value)
        assert "SECRETS" in said
        assert max(len(run) for run in re.findall(r"[SECRT]+", said)) <= 80


def test_a_local_study_names_files_wherever_they_are(tmp_path):
    """Relative to its folder, above it, absolute, by links: files of one's own are as they were."""
    here, there = write(tmp_path / "here"), write(tmp_path / "there")
    (here / "link.csv").symlink_to(there / "path.csv")
    for form in ("path.csv", "./path.csv", "../there/path.csv", str(there / "path.csv"), "link.csv"):
        text = EXAMPLES["motion a table"].replace('"path.csv"', json.dumps(form))
        assert model.loads(text, path=here / "study.toml").motion.file == form
    assert NamedFiles(Path()).place("x.csv") == Path("x.csv")
