"""Imports without searches for garbage, which would take a third of the time of a short process."""

from __future__ import annotations

import atexit
import gc
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

WINGS = frozenset(
    "analysis app commissioning common control design examples kinematics mechanics model output solve "
    "verification".split()
)
#: Packages that keep a name of their own beside the place where they stand: no remark.
SHOWN = {"flexapod.plot": "flexapod.output.figures", "flexapod.study": "flexapod.analysis"}

atexit.register(gc.freeze)  # the search as the interpreter ends would look at every module again


def load_module(name: str) -> ModuleType:
    """Import a module; what it makes goes to the oldest generation at once, as it stays for the life of the process."""
    if name in sys.modules:  # garbage that is there by now is to be found, and not to grow old with the modules
        return import_module(name)
    collecting = gc.isenabled()
    gc.disable()
    try:
        return import_module(name)
    finally:
        if not gc.get_freeze_count():
            gc.freeze()
            gc.unfreeze()  # into the oldest generation
        if collecting:
            gc.enable()


def lazy_names(
    package: str, *, hidden: Mapping[str, Sequence[str]] | None = None, former: Mapping[str, str] | None = None
) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """Make `__getattr__`, `__dir__` and `__all__` of a package from its stub `__init__.pyi`, where a name stands once.

    Lines of the stub are ``from MODULE import NAME as NAME``, and ``NAME = MODULE`` for a package of `SHOWN`.
    `hidden`: names that answer and are not listed, by the modules that they live in. `former`: see `lazy_attributes`.
    """
    module = sys.modules[package]
    homes: dict[str, str] = {}
    with open(f"{module.__path__[0]}/__init__.pyi", encoding="utf-8") as stub:
        for line in stub:
            match line.split():
                case ["from", home, "import", _, "as", name]:
                    homes[name] = home
                case [name, "=", _]:
                    homes[name] = package
    listed = sorted(homes, key=lambda name: (not name.isupper(), name))  # constants first
    homes |= {name: home for home, names in (hidden or {}).items() for name in names}
    found = lazy_attributes(package, homes, former)
    for name in listed:
        if homes[name] == f"{package}.{name}":  # a later import of the module would put it in the place of the function
            found(name)
    return found, lambda: sorted({name for name in vars(module) if name.startswith("__")} | {*listed}), listed


def lazy_attributes(
    package: str, homes: Mapping[str, str], former: Mapping[str, str] | None = None
) -> Callable[[str], object]:
    """Make the `__getattr__` of a module: its names, with the modules that they live in, load on first use.

    A name that lives in the module itself is a module inside it.
    `former`: names of the release before and the new ones; they answer with a remark.
    """

    def found(name: str) -> object:
        if former and name in former:
            import warnings

            warnings.warn(f"{package}.{name} is {package}.{former[name]} now", FutureWarning, stacklevel=2)
            return getattr(sys.modules[package], former[name])
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        inside = homes[name] == package
        value = load_module(f"{package}.{name}") if inside else getattr(load_module(homes[name]), name)
        setattr(sys.modules[package], name, value)
        return value

    return found


class LazyModule(ModuleType):
    """A module that is imported with the first name that is asked of it."""

    def __getattr__(self, name: str) -> Any:
        return getattr(sys.modules.get(self.__name__) or load_module(self.__name__), name)


class FormerPaths:
    """Finds modules of the package by the paths that they had one release ago: the same modules, with a remark.

    Of packages that are gone at the front of `sys.meta_path`, as a module that is found twice would be made twice, its
    classes with it; of packages that are still there at the end, where nothing else was found.
    """

    def __init__(self, *, gone: bool) -> None:
        self.gone = gone

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        """Spec of a module of the package under a former path; None of all others."""
        if not name.startswith("flexapod.") or (name.split(".", 2)[1] in WINGS) == self.gone:
            return None
        if (now := SHOWN.get(name)) is None:
            from flexapod.common.former_paths import new_path

            if (now := new_path(name)) is None or now == name:
                return None
            import warnings

            warnings.warn(f"{name} is {now} now", FutureWarning, stacklevel=2)
        return ModuleSpec(name, _Former(load_module(now)))  # type: ignore[arg-type]  # all that a loader needs


class _Former:
    """Gives a module that is there under another name, as it is."""

    def __init__(self, module: ModuleType) -> None:
        self._module, self._spec = module, module.__spec__

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Take the module itself."""
        return self._module

    def exec_module(self, module: ModuleType) -> None:
        """Leave the module as it says that it is."""
        module.__spec__ = self._spec


@contextmanager
def hide_package(name: str) -> Iterator[None]:
    """Let a package that is not needed seem absent, so that xarray does not import it to look for its types.

    Where xarray is there already it may have found the package, and would not look again.
    """
    absent = name not in sys.modules and "xarray" not in sys.modules
    if absent:
        sys.modules[name] = None  # type: ignore[assignment]  # imports of it then fail at once
    try:
        yield
    finally:
        if absent:
            del sys.modules[name]


sys.meta_path[:] = [FormerPaths(gone=True), *sys.meta_path, FormerPaths(gone=False)]
