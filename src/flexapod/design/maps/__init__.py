"""Maps of what a robot can do over a line, slice or volume of poses."""

from flexapod.design.maps.maps import workspace_map

__all__ = ["workspace_map"]
