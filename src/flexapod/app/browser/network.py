"""Addresses of the page's server: where it may listen, and which clients it admits there."""

from __future__ import annotations

import ipaddress
import socket
from functools import cache

from flexapod.common.errors import InputError

FIRST, TRIES = 8080, 100


def free_port(host: str, port: int | None) -> int:
    """The port to listen on: `port`, or the first free one from 8080 on; 0 is any.

    InputError: the port is taken, or the host is none of this machine.
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
            raise InputError("is not a name or address of this machine", key="--host", value=host) from None
        except OSError as error:
            problem = error.strerror or str(error)
    key, value = ("--host", host) if port is None else ("--port", str(port))
    raise InputError(f"cannot be listened on: {problem}", key=key, value=value, next_step="Choose another one")


def is_local(host: str) -> bool:
    """Test whether only programs on this machine reach a host."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def is_expected(asked: str, host: str, name: str | None = None) -> bool:
    """Test whether the page was requested under an address or a name of this machine, which listens on `host`.

    A page of another site may have its own name point here (DNS rebinding) and would then count as this site: names
    that are not this machine's are refused, unless `host` or `name` is that name. `asked`: the header ``Host``, name
    and port; `name`: another one under which the page is reached, as through a proxy.
    """
    known = _parts(asked)[0].rstrip(".")
    if name is not None and known == name.lower().rstrip("."):
        return True
    if is_local(host):
        return is_local(known)
    try:
        ipaddress.ip_address(known)
    except ValueError:
        return known in ("localhost", host.lower()) or known in _own_names()
    return True


def is_same_site(origin: str, asked: str) -> bool:
    """Test whether the header ``Origin`` names the site that the header ``Host`` asks for.

    The scheme may be https: a proxy before this server may speak TLS. A port that is not given is the scheme's own.
    """
    scheme, _, place = origin.lower().partition("://")
    own = {"http": "80", "https": "443"}.get(scheme)
    if own is None:
        return False
    (there, port), (here, asked_port) = _parts(place), _parts(asked)
    return there == here and (port or own) == (asked_port or own)


def client_key(peer: str, forwarded: str | None = None) -> str:
    """Client of a connection, for limits: the address that it came from, of IPv6 the network of a customer (/64).

    `forwarded`: the header ``X-Forwarded-For`` where a proxy is known to stand before this server: its last entry is
    the one that the proxy wrote, about a connection from this machine.
    """
    found = _address(peer)
    if forwarded is not None and found is not None and found.is_loopback:
        found = _address(forwarded.rpartition(",")[2].strip()) or found
    if isinstance(found, ipaddress.IPv6Address):
        return str(ipaddress.ip_network((found, 64), strict=False))
    return peer if found is None else str(found)


def _address(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """An address, with or without a zone (``%eth0``); one of IPv4 that is written as IPv6 is one of IPv4."""
    try:
        found = ipaddress.ip_address(text.partition("%")[0])
    except ValueError:
        return None
    return (found.ipv4_mapped if isinstance(found, ipaddress.IPv6Address) else None) or found


def admits_client(own: int, there: int, most: int) -> bool:
    """Test whether a client with `own` of `there` connections may open one more, where `most` are allowed.

    Nobody gets more than are still free: each who takes all leaves half of what was there to the next.
    """
    return own < most - there


def names_in_words(host: str, name: str | None) -> str:
    """Names under which the page is served, as text."""
    listed = ["127.0.0.1", "localhost"] if is_local(host) else ["its address", "localhost", "the name of this machine"]
    return ", ".join(listed + ([name] if name else [])) + " (flexapod view --name NAME adds one)"


def _parts(asked: str) -> tuple[str, str]:
    """Name, in lower case, and port of ``name:port``, ``[::1]:port``; the port is "" where there is none."""
    bracketed, found, rest = asked.lower().rpartition("]")
    name, _, port = (bracketed.lstrip("["), "", rest.lstrip(":")) if found else asked.lower().partition(":")
    return name, port


@cache
def _own_names() -> tuple[str, ...]:
    own = socket.gethostname().lower()
    return own, f"{own}.local", socket.getfqdn().lower()


def address(host: str, port: int) -> str:
    """Address of the page for a browser on this machine."""
    shown = "localhost" if host in ("0.0.0.0", "::") else host
    return f"http://{f'[{shown}]' if ':' in shown else shown}:{port}"
