"""The cache of compiled kernels: whole files, of this user, within bounds, whatever else happens to the folder."""

import errno
import hashlib
import logging
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.helpers.counted_compiles import Compile, doubled, functions

from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics.robot import home_pose
from flexapod.mechanics.symbolic import cache, compiler
from flexapod.mechanics.symbolic.compiler import compiled_library, written_library
from flexapod.model import preset
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.locked_robot import _at_rest

pytestmark = [
    pytest.mark.unit,
    pytest.mark.optimised,
    pytest.mark.skipif(compiler.compiler() is None, reason="there is no C compiler"),
]


@pytest.fixture(scope="module")
def kernel(tmp_path_factory) -> Path:
    """A cache with one kernel that this process has not loaded: made by another one."""
    folder = tmp_path_factory.mktemp("made") / "cache"
    code = "from tests.helpers.counted_compiles import Compile; print(Compile()())"
    python(code, FLEXAPOD_CACHE=str(folder))
    (only,) = libraries(folder)
    return only


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("FLEXAPOD_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("FLEXAPOD_CACHE_MEGABYTES", raising=False)
    cache.warn_unused.cache_clear()
    return tmp_path / "cache"


@pytest.fixture
def scaled(folder) -> Compile:
    return Compile()


def python(code: str, **environment: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=Path(__file__).parents[2], env=os.environ | environment, text=True,
        capture_output=True, check=True,
    )  # fmt: skip
    return done.stdout


def libraries(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.so"))


def test_compiled_once_and_kept_for_this_user_alone(scaled, folder):
    old = os.umask(0)  # the least careful user
    try:
        assert doubled(scaled())
    finally:
        os.umask(old)
    assert doubled(scaled())
    assert scaled.built == 1
    (library,) = libraries(folder)
    if sys.platform != "win32":
        assert folder.stat().st_mode & 0o777 == library.stat().st_mode & 0o777 == 0o700


def test_whatever_the_library_depends_on_changes_its_name(tmp_path, monkeypatch):
    names = []

    def note(key=(b"ab", b"c"), command=(sys.executable,)) -> None:
        names.append(compiler._name(key, compiler.FLAGS, list(command)))

    note()
    note(key=(b"a", b"bc"))
    note(key=(b"ab", b"c", b"a source"))
    note(command=(sys.executable, "-m64"))
    program = tmp_path / "cc"
    shutil.copy(shutil.which("true") or sys.executable, program)
    note(command=(str(program),))
    program.write_bytes(b"another release of the compiler")
    note(command=(str(program),))
    for where, what, value in (
        (compiler.platform, "machine", lambda: "another"),
        (compiler.sys, "platform", "another"),
        (compiler, "FLAGS", ("-O2",)),
    ):
        with monkeypatch.context() as changed:
            changed.setattr(where, what, value)
            note()
    assert len(set(names)) == len(names)
    note()
    assert names[-1] == names[0]


def test_a_changed_c_source_is_compiled(folder, tmp_path):
    source = tmp_path / "more.c"
    for text in ("int more;", "int less;"):
        source.write_text(text)
        written_library((source,), compiler.compiler())
    assert len(libraries(folder)) == 2


def test_what_leaves_the_equations_as_they_are_compiles_nothing(scaled, folder, monkeypatch):
    """A comment, a docstring, another release of casadi: the text is built once more, and is known from then on."""
    assert doubled(scaled())
    monkeypatch.setattr(compiler, "_build", None)
    for _ in range(2):
        assert doubled(scaled(2.0, "a comment"))
    with monkeypatch.context() as changed:
        changed.setattr(compiler, "version", lambda _: "another")
        assert doubled(scaled())
    assert scaled.built == 3
    assert len(libraries(folder)) == 1


@pytest.mark.parametrize("text", ["", "nothing", "0" * 32])
def test_a_damaged_note_of_what_equations_are(scaled, folder, text):
    assert doubled(scaled())
    (note,) = folder.glob("*.text")
    note.write_text(text)
    for built in (2, 2):
        assert doubled(scaled())
        assert scaled.built == built
    assert len(libraries(folder)) == 1


def test_eight_processes_on_an_empty_folder(folder, tmp_path):
    code = (
        "import sys, time, pathlib\n"
        "from tests.helpers.counted_compiles import Compile, doubled\n"
        "import casadi\n"
        "compile, here = Compile(), pathlib.Path(sys.argv[1])\n"
        "(here / f'ready-{sys.argv[2]}').touch()\n"
        "while not (here / 'go').exists():\n    time.sleep(0.001)\n"
        "print(doubled(compile()), compile.built)\n"
    )
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", code, str(tmp_path), str(i)], cwd=Path(__file__).parents[2], text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        )
        for i in range(8)
    ]  # fmt: skip
    while len(list(tmp_path.glob("ready-*"))) < 8 and all(p.poll() is None for p in processes):
        time.sleep(0.01)
    (tmp_path / "go").touch()
    answers = [process.communicate() for process in processes]
    assert [words for _, words in answers] == [""] * 8
    assert [out.split()[0] for out, _ in answers] == ["True"] * 8
    assert sum(int(out.split()[1]) for out, _ in answers) >= 2, "they did not start together: nothing is tested"
    library, note = sorted(folder.iterdir(), key=lambda path: path.suffix)  # one library, and nothing unfinished
    assert cache.LIBRARY.fullmatch(library.name)
    assert cache.TEXT.fullmatch(note.name)


def named(kernel: Path, content: bytes) -> str:
    return f"{kernel.name[:32]}-{hashlib.sha256(content).hexdigest()[:16]}.so"


def another_architecture(library: bytes) -> bytes:
    """The same ELF file for SPARC (e_machine 2)."""
    return library[:18] + (2).to_bytes(2, "little") + library[20:]


@pytest.mark.parametrize("honest", [False, True], ids=["its name kept", "named after its content"])
@pytest.mark.parametrize("damage", ["truncated", "text", "empty", "architecture", "symbols"])
def test_a_damaged_or_foreign_library_is_built_again(scaled, folder, kernel, tmp_path, damage, honest):
    content = kernel.read_bytes()
    if damage == "symbols":
        (tmp_path / "other.c").write_text("int other(void) { return 1; }")
        line = [*compiler.compiler(), "-shared", "-fPIC", "-o", "other.so", "other.c"]
        subprocess.run(line, cwd=tmp_path, check=True)
    content = {
        "truncated": content[: len(content) // 2 if not honest else 60],
        "text": b"not a library",
        "empty": b"",
        "architecture": another_architecture(content),
        "symbols": (tmp_path / "other.so").read_bytes() if damage == "symbols" else b"",
    }[damage]
    folder.mkdir(mode=0o700)
    bad = folder / (named(kernel, content) if honest else kernel.name)
    bad.write_bytes(content)
    assert doubled(scaled())
    assert scaled.built == 1
    assert (folder / kernel.name).read_bytes() == kernel.read_bytes()
    assert doubled(scaled())
    assert scaled.built == 1


def test_a_damaged_library_does_not_kill_a_new_process(folder, kernel):
    # Loading half a library ends the process with a bus error: it must be noticed before.
    folder.mkdir(mode=0o700)
    (folder / kernel.name).write_bytes(kernel.read_bytes()[:6000])
    assert python("from tests.helpers.counted_compiles import *; c = Compile(); print(doubled(c()), c.built)") == (
        "True 1\n"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="the user's profile is private by its access list")
def test_a_folder_that_others_may_write_to_is_not_trusted(scaled, folder, kernel, caplog):
    folder.mkdir()
    folder.chmod(0o777)
    shutil.copy(kernel, folder)
    assert doubled(scaled())
    assert doubled(scaled())
    assert scaled.built == 2  # neither loaded from there nor left there
    assert [path.name for path in libraries(folder)] == [kernel.name]
    assert len(caplog.records) == 1
    assert "others may write to it" in caplog.text
    assert cache.cache_content().unused_because


@pytest.mark.skipif(sys.platform == "win32", reason="the user's profile is private by its access list")
def test_what_another_user_owns_is_not_trusted(scaled, folder, kernel, caplog, monkeypatch):
    folder.mkdir(mode=0o700)
    shutil.copy(kernel, folder)
    with monkeypatch.context() as someone:
        real = Path.stat
        someone.setattr(Path, "stat", lambda path, **k: os.stat_result([*real(path, **k)[:4], 4711, *real(path)[5:]]))
        assert doubled(scaled())
    assert scaled.built == 1
    assert "belongs to another user" in caplog.text


@pytest.mark.skipif(sys.platform == "win32", reason="the user's profile is private by its access list")
def test_a_library_that_others_may_change_is_built_again(scaled, folder, kernel):
    folder.mkdir(mode=0o700)
    shutil.copy(kernel, folder)
    (folder / kernel.name).chmod(0o666)
    assert doubled(scaled())
    assert scaled.built == 1
    assert (folder / kernel.name).stat().st_mode & 0o777 == 0o700


def no_folder(folder: Path, _: pytest.MonkeyPatch) -> str:
    folder.write_text("a file")
    return "File exists"


def below_a_file(folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    folder.write_text("a file")
    monkeypatch.setenv("FLEXAPOD_CACHE", str(folder / "cache"))
    return "Not a directory"


def full(_: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    write = Path.write_bytes

    def half(path: Path, content: bytes) -> int:
        write(path, content[:100])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", half)
    return "No space left"


def read_only(_: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    def refused(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(cache, "atomic_file", refused)
    return "Read-only file system"


@pytest.mark.parametrize("trouble", [no_folder, below_a_file, full, read_only])
def test_a_cache_that_cannot_be_written_is_done_without(scaled, folder, monkeypatch, caplog, trouble):
    words = trouble(folder, monkeypatch)
    with caplog.at_level(logging.WARNING):
        assert doubled(scaled())
        assert doubled(scaled())
        assert scaled(3.0).tolist() == [3.0, 6.0, 9.0]
    assert scaled.built == 3
    assert len(caplog.records) == 1
    assert words in caplog.text
    assert not folder.is_dir() or not list(folder.iterdir())


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="a folder that refuses everyone, even root")
def test_a_folder_that_refuses_everyone(scaled, monkeypatch, caplog):
    monkeypatch.setenv("FLEXAPOD_CACHE", "/proc/flexapod")
    assert doubled(scaled())
    assert "/proc/flexapod" in caplog.text


def test_a_folder_from_which_nothing_can_be_loaded(scaled, folder, monkeypatch, caplog):
    real = compiler.ctypes.CDLL

    def refuse(path: str):
        if Path(path).parent == folder:
            raise OSError("failed to map segment from shared object")  # a file system mounted noexec
        return real(path)

    monkeypatch.setattr(compiler.ctypes, "CDLL", refuse)
    assert doubled(scaled())
    assert doubled(scaled())
    assert scaled.built == 2
    assert len(caplog.records) == 1
    assert "cannot be loaded" in caplog.text


def test_a_library_that_another_process_removes_at_once(scaled, folder, monkeypatch, caplog):
    real = compiler.store_library

    def store(*arguments: object) -> Path:
        stored = real(*arguments)
        stored.unlink()
        return stored

    monkeypatch.setattr(compiler, "store_library", store)
    assert doubled(scaled())
    assert not caplog.records


def test_least_recently_used_go_first(scaled, folder, kernel, monkeypatch):
    size = kernel.stat().st_size
    names: dict[float, str] = {}
    for age, factor in ((300, 1.0), (200, 2.0), (100, 3.0)):
        before = set(folder.glob("*.so"))
        scaled(factor)
        (new,) = set(folder.glob("*.so")) - before
        os.utime(new, (time.time() - age,) * 2)
        names[factor] = new.name
    scaled(1.0)  # the oldest is used again
    monkeypatch.setenv("FLEXAPOD_CACHE_MEGABYTES", str(3.5 * size / 1e6))  # room for three: sizes differ by some bytes
    scaled(4.0)
    left = {path.name for path in libraries(folder)}
    assert {names[1.0], names[3.0]} < left
    assert names[2.0] not in left
    assert len(left) == 3
    monkeypatch.setenv("FLEXAPOD_CACHE_MEGABYTES", "1e-6")
    assert scaled(5.0).tolist() == [5.0, 10.0, 15.0]  # one larger than the bound is kept, alone
    assert len(libraries(folder)) == 1


@pytest.mark.parametrize("text", ["many", "0", "-1", "nan", "inf"])
def test_a_bound_that_is_none(scaled, monkeypatch, text):
    monkeypatch.setenv("FLEXAPOD_CACHE_MEGABYTES", text)
    with pytest.raises(InputError, match="FLEXAPOD_CACHE_MEGABYTES"):
        scaled()
    assert scaled.built == 0


def test_only_what_was_abandoned_long_ago_is_swept(scaled, folder):
    folder.mkdir(mode=0o700)
    old, young, foreign = folder / ".flexapod-a.so", folder / ".flexapod-b.so", folder / "thesis.so"
    for path in (old, young, foreign):
        path.write_text("x")
    os.utime(old, (0, 0))
    os.utime(foreign, (0, 0))
    scaled()
    ours = {path for path in folder.iterdir() if cache.LIBRARY.fullmatch(path.name) or cache.TEXT.fullmatch(path.name)}
    assert set(folder.iterdir()) - ours == {young, foreign}


@pytest.mark.parametrize("relative", [".", "cache"])
def test_a_relative_folder(scaled, tmp_path, monkeypatch, relative):
    # ctypes looks a bare file name up in the system's libraries.
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("FLEXAPOD_CACHE", relative)
    tmp_path.chmod(0o700)
    assert doubled(scaled())
    assert doubled(scaled())
    assert scaled.built == 1


def test_where_the_folder_is(monkeypatch, tmp_path):
    for name in ("FLEXAPOD_CACHE", "LOCALAPPDATA", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    assert cache.cache_directory() == tmp_path / ".cache" / "flexapod"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    assert cache.cache_directory() == tmp_path / ".cache" / "flexapod"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert cache.cache_directory() == tmp_path / "xdg" / "flexapod"
    monkeypatch.setenv("FLEXAPOD_CACHE", "~/kernels")
    assert cache.cache_directory() == tmp_path / "kernels"


def test_a_compiler_that_fails_says_why(folder, tmp_path):
    source = tmp_path / "wrong.c"
    source.write_text("no C at all")
    with pytest.raises(ComputationError, match=r"error.*FLEXAPOD_COMPILER=none"):
        written_library((source,), compiler.compiler())
    assert not list(folder.iterdir())
    with pytest.raises(ComputationError, match="no such program"):
        compiled_library([1.0], lambda: functions(1.0), [str(tmp_path / "nothing")])
    (tmp_path / "text").write_text("not a program")
    with pytest.raises(ComputationError, match=r"Permission denied|Exec format"):
        compiled_library([1.0], lambda: functions(1.0), [str(tmp_path / "text")])


def test_all_uses_of_a_robot_share_one_library(folder):
    study = preset("paper-robot")
    _at_rest.cache_clear()  # a robot that is known keeps the kernel that it had
    made = robot_system(study.robot, study.simulation, 0.0).kernel
    assert locked_poses(study.robot, study.simulation, home_pose(study.robot)).system.kernel is made


def test_a_text_is_made_once_and_again_where_it_is_damaged_or_others_may_write(folder):
    made = []

    def text() -> str:
        return cache.kept_text("what it is made from", lambda: made.append(0) or "a long text\nof two lines")

    folder.mkdir(mode=0o700, exist_ok=True)
    assert {text(), text()} == {"a long text\nof two lines"} and len(made) == 1
    (kept,) = folder.glob("*.kept")
    assert kept.stat().st_mode & 0o777 == 0o600
    kept.write_bytes(kept.read_bytes()[:-1])
    assert text().endswith("lines") and len(made) == 2
    folder.chmod(0o722)
    assert text().endswith("lines") and len(made) == 3
    folder.chmod(0o700)
    cache.clear_cache()
    assert not list(folder.glob("*.kept"))
