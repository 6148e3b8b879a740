"""Headers of a request, as ASGI brings them."""

from starlette.types import Scope


def header(scope: Scope, name: bytes) -> str:
    """Return the header `name`, in lower case as given here; empty where there is none."""
    found: bytes = next((value for key, value in scope.get("headers", ()) if key == name), b"")
    return found.decode("latin-1")


def host_of(scope: Scope) -> str:
    """Return the name in the `Host` header without its port, in lower case."""
    text = header(scope, b"host").lower()
    name, colon, port = text.rpartition(":")
    return name if colon and port.isdecimal() else text
