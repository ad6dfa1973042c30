"""Folder = wing of the package; the kind of proof is a marker of each file; `whole.toml` says which are whole, too."""

import os
from collections.abc import Iterator

import pytest
from tests.whole import mark_whole

pytest_plugins = ["tests.helpers.browser"]
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # small matrices: threads of BLAS only cost
KINDS = (
    "analytic", "cli", "consistency", "contract", "conservation", "convergence",
    "golden", "last_stage", "literature", "meta", "property", "unit", "web",
)  # fmt: skip
#: Kinds of which most kernels are called a few times. Not meant: files that are "optimised", groups that march long.
QUICK = ("analytic", "conservation", "consistency", "contract", "last_stage", "property", "unit", "web")


@pytest.fixture(scope="module", autouse=True)
def forgotten(request: pytest.FixtureRequest) -> Iterator[None]:
    """What a file of tests has cached for itself is not kept until all others have run."""
    yield
    for value in vars(request.module).values():
        if getattr(value, "__module__", None) == request.module.__name__ and hasattr(value, "cache_clear"):
            value.cache_clear()


@pytest.fixture(scope="module", autouse=True)
def quickly_compiled(request: pytest.FixtureRequest) -> Iterator[None]:
    """Kernels of kinds of tests that have one each: not optimised they have the same bits in a third of the time."""
    marked = request.node.get_closest_marker
    if not any(map(marked, QUICK)) or any(map(marked, ("optimised", "xdist_group"))):
        yield
        return
    from flexapod.solve.kernel import kernel

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("flexapod.mechanics.symbolic.compiler.FLAGS", ("-O0",))
        yield
    kernel.cache_clear()


@pytest.fixture
def uncompiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Kernels are interpreted: a few matrices of a robot that no other test has are no work for a compiler."""
    from tests.helpers.runs import uncompiled_kernel

    for place in ("robot_system", "time.actuator_march"):
        monkeypatch.setattr(f"flexapod.solve.{place}.kernel", uncompiled_kernel)


@pytest.hookimpl(tryfirst=True)  # cases are counted in the order in which they are collected
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if sum(item.get_closest_marker(kind) is not None for kind in KINDS) != 1:
            raise pytest.UsageError(f"{item.nodeid}: `pytestmark` says its kind of proof, one of {', '.join(KINDS)}")
    mark_whole(items)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> object:
    """With `--dist loadgroup`: files stay together, and what takes long comes first."""
    from tests.durations import LongestFirst

    return LongestFirst(config, log) if config.getvalue("dist") == "loadgroup" else None
