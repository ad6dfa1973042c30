"""Headers that every answer of the page's server carries."""

from __future__ import annotations

import re
from collections.abc import Sequence

__all__ = ["security_headers"]

_PAGE = {
    "default-src": "'none'",
    "script-src": "'unsafe-inline' 'unsafe-eval'",  # viser's page is one file that unpacks and compiles its own program
    "style-src": "'unsafe-inline'",
    "img-src": "'self' data: blob:",
    "font-src": "data:",
    "worker-src": "blob: data:",
    "connect-src": "'self' data: blob:",
    "base-uri": "'none'",
    "form-action": "'none'",
    "frame-ancestors": "'none'",
}
_FEATURES = ("camera", "microphone", "geolocation", "usb", "serial", "midi", "payment", "display-capture")
_PLAIN = re.compile(r"[a-z0-9.:\[\]-]+", re.IGNORECASE)


def security_headers(asked: Sequence[str]) -> dict[str, str]:
    """What the page may load, who may embed it, and what a browser tells others of it.

    Parameters
    ----------
    asked : sequence of str
        Lines ``Host`` of the request: browsers that do not count websockets as 'self' are told the address.
    """
    policy = dict(_PAGE)
    if len(asked) == 1 and _PLAIN.fullmatch(asked[0]):
        policy["connect-src"] += f" ws://{asked[0]} wss://{asked[0]}"
    return {
        "Content-Security-Policy": "; ".join(f"{name} {value}" for name, value in policy.items()),
        "Cross-Origin-Resource-Policy": "same-origin",
        "Permissions-Policy": ", ".join(f"{feature}=()" for feature in _FEATURES),
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "X-Frame-Options": "DENY",
    }
