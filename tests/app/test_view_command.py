"""`flexapod view` as a user types it: refusals in words, where it listens, results on disk, Ctrl-C."""

import json
import logging
import os
import signal
import socket
import subprocess
import sys
import urllib.request
from urllib.parse import urlsplit

import netCDF4
import pytest
from tests.helpers.guests import guest, until
from tests.helpers.short_runs import BRIEF
from tests.helpers.started import heed_interrupts

import flexapod as fx
from flexapod.analysis import save
from flexapod.analysis.results.attributes import TABLES
from flexapod.app.browser import network
from flexapod.app.browser.background import CONNECTIONS
from flexapod.app.browser.header import open_source
from flexapod.app.browser.network import address, free_port, is_local
from flexapod.common.errors import InputError

pytestmark = pytest.mark.cli


def refused(result) -> str:
    assert result.exit_code == 2 and result.stdout == ""
    return result.stderr


def test_bad_files_are_refused_before_a_server_starts(flexapod, study, folder):
    assert "cannot be read" in refused(flexapod("view", "nowhere.toml"))
    assert "payload.mass = -100 kg" in refused(flexapod("view", study(("100 kg", "-100 kg"))))
    (folder / "a.nc").write_bytes(b"no results")
    assert "is not a readable NetCDF file" in refused(flexapod("view", "a.nc"))
    with netCDF4.Dataset(folder / "zeros.nc", "w") as file:
        file.createDimension("time", 2_000_000_000)
        file.createVariable("time", "f8", ("time",), zlib=True)
    assert "unpacks to 16 GB" in refused(flexapod("view", "zeros.nc"))
    (data := fx.run(fx.load(study(*BRIEF)))).attrs.pop("study")
    save(data, folder / "torn.nc")
    assert "study: is missing" in refused(flexapod("view", "torn.nc"))
    save(fx.modes(fx.preset("paper-robot")), folder / "modes.nc")
    assert "is not a result of a simulation" in refused(flexapod("view", "modes.nc"))


@pytest.mark.parametrize("package", ["msgspec", "viser", "websockets"])
def test_a_missing_package_is_named_with_the_line_that_installs_it(flexapod, study, monkeypatch, package):
    file = study()
    monkeypatch.setitem(sys.modules, package, None)
    said = " ".join(refused(flexapod("view", file)).split())
    assert package in said and 'pip install "flexapod[page]"' in said


@pytest.mark.parametrize("command", ["check", "keys"])
def test_other_commands_do_without_the_page_and_the_engines(study, command):
    """In a process of its own, where none of their packages can be imported."""
    absent = ("msgspec", "viser", "websockets", "exudyn", "mujoco")
    code = f"import sys; sys.modules.update(dict.fromkeys({absent})); from flexapod.app.cli.cli import main; main()"
    words = [command, str(study())] if command == "check" else [command, "leg"]
    run = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_places_to_listen(flexapod, study):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert f"--port = {port}" in refused(flexapod("view", study(), "--port", port))
    assert "--host = 203.0.113.7" in refused(flexapod("view", study(), "--host", "203.0.113.7"))
    assert "is not a name or address" in refused(flexapod("view", study(), "--host", "no.such.host.invalid"))


@pytest.mark.parametrize(
    ("host", "local", "page"),
    [
        ("127.0.0.1", True, "http://127.0.0.1:8080"),
        ("localhost", True, "http://localhost:8080"),
        ("::1", True, "http://[::1]:8080"),
        ("0.0.0.0", False, "http://localhost:8080"),
        ("192.168.0.7", False, "http://192.168.0.7:8080"),
    ],
)
def test_who_reaches_a_host(host, local, page):
    assert is_local(host) is local
    assert address(host, 8080) == page


def test_the_next_port_is_taken_where_one_is_in_use(monkeypatch):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        first = taken.getsockname()[1]
        with pytest.raises(InputError, match="cannot be listened on"):
            free_port("127.0.0.1", first)
        monkeypatch.setattr(network, "FIRST", first)
        assert first < free_port("127.0.0.1", None) < first + network.TRIES


