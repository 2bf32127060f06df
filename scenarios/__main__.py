"""The command ``formation``, also ``python -m scenarios``: listens to signals first, and loads everything else then."""

import sys

from scenarios.work import signals


def main() -> None:
    """Run the command line and exit with its code."""
    signals.end_at_once()
    code: str | int | None = 0
    try:
        from scenarios.cli import main as command_line

        signals.end_in_order()
        command_line()
    except SystemExit as end:
        code = end.code
    except (KeyboardInterrupt, signals.Terminated):
        code = signals.INTERRUPTED
    finally:
        signals.end_at_once()
    asked = signals.exit_code()
    sys.exit(code if asked is None else asked)


if __name__ == "__main__":
    main()
