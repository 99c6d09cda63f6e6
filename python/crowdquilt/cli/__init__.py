"""The command line.

Exit codes: 0 fine, 1 a check failed, 2 bad input, 3 a clean tiling that is short of a wish, 4 one with faults or loose
ends.
"""

from __future__ import annotations

import sys

from crowdquilt._core import CrowdquiltError
from crowdquilt.cli import captures, crowds, sets, showing, whole, world  # noqa: F401  (each adds its commands to the app)
from crowdquilt.cli.app import BAD_INPUT, app


def main() -> None:
    """Run the command line; bad input ends in one message, never in a traceback."""
    try:
        app(prog_name="crowdquilt")
    except CrowdquiltError as error:
        fail(str(error))
    except OSError as error:
        where = f"{error.filename}: " if error.filename is not None else ""
        fail(f"{where}{error.strerror or error}")


def fail(message: str) -> None:
    """Say what is wrong with the input, and end."""
    print(f"crowdquilt: {message}", file=sys.stderr)
    sys.exit(BAD_INPUT)
