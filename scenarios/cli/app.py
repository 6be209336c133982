"""The command line: every command, in the order of the help text."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from scenarios.cli.bench import bench
from scenarios.cli.effects import causes, check_effect, new_effect
from scenarios.cli.guide import guide
from scenarios.cli.lab import lab
from scenarios.cli.logs import doctor, import_log
from scenarios.cli.simulation import hardware, paper, simulate, spinning
from scenarios.cli.studies import design, fleet, generate, recover
from scenarios.cli.sweeps import compensate, diagnose, explain, export, monitor
from scenarios.cli.verbosity import with_verbosity


class Command(TyperCommand):
    """A command that refuses an empty value, as the name of a file it would mean the working folder, and a second one.

    Of two values for what takes one the last would count, whichever was meant.
    """

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """See click. Raises UsageError."""
        given, _, order = self.make_parser(ctx).parse_args(args=list(args))
        for param in self.get_params(ctx):
            asked: Any = param
            if order.count(asked) > 1 and not param.multiple:
                ctx.fail(f"{param.opts[-1]} is given more than once; give it once")
            values = given.get(str(param.name))
            empty = "" in (values if isinstance(values, list | tuple) else [values])
            if empty and param.default != "":
                raise typer.BadParameter("is empty; give a value", ctx=ctx, param=asked)
        return super().parse_args(ctx, args)


app = typer.Typer(
    name="halltwin",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
)


def _tell_version(asked: bool) -> None:
    if asked:
        from diagnosis.report.provenance import version

        print(f"halltwin {version()}")
        raise typer.Exit


@app.callback()
def halltwin(
    version: Annotated[
        bool, typer.Option("--version", callback=_tell_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """A digital twin of a Hall angle sensor that says what its own simulation gets wrong, and why.

    Exit code 0: answered. 1: answered, and what --fail-on names was found, or some of the files could not be used.
    2: the input cannot be used.
    """


for command in (
    explain,
    causes,
    simulate,
    diagnose,
    spinning,
    paper,
    compensate,
    export,
    monitor,
    fleet,
    hardware,
    bench,
    new_effect,
    check_effect,
    generate,
    design,
    recover,
    import_log,
    doctor,
    lab,
    guide,
):
    # Python keeps the word import for itself.
    app.command("import" if command is import_log else None, cls=Command)(with_verbosity(command))
