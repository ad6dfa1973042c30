"""Loops that a wheel brings: the file that this processor may run, whole, and only where nothing else was asked for."""

import pytest

from flexapod.mechanics.symbolic import compiler, processor
from flexapod.mechanics.symbolic.processor import BuiltLoops, built_loops, file_name, x86_level

pytestmark = pytest.mark.unit

NEHALEM = "fpu sse sse2 cx16 lahf_lm popcnt pni ssse3 sse4_1 sse4_2"
SANDY_BRIDGE = f"{NEHALEM} avx xsave"
HASWELL = f"{SANDY_BRIDGE} abm avx2 bmi1 bmi2 f16c fma movbe"
KNIGHTS_LANDING = f"{HASWELL} avx512f avx512cd avx512er avx512pf"
SKYLAKE = f"{HASWELL} avx512f avx512bw avx512cd avx512dq avx512vl"


@pytest.mark.parametrize(
    ("features", "level"),
    [
        ("fpu sse sse2", 1),
        (NEHALEM, 2),
        (SANDY_BRIDGE, 2),
        (HASWELL, 3),
        (HASWELL.replace("movbe", ""), 2),  # a virtual machine that leaves one out
        (KNIGHTS_LANDING, 3),
        (SKYLAKE, 4),
        (SKYLAKE.replace("fma", ""), 2),
    ],
)
def test_levels_of_known_processors(features, level):
    assert x86_level(features.split()) == level


@pytest.fixture
def wheel(tmp_path, monkeypatch):
    """A folder of a wheel for another machine than this, an x86-64-v3, with files of its three levels."""
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(processor, "BUILT", tmp_path)
    monkeypatch.setattr(processor.platform, "machine", lambda: "x86_64")
    monkeypatch.setattr(processor.sys, "platform", "linux")
    monkeypatch.setattr(processor, "_features", lambda: frozenset(HASWELL.split()))
    processor._fitting.cache_clear()
    for target in ("x86-64-v2", "x86-64-v3", "x86-64-v4"):
        (tmp_path / file_name("linux-x86_64", target, "0123456789abcdef", target.encode())).write_text(target)
    yield tmp_path
    processor._fitting.cache_clear()


def chosen() -> BuiltLoops | None:
    processor._fitting.cache_clear()
    return built_loops()


def test_the_highest_level_that_the_processor_has(wheel, monkeypatch):
    assert chosen().target == chosen().path.read_text() == "x86-64-v3"
    assert chosen().key == "0123456789abcdef"
    monkeypatch.setattr(processor, "_features", lambda: frozenset())
    assert chosen() is None


def test_a_damaged_file_is_passed_over(wheel):
    chosen().path.write_text("x86-64-v")
    assert chosen().target == "x86-64-v2"


def test_what_cc_names_compiles_all(wheel, monkeypatch):
    monkeypatch.setenv("CC", "gcc")
    assert chosen() is None


@pytest.mark.parametrize(("system", "machine"), [("linux", "aarch64"), ("win32", "AMD64"), ("darwin", "arm64")])
def test_other_systems_have_files_of_their_own(wheel, monkeypatch, system, machine):
    monkeypatch.setattr(processor.sys, "platform", system)
    monkeypatch.setattr(processor.platform, "machine", lambda: machine)
    assert chosen() is None
    target = "x86-64-v3" if machine == "AMD64" else None
    name = processor.system_name(system, machine)
    (wheel / file_name(name, target, "0123456789abcdef", b"its own")).write_bytes(b"its own")
    assert (chosen().path.read_text(), chosen().target) == ("its own", target)


def test_equations_are_compiled_for_the_target_of_the_loops_and_their_key_has_the_hash(wheel, monkeypatch):
    command = [processor.sys.executable]
    assert compiler._targets(["cc"]) == ["-march=x86-64-v3", "-march=native"]
    assert compiler._targets(["python", "-m", "ziglang", "cc"])[0] == "-march=x86_64_v3"
    assert compiler._targets(["cc", "-march=core2"]) == []
    names = [compiler._name([b"text"], ["-O1"], command)]
    old = chosen().path
    old.unlink()
    (wheel / file_name("linux-x86_64", "x86-64-v3", "0123456789abcdef", b"another release")).write_text(
        "another release"
    )
    assert chosen().target == "x86-64-v3"
    names.append(compiler._name([b"text"], ["-O1"], command))
    monkeypatch.setenv("CC", "cc")
    names.append(compiler._name([b"text"], ["-O1"], command))
    assert len(set(names)) == 3
    assert compiler._targets(["cc"]) == ["-march=native"]
