"""`python -m garmentimage` is the command `garmentimage`."""

import sys

from garmentimage.cli import main

if __name__ == "__main__":
    sys.exit(main())
