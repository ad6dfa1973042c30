"""A first robot from a few numbers: sizes that fit each other, as a commented study file."""

from flexapod.study.first.design import first_robot
from flexapod.study.first.sizes import Request, parse_request

__all__ = ["Request", "first_robot", "parse_request"]
