"""`darkflat`: all its commands, each in a file of its own."""

import sys

import typer

from calib.errors import DarkflatError
from service.cli.answering import FAILED, standard_output
from service.cli.commands.apply import apply
from service.cli.commands.audit import audit
from service.cli.commands.calibrate import calibrate
from service.cli.commands.demo import demo
from service.cli.commands.diagnose import diagnose
from service.cli.commands.doctor import doctor
from service.cli.commands.export import export
from service.cli.commands.import_folder import import_folder
from service.cli.commands.investigate import investigate
from service.cli.commands.key import key
from service.cli.commands.mtf import mtf
from service.cli.commands.photon_transfer import photon_transfer
from service.cli.commands.serve import serve
from service.cli.commands.simulate import simulate
from service.cli.commands.spectral_response import spectral_response
from service.cli.commands.store import store
from service.cli.commands.sweep import sweep

app = typer.Typer(
    name="darkflat",
    help="From a camera, a light source and a stack of frames to radiance one can trust.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command("demo")(demo)
app.command("serve")(serve)
app.command("doctor")(doctor)
app.command("sweep")(sweep)
app.command("import")(import_folder)
app.command("export")(export)
app.command("calibrate")(calibrate)
app.command("apply")(apply)
app.command("photon-transfer")(photon_transfer)
app.command("spectral-response")(spectral_response)
app.command("mtf")(mtf)
app.command("diagnose")(diagnose)
app.command("investigate")(investigate)
app.command("simulate")(simulate)
app.add_typer(store, name="store")
app.add_typer(key, name="key")
app.add_typer(audit, name="audit")


def main() -> None:
    """Run `darkflat`."""
    try:
        with standard_output():  # of `--help`; commands see to their own
            app()
    except DarkflatError as error:
        print(f"darkflat: {error}", file=sys.stderr)  # noqa: T201
        sys.exit(FAILED)
