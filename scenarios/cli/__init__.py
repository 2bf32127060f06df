"""The command line ``formation``: parse, call, print, exit code; nothing else lives here.

One file a family of commands. Heavy packages are imported by the commands that use them.
"""

from scenarios.cli.exits import BAD_INPUT, DONE, INTERRUPTED, MISSED, TERMINATED
from scenarios.cli.main import cli, main

__all__ = ["BAD_INPUT", "DONE", "INTERRUPTED", "MISSED", "TERMINATED", "cli", "main"]
