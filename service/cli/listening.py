"""One server in one process, until somebody stops it."""

import ipaddress
import socket

import uvicorn
from fastapi import FastAPI

from calib.errors import InputError
from service.cli.stopping import StoppedError
from service.watching.log import LogForm, Subject, log_config


def listen(host: str, port: int, *, has_keys: bool = False) -> socket.socket:
    """Return a listening socket.

    Args:
        host: Address or name; one that others reach only where `has_keys`.
        port: 0 for any that is free.
        has_keys: Whether a key was ever made: from then on nothing is answered without one.

    Raises:
        InputError: `keys-needed` where others than this machine could reach it, `port-in-use`.
    """
    if not has_keys and not is_loopback(host):
        msg = (
            f"{host} can be reached from outside, and there are no keys yet that keep others out:"
            " make one with darkflat key create, or serve on 127.0.0.1"
        )
        raise InputError(msg, code="keys-needed")
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family)
    except OSError as error:
        msg = f"port {port} on {host} cannot be used ({error.strerror}); give another --port"
        raise InputError(msg, code="port-in-use") from error


def is_loopback(host: str) -> bool:
    """Tell whether only this machine reaches `host`."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def serve_until_stopped(app: FastAPI, listening: socket.socket, log: LogForm = "text") -> None:
    """Serve `app`; a signal ends it after the answers that are under way."""
    config = uvicorn.Config(
        app,
        log_config=log_config(log, Subject()),
        access_log=False,
        timeout_graceful_shutdown=5,
    )
    try:
        uvicorn.Server(config).run(sockets=[listening])
    except (StoppedError, KeyboardInterrupt):
        return  # uvicorn has closed everything and passes the signal on: a good end
