"""Who computes when: short simulations before long ones, long ones in turns, nobody starved."""

import os
import threading
import time
from collections import Counter
from contextlib import ExitStack

import pytest
from tests.helpers.guests import guest, said, until
from tests.helpers.short_runs import LONG, SHORT, study_text

import flexapod as fx
from flexapod.app.browser import running
from flexapod.app.browser.document import Document
from flexapod.app.browser.header import StudySource
from flexapod.app.browser.running import CorePool, CoreUsage

pytestmark = pytest.mark.web


def test_long_simulations_take_turns_and_short_ones_pass(monkeypatch):
    """Six long ones that never end of themselves, on one place; now and then somebody wants a moment of it."""
    monkeypatch.setattr(running, "SLICE", 0.02)
    monkeypatch.setattr(running, "LONG", 0.2)
    places, stop, had, turns, waited = CorePool(1), threading.Event(), Counter(), [], []

    def long(number):
        turn = CoreUsage()
        assert places.acquire(turn, lambda: False, lambda: None)
        while not stop.is_set():
            time.sleep(0.002)
            had[number] += 1
            if places.should_yield(turn):
                places.release(turn)
                assert places.acquire(turn, lambda: False, lambda: None)
                turns.append(number)
        places.release(turn)

    threads = [threading.Thread(target=long, args=(i,)) for i in range(6)]
    for thread in threads:
        thread.start()
    until(lambda: len(had) == 6)
    for _ in range(40):
        turn, before = CoreUsage(), len(turns)
        assert places.acquire(turn, lambda: False, lambda: None)
        waited.append(len(turns) - before)
        places.release(turn)
        time.sleep(0.02)
    before = dict(had)
    until(lambda: all(had[i] > before[i] for i in range(6)))  # and nobody starves
    stop.set()
    for thread in threads:
        thread.join(300)
    # Turns of others meanwhile, whatever the machine makes of their 0.02 s: of each one at most.
    assert sorted(waited)[20] <= 6
    assert places._free == 1 and not places._queue


def test_short_simulations_without_end_do_not_starve_a_long_one(monkeypatch):
    monkeypatch.setattr(running, "LONG", 0.2)
    places, stop, turn = CorePool(1), threading.Event(), CoreUsage(used=100.0)

    def short():
        while not stop.is_set():
            mine = CoreUsage()
            if places.acquire(mine, stop.is_set, lambda: None):
                time.sleep(0.01)
                places.release(mine)

    threads = [threading.Thread(target=short) for _ in range(3)]
    for thread in threads:
        thread.start()
    try:
        assert places.acquire(turn, lambda: False, lambda: None)
        places.release(turn)
    finally:
        stop.set()
        places.wake()
    for thread in threads:
        thread.join(300)


def test_six_long_studies_do_not_keep_a_seventh_user_waiting(view):
    """All were served in order: whoever came after as many long studies as there are cores waited for minutes."""
    server = view(study_text(*LONG))
    with ExitStack() as open_pages:
        for i in range(6):
            open_pages.enter_context(guest(server))
            until(lambda count=i + 1: len(server.sessions) == count and all(s.busy for s in server.sessions))
        six = server.sessions
        server._source = StudySource(document=Document(study_text(*SHORT), None), study=fx.loads(study_text(*SHORT)))
        open_pages.enter_context(guest(server))
        seventh = until(lambda: [s for s in server.sessions if s not in six])[0]
        until(lambda: seventh.data is not None)
        seventh.study_panel._changed("payload.mass", "90 kg")
        until(lambda: seventh.data is not None and "Preview" in said(seventh))
        assert all(s.busy for s in six)
        until(lambda: all(s.header._progress.value > 0 for s in six))  # they go on, all of them
        six[0].cancel()
        assert not six[0].busy
    until(lambda: not server.sessions and server._cores._free == len(os.sched_getaffinity(0)))
