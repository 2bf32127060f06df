"""``python -m scenarios`` is the command ``formation``."""

from scenarios.cli import main

if __name__ == "__main__":
    main()
