"""A first robot from a few numbers: parts that fit each other, as a commented study file."""

from flexapod.design.first_robot.attainable import Attained, attainable
from flexapod.design.first_robot.design import first_robot
from flexapod.design.first_robot.sizing import IDEAL, Request, parse_request

__all__ = ["IDEAL", "Attained", "Request", "attainable", "first_robot", "parse_request"]
