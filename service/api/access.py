"""Who asks, and whether they may: bearer keys with scopes.

Without any key on record only this machine is served, and everybody on it may do everything: that
is how a bench begins. From the first key on nothing is answered without one.
"""

import asyncio
import ipaddress
from collections.abc import Callable, Coroutine
from functools import cache
from typing import Annotated, Any

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer

from calib.errors import DarkflatError
from service.api.dependencies import Parts, PartsDep
from service.store.actor import Actor
from service.store.keys import KeyRecord, Scope

LOCAL = Actor("local")
"""Whoever asks on this machine while there are no keys."""

_bearer = HTTPBearer(auto_error=False, description="A key made by `darkflat key create`.")


class AccessError(DarkflatError):
    """The key is missing, not good, or does not allow it: `key-needed`, `key-refused`, `scope`."""


@cache  # the same one for the same scope: a request is checked once, however often it is named
def needs(scope: Scope) -> Callable[..., Coroutine[Any, Any, Actor]]:
    """Return the dependency that gives who asks, where they hold `scope`."""

    async def check(
        request: Request,
        given: Annotated[HTTPAuthorizationCredentials | None, Depends(_bearer)],
        known: PartsDep,
    ) -> Actor:
        address = request.client.host if request.client else ""
        key = None if given is None else given.credentials
        return await who_asks(known, address, key, scope)

    return check


async def who_asks(known: Parts, address: str, key: str | None, scope: Scope) -> Actor:
    """Return who asks from `address` with `key`; AccessError where they do not hold `scope`."""
    if key is None:
        return await _without_key(known, address)
    await asyncio.sleep(known.failures.wait_s(address))
    record = await known.keys.known(key)
    if record is None:
        known.failures.count(address)
        msg = "this key is not known, is over, or was revoked; ask for another one"
        raise AccessError(msg, code="key-refused")
    known.failures.forget(address)
    return _allowed(record, scope)


async def _without_key(known: Parts, address: str) -> Actor:
    if await known.keys.any():
        msg = "a key is needed: send `Authorization: Bearer KEY`"
        raise AccessError(msg, code="key-needed")
    if not _is_this_machine(address):
        msg = "there are no keys yet, so only this machine is served; make one: darkflat key create"
        raise AccessError(msg, code="key-needed")
    return LOCAL


def _allowed(key: KeyRecord, scope: Scope) -> Actor:
    if not key.scope.includes(scope):
        msg = f"this needs the scope {scope}, and the key {key.name!r} has {key.scope}"
        raise AccessError(msg, code="scope-missing")
    return Actor(key.name, key.id)


def _is_this_machine(address: str) -> bool:
    try:
        return ipaddress.ip_address(address).is_loopback
    except ValueError:
        return address == "testclient"


Reader = Annotated[Actor, Depends(needs(Scope.READ))]
Operator = Annotated[Actor, Depends(needs(Scope.OPERATE))]
Certifier = Annotated[Actor, Depends(needs(Scope.CERTIFY))]
Admin = Annotated[Actor, Depends(needs(Scope.ADMIN))]
