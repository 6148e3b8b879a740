"""`darkflat audit`: what was done, by whom."""

import typer

from service.cli.commands import audit_list, audit_verify

audit = typer.Typer(
    help="The log of what was done: each entry is bound to all before it.",
    no_args_is_help=True,
    rich_markup_mode=None,
)
audit.command("list")(audit_list.list_entries)
audit.command("verify")(audit_verify.verify)
