"""Refusals of study files, text -> message, letter for letter: those that the suite provokes, and some of each kind.

`refusals.jsonl` holds the samples, then a row for each refusal: the lines of a sample that are replaced, which reader,
and the message. Where a message is meant to change, or new refusals came:

    python -m pytest -p tests.golden.refusals -n 2      # writes what is refused into build/refusals/
    python -m tests.golden.refusals [20000]              # makes the table of that and of what it held before

With a number it damages as many samples, too, and keeps those whose refusal is of a kind not seen yet.
"""

from __future__ import annotations

import difflib
import json
import os
import random
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from tools.damaged import WHOLE, added, doubled, removed, removed_neatly, retabled, scaled, value, wrong_name

from flexapod import model
from flexapod.common.errors import InputError
from flexapod.model import PRESETS, preset_text
from flexapod.model.file import files

ROOT = Path(__file__).parents[2]
RECORDED = ROOT / "build" / "refusals"
TABLE = Path(__file__).with_suffix(".jsonl")
READERS = {"loads": files.loads, "loads_robot": files.loads_robot}
_drawn: list[object] = []  # markers of the test that runs, if its input is drawn at random
LONGEST = 20_000  # characters of a text that are worth keeping


@cache
def samples() -> dict[str, list[str]]:
    """Lines of the samples that the table stands on, by name."""
    return {row["sample"]: row["lines"] for row in _stored() if "sample" in row}


@cache
def _studies() -> dict[str, list[str]]:
    """Lines of all whole studies at hand, by name."""
    texts = {name: preset_text(name) for name in PRESETS}
    texts |= {path.stem: path.read_text(encoding="utf-8") for path in sorted((ROOT / "examples").glob("*.toml"))}
    texts |= {f"damaged-{name}": parts["study.toml"] for name, parts in WHOLE.items() if "study.toml" in parts}
    return {"": []} | {name: text.splitlines(keepends=True) for name, text in texts.items()}


def packed(text: str, among: dict[str, list[str]]) -> dict[str, object]:
    """The sample that is most like a text, and what is replaced in it: [first line, one past the last, new lines]."""
    lines = text.splitlines(keepends=True)
    here = set(lines)
    base = max(among, key=lambda name: len(here & set(among[name])) - 1e-3 * len(among[name]))
    codes = difflib.SequenceMatcher(None, among[base], lines, autojunk=False).get_opcodes()
    return {"base": base, "edits": [[a, b, lines[c:d]] for tag, a, b, c, d in codes if tag != "equal"]}


def unpacked(row: dict, among: dict[str, list[str]]) -> str:
    """The text of a row."""
    lines = list(among[row["base"]])
    for a, b, new in reversed(row["edits"]):
        lines[a:b] = new
    return "".join(lines)


def message(reader: str, text: str) -> str | None:
    """What a reader says of a text; None where it takes it."""
    try:
        READERS[reader](text)
    except InputError as error:
        return str(error)
    return None


def rows() -> list[dict]:
    """Refusals of the table."""
    return [row for row in _stored() if "message" in row]


@cache
def _stored() -> list[dict]:
    return (
        [json.loads(line) for line in TABLE.read_text(encoding="utf-8").split("\n") if line] if TABLE.exists() else []
    )


def kind(said: str) -> str:
    """A message without its numbers and values."""
    return re.sub(r"-?\d[\w.+-]*", "#", re.sub(r"= .*?: ", "= : ", re.sub(r"'[^']*'|\"[^\"]*\"", "''", said)))


def of_damaged(count: int, seen: set[str]) -> Iterator[tuple[str, str]]:
    """Readers and texts of damaged samples whose refusals are of a kind that is not among those seen."""
    for seed in range(count):
        r = random.Random(seed)
        text = "".join(_studies()[r.choice(list(_studies()))])
        try:
            text = r.choice((value, value, scaled, wrong_name, removed, removed_neatly, doubled, added, retabled))(
                r, text
            )
        except (IndexError, ValueError):  # nothing to damage
            continue
        said = message("loads", text)
        if said is not None and len(text) <= LONGEST and kind(said) not in seen:
            seen.add(kind(said))
            yield "loads", text


def pytest_configure() -> None:
    """As a plugin of pytest: what readers refuse is written down."""
    RECORDED.mkdir(parents=True, exist_ok=True)
    for name, reader in READERS.items():
        _listen(name, reader)


def pytest_runtest_setup(item) -> None:
    """Whether what comes is drawn at random: that is not written down."""
    _drawn[:] = item.iter_markers("property")


def _listen(name: str, reader) -> None:
    def heard(text: str, *, path: str | Path | None = None):
        try:
            return reader(text, path=path)
        except InputError:
            if isinstance(text, str) and len(text) <= LONGEST and not _drawn:
                with (RECORDED / f"{os.getpid()}.jsonl").open("a", encoding="utf-8") as file:
                    file.write(json.dumps([name, text]) + "\n")
            raise

    setattr(files, name, heard)
    setattr(model, name, heard)


def main(count: int = 0) -> int:
    """Make the table of what was recorded, of what it held, and of damaged samples."""
    heard = {(row["reader"], unpacked(row, samples())) for row in rows()}
    for file in sorted(RECORDED.glob("*.jsonl")):
        heard |= {tuple(json.loads(line)) for line in file.read_text(encoding="utf-8").splitlines()}
    said = {pair: message(*pair) for pair in heard}
    said |= {pair: message(*pair) for pair in of_damaged(count, {kind(words) for words in said.values() if words})}
    found = [  # what is taken now was refused for a file beside it
        {"reader": reader, "message": words, **packed(text, _studies())}
        for (reader, text), words in said.items()
        if words is not None
    ]
    found.sort(key=lambda row: (row["reader"], row["message"], row["base"], str(row["edits"])))
    used = sorted({row["base"] for row in found})
    table = [{"sample": name, "lines": _studies()[name]} for name in used] + found
    TABLE.write_text("".join(json.dumps(row, ensure_ascii=False) + "\n" for row in table), encoding="utf-8")
    print(f"{len(found)} refusals, {len({row['message'] for row in found})} messages")
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
