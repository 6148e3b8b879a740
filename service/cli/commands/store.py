"""`darkflat store`: coefficient sets and their lives."""

import typer

from service.cli.commands import (
    store_add,
    store_add_recording,
    store_certify,
    store_check,
    store_list,
    store_lookup,
    store_revoke,
    store_show,
    store_verify,
)

store = typer.Typer(
    help="Coefficient sets (draft, verified, certified, superseded or revoked) and recordings.",
    no_args_is_help=True,
    rich_markup_mode=None,
)
store.command("add")(store_add.add)
store.command("add-recording")(store_add_recording.add_recording)
store.command("list")(store_list.list_sets)
store.command("show")(store_show.show)
store.command("verify")(store_verify.verify)
store.command("certify")(store_certify.certify)
store.command("revoke")(store_revoke.revoke)
store.command("lookup")(store_lookup.lookup)
store.command("check")(store_check.check)
