"""The command ``formation``, also ``python -m scenarios``: listens to signals first, and loads everything else then."""

import sys

from scenarios.work import signals


def main() -> None:
    """Run the command line and exit with its code."""
    signals.end_at_once()
    try:
        from scenarios.cli import main as command_line

        signals.end_in_order()
        command_line()
    except KeyboardInterrupt:
        sys.exit(signals.INTERRUPTED)
    except signals.Terminated:
        sys.exit(signals.TERMINATED)
    finally:
        signals.end_at_once()


if __name__ == "__main__":
    main()
