"""Every public call with one odd argument after another: its own refusal, or an answer, and nothing else.

A progress that can be called is the user's own: its errors are his. Calls of many runs get odd subjects alone.
"""

import inspect
from types import ModuleType

import pytest
from tests.helpers.odd_calls import arguments, needed, odd_values, parameters, right

import flexapod as fx

pytestmark = pytest.mark.property

MANY_RUNS = ("converge", "ladder", "sweep", "workspace_map")
NOT_TRIED = ("replicate",)  # its arguments are a flag and functions; a run takes a minute
OWN = [(name, value) for name in ("progress",) for value in ("function", "class")]


def calls(group):
    """Public functions and classes of a package, those that are at home in another left out, by name."""
    module = fx if group == "fx" else getattr(fx, group)
    others = set() if group != "fx" else {*fx.study.__all__, *fx.model.__all__}
    for name in module.__all__:
        found = getattr(module, name)
        exception = inspect.isclass(found) and issubclass(found, BaseException)
        if callable(found) and not (exception or name in others or isinstance(found, ModuleType)):
            yield name, found


@pytest.mark.parametrize("group", ["plot", "control", "study", "fx", "model"])
@pytest.mark.filterwarnings("ignore")  # of numbers that are taken, however odd
def test_odd_arguments_are_refused_or_taken(group, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known, odd, foreign, count = right(), odd_values(), [], 0
    for name, call in calls(group):
        names = [] if name in NOT_TRIED else parameters(call)
        for parameter in names[:1] if name in MANY_RUNS else names:
            for what, value in odd.items():
                if (parameter, what) in OWN:
                    continue
                own = {need: known.get(need) for need in needed(call)} | {parameter: value}
                placed, named = arguments(call, own)
                count += 1
                try:
                    call(*placed, **named)
                except fx.FlexapodError:
                    pass
                except Exception as error:  # the very thing that is looked for
                    foreign.append(f"{group}.{name}({parameter}={what}): {type(error).__name__}: {error!s:.100}")
    assert count > 1000
    assert not foreign, "\n".join([f"{len(foreign)} of {count}", *foreign[:40]])


def test_by_leg_draws_what_varies_over_legs_and_time():
    from tests.helpers.runs import paper_robot

    data = fx.simulate(paper_robot(fidelity="rigid", step=1e-3), duration=0.005)
    assert len(fx.plot.by_leg(data, "leg_length").axes[0].lines) == 6
    with pytest.raises(fx.InputError, match="is no variable of time and legs") as error:
        fx.plot.by_leg(data, "leg_lenght")
    assert error.value.next_step == "Did you mean 'leg_length'?"


def test_values_that_cannot_be_written_are_told_by_their_kind():
    from tests.helpers.odd_calls import deep

    for value in (10**5000, deep()):
        error = fx.InputError("is odd", key="x", value=value)
        assert len(str(error)) < 200 and len(error.as_dict()["value"] or "") > 0
