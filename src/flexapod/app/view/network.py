"""Where a server may listen, and who reaches it there."""

from __future__ import annotations

import ipaddress
import socket
from functools import cache

from flexapod.errors import InputError

__all__ = ["address", "free_port", "is_expected", "is_local"]

FIRST, TRIES = 8080, 100


def free_port(host: str, port: int | None) -> int:
    """The port to listen on: `port`, or the first free one from 8080 on; 0 is any.

    Raises
    ------
    InputError
        The port is taken, or the host is none of this machine.
    """
    problem = ""
    for number in [port] if port is not None else range(FIRST, FIRST + TRIES):
        try:
            family = socket.getaddrinfo(host, number, type=socket.SOCK_STREAM)[0][0]
            with socket.socket(family, socket.SOCK_STREAM) as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind((host, number))
                return int(probe.getsockname()[1])
        except (socket.gaierror, UnicodeError):
            raise InputError("is no name or address of this machine", key="--host", value=host) from None
        except OSError as error:
            problem = error.strerror or str(error)
    key, value = ("--host", host) if port is None else ("--port", str(port))
    raise InputError(f"cannot be listened on: {problem}", key=key, value=value, next_step="Choose another one")


def is_local(host: str) -> bool:
    """Whether only programs on this machine reach a host."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def is_expected(asked: str, host: str) -> bool:
    """Whether the page was asked for under an address or a name of this machine, which listens on `host`.

    A page of another site may have its own name point here (DNS rebinding) and would then count as this site: names
    that are not this machine's are refused, unless `host` is that name.

    Parameters
    ----------
    asked : str
        The header ``Host``: name and port.
    host : str
        As `free_port`.
    """
    name = (asked.rpartition("]")[0].lstrip("[") or asked.partition(":")[0]).lower().rstrip(".")
    if is_local(host):
        return is_local(name)
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return name in ("localhost", host.lower()) or name in _own_names()
    return True


@cache
def _own_names() -> tuple[str, ...]:
    own = socket.gethostname().lower()
    return own, f"{own}.local", socket.getfqdn().lower()


def address(host: str, port: int) -> str:
    """What to type into the browser on this machine."""
    shown = "localhost" if host in ("0.0.0.0", "::") else host
    return f"http://{f'[{shown}]' if ':' in shown else shown}:{port}"
