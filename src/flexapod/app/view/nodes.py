"""The nodes of a scene by name: what another study does not have goes, what it has is replaced without flicker."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import viser

__all__ = ["Nodes"]


class Nodes:
    """A scene that remembers the names of what is added to it by ``add_...``."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._scene, self._names = scene, set[str]()

    def __getattr__(self, method: str) -> Any:
        def add(name: str, *args: Any, **more: Any) -> Any:
            self._names.add(name)
            return getattr(self._scene, method)(name, *args, **more)

        return add

    def replaces(self, before: frozenset[str]) -> frozenset[str]:
        """Remove those of `before` that were not added again; the names of now."""
        for name in before - self._names:
            handle = self._scene.get_handle_by_name(name)
            if handle is not None:  # it may have gone with its parent
                handle.remove()
        return frozenset(self._names)
