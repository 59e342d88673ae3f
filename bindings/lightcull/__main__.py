"""python -m lightcull."""

import sys

from .cli import main

if __name__ == "__main__":  # workers of a cluster import it
    sys.exit(main())
