"""Results of all visitors together have a limit: the oldest go first, and what they took is free again."""

import gc
import tracemalloc
import weakref
from contextlib import ExitStack

import numpy as np
import pytest
from tests.helpers.guests import guest, said, until
from tests.helpers.short_runs import SHORT, study_text
from xarray import Dataset

from flexapod.app.browser import running
from flexapod.app.browser.running import ResultMemory

pytestmark = pytest.mark.web

FINE = (
    *SHORT,
    ("tolerance = 1e-4", 'tolerance = 1e-4\noutput_step = "0.1 ms"'),
    ("modes = 3 ", "# "),
    ('fidelity = "assumed-modes"', 'fidelity = "lumped"'),
)


class Somebody:
    """Who has a result, and drops it when told."""

    def __init__(self, room):
        self.room, self.data = room, None

    def compute(self, count):
        """A result of `count` numbers."""
        self.data = Dataset({"x": ("time", np.zeros(count))})
        self.room.take(self, self.data)

    def forget(self, data):
        """As of a session."""
        if self.data is data:
            self.data = None


def test_the_oldest_go_first_until_all_have_room():
    """Bytes counted by hand: 8 for each number."""
    told = []
    room = ResultMemory(8000, lambda: told.append(1))
    first, second, third, fourth = (Somebody(room) for _ in range(4))
    first.compute(400)
    second.compute(300)
    assert (room.size, told) == (8 * 700, [])
    third.compute(300)
    assert (room.size, len(told)) == (8 * 1000, 0)  # exactly as much as there may be
    fourth.compute(1)
    assert first.data is None and second.data is not None
    assert (room.size, len(told)) == (8 * 601, 1)
    second.compute(300)  # anew: it is the newest now, and counted once
    assert room.size == 8 * 601
    fourth.compute(500)
    assert third.data is None and second.data is not None
    assert room.size == 8 * 800
    second.data = None
    room.drop(second)
    assert room.size == 8 * 500
    first.compute(5000)  # of one alone, who has all there is
    assert fourth.data is None and first.data is not None and room.size == 8 * 5000


def test_what_nobody_holds_any_more_is_not_counted():
    room = ResultMemory(8000)
    one, other = Somebody(room), Somebody(room)
    one.compute(900)
    one.data = None
    gc.collect()
    other.compute(900)
    assert room.size == 8 * 900


def test_visitors_who_compute_and_stay_do_not_fill_the_memory(view, monkeypatch):
    """As many results as the limit holds stay; those before are gone, with all that was drawn of them."""
    with ExitStack() as guests:
        monkeypatch.setattr(running, "MOST_RESULTS", 1e12)
        server = view(study_text(*FINE))
        sessions = []

        def comes():
            guests.enter_context(guest(server))
            session = until(lambda: next((s for s in server.sessions if s not in sessions), None))
            until(lambda: session.data is not None and not session.busy)
            until(lambda: session.modes_panel._inside._modes is not None)
            sessions.append(session)
            return session

        with guest(server):  # all is loaded by the first
            until(lambda: server.sessions and server.sessions[0].data is not None and not server.sessions[0].busy)
        until(lambda: not server.sessions)
        tracemalloc.start()
        guests.callback(tracemalloc.stop)
        for _ in range(3):
            comes()
        size = sessions[0].data.nbytes
        held = [weakref.ref(session.data) for session in sessions]
        until(lambda: server._results.size == 3 * size)
        assert size > 3e6
        gc.collect()
        before = tracemalloc.get_traced_memory()[0]
        server._results.most = 2.5 * size
        last = comes()
        until(lambda: gc.collect() is not None and held[0]() is None and held[1]() is None)
        until(lambda: "was dropped" in said(sessions[0]) and "was dropped" in said(sessions[1]))
        assert [session.data is None for session in sessions] == [True, True, False, False]
        until(lambda: server._results.size == 2 * size)
        gc.collect()
        # One result came, two went: one less. A session has its scene and its page beside it, some 0.3 MB, which one
        # more of came; what was drawn of a result, its lines and charts, went with it.
        assert tracemalloc.get_traced_memory()[0] - before < -0.5 * size
        assert sessions[0].time_panel._data is None and sessions[0].scene.data is None
        sessions[0].simulate()
        until(lambda: sessions[0].data is not None)
        until(lambda: sessions[2].data is None)
        assert "was dropped" not in said(sessions[0])
        assert last.data is not None


@pytest.mark.parametrize("free", [1e12, 4e6])
def test_a_small_machine_keeps_less(free, monkeypatch):
    monkeypatch.setattr(running, "available_memory", lambda: free)
    assert ResultMemory().most == min(500e6, free / 4)