def buffered():
    """Python as it is by itself: what it prints waits in a pipe until it is flushed."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}


@pytest.mark.parametrize(("options", "words"), [([], b""), (["--host", "0.0.0.0"], b"everyone on the network")])
def test_serves_until_ctrl_c(study, folder, options, words):
    """The page is served where the command says; --host says who gets in; Ctrl-C ends it with exit code 0."""
    command = [sys.executable, "-m", "flexapod", "view", str(study(*BRIEF)), "--no-browser", "--port", "0"]
    running = subprocess.Popen(
        [*command, *options], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=heed_interrupts,
        env=buffered(), bufsize=0,  # the second line is for communicate()
    )  # fmt: skip
    assert running.stdout is not None
    try:
        said = running.stdout.readline()
        page = said.decode().split("http://")[1].split()[0]
        with urllib.request.urlopen(f"http://{page}", timeout=300) as answer:
            assert b"<html" in answer.read()
        running.send_signal(signal.SIGINT)
        rest, wrong = running.communicate(timeout=300)
    finally:
        running.kill()
    assert running.returncode == 0
    assert words in rest and (words or not rest)
    assert wrong == b""


@pytest.mark.skipif(sys.platform == "win32", reason="no such signals")
@pytest.mark.parametrize("kinds", [["SIGINT"], ["SIGTERM"], ["SIGHUP"], ["SIGHUP", "SIGTERM"]])
def test_however_it_is_ended_nothing_that_was_sent_stays(study, folder, kinds):
    """Ended by the system, or by the terminal that goes, the tables of those who were there stayed behind."""
    (sent := folder / "tmp").mkdir()
    command = [
        sys.executable,
        "-m",
        "flexapod",
        "view",
        str(study(*BRIEF)),
        "--no-browser",
        "--port",
        "0",
        "--json",
    ]
    running = subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=heed_interrupts,
        env=buffered() | {"TMPDIR": str(sent)},
    )  # fmt: skip
    try:
        lines = b""
        while b"}" not in lines:
            lines += (line := running.stdout.readline())
            assert line, "it ended"
        with guest(urlsplit(json.loads(lines)["address"])):  # reads on: who does not is waited for when the server ends
            # the folder for what is sent: that of a compiler is not empty
            place = until(lambda: [x for x in sent.glob("flexapod-*") if not any(x.iterdir())])[0]
            (place / "path.csv").write_text("time [s], roll [deg]")
            for kind in kinds:
                running.send_signal(getattr(signal, kind))
            assert running.wait(timeout=300) == 0
            _, wrong = running.communicate()
    finally:
        running.kill()
    assert [*sent.iterdir()] == []
    assert wrong.decode() == ""


def test_address_as_json(study, folder):
    command = [
        sys.executable,
        "-m",
        "flexapod",
        "view",
        str(study(*BRIEF)),
        "--no-browser",
        "--port",
        "0",
        "--json",
    ]
    running = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, preexec_fn=heed_interrupts, env=buffered())
    assert running.stdout is not None
    try:
        lines = b""
        while b"}" not in lines:
            lines += (line := running.stdout.readline())
            assert line, "it ended"
        assert json.loads(lines)["local"] is True
        running.send_signal(signal.SIGINT)
        running.wait(timeout=300)
    finally:
        running.kill()
        running.stdout.close()


def test_results_open_with_their_study(study, folder):
    data = fx.run(fx.load(study(*BRIEF)))
    path = save(data, folder / "results.nc")
    (folder / "study.toml").unlink()
    source = open_source(path)
    assert source.study.source_text == data.attrs["study"]
    assert source.data.com_deviation.equals(data.com_deviation)


def test_results_open_without_the_tables_of_their_study(folder):
    """Results that came by mail: the table of the motion stayed where it was."""
    (folder / "path.csv").write_text("time [s], heave [mm]\n0, 0\n0.1, 2\n0.2, 3\n")
    motion = fx.preset("paper-robot").source_text.split("[motion]")
    text = motion[0] + '[motion]\ntype = "csv"\nfile = "path.csv"\n[simulation]\nfidelity = "lumped"\n'
    (folder / "study.toml").write_text(text)
    data = fx.run(fx.load("study.toml"))
    path = save(data, folder / "results.nc")
    (folder / "path.csv").unlink()
    study = open_source(path).study
    assert study.motion.time.tolist() == [0.0, 0.1, 0.2]  # the table itself, which the results hold
    assert not study.warnings
    former = data.copy()  # of a release whose results held none
    del former.attrs[TABLES]
    study = open_source(save(former, folder / "former.nc")).study
    assert study.robot == fx.preset("paper-robot").robot
    assert study.motion.pose[-1, 2] == pytest.approx(0.003, abs=1e-12)
    assert "tables" in study.warnings[-1]


def test_who_comes_and_goes_is_not_told_in_the_terminal():
    """The library of the connections says so at the level at which the command tells of long compilations."""
    logging.getLogger("flexapod").setLevel(logging.INFO)
    try:
        assert not CONNECTIONS.isEnabledFor(logging.INFO) and CONNECTIONS.isEnabledFor(logging.WARNING)
    finally:
        logging.getLogger("flexapod").setLevel(logging.NOTSET)
