"""Every public name says what it is, and its example gives what it says."""

import doctest
import inspect

import matplotlib
import pytest

import flexapod as fx

pytestmark = pytest.mark.unit

matplotlib.use("Agg")
NAMES = [name for name in fx.__all__ if not inspect.ismodule(getattr(fx, name)) and name != "__version__"]
OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
#: A class in a module of its own, and minutes: the tutorial of elements and the gallery have one, the paper the other.
ELSEWHERE = {"Element", "replicate"}


@pytest.mark.parametrize("name", NAMES)
def test_a_public_name_has_a_line_and_an_example_that_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    thing = getattr(fx, name)
    assert inspect.getdoc(thing)
    found = [test for test in doctest.DocTestFinder(recurse=False).find(thing, name, globs={"fx": fx}) if test.examples]
    assert bool(found) != (name in ELSEWHERE)
    for example in found:
        told = []
        doctest.DocTestRunner(optionflags=OPTIONS).run(example, out=told.append)
        assert not told, "".join(told)


@pytest.mark.parametrize("name", [n for n in NAMES if inspect.isfunction(getattr(fx, n))])
def test_a_call_documents_its_parameters_its_result_and_its_refusals(name):
    thing = getattr(fx, name)
    words = inspect.getdoc(thing)
    missing = [p for p in inspect.signature(thing).parameters if p not in words.split("Returns\n")[0]]
    assert not missing
    assert "Returns\n-------" in words and "Raises\n------" in words
