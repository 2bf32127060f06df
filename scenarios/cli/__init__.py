"""The command line ``formation``: parse, call, print, exit code; nothing else lives here."""

from scenarios.cli.commands import BAD_INPUT, DONE, MISSED, cli, main

__all__ = ["BAD_INPUT", "DONE", "MISSED", "cli", "main"]
