"""`darkflat key`: who may ask the service for what."""

import typer

from service.cli.commands import key_create, key_list, key_revoke

key = typer.Typer(
    help="Keys of the service. From the first one on it answers nothing without a key.",
    no_args_is_help=True,
    rich_markup_mode=None,
)
key.command("create")(key_create.create)
key.command("list")(key_list.list_keys)
key.command("revoke")(key_revoke.revoke)
