import os

# Every process of the tests has a core; more threads than cores only wait for each other.
os.environ.setdefault("OMP_NUM_THREADS", "1")

from hypothesis import settings

# Deadlines measure the machine, not the code; the same examples on every run make failures repeat.
settings.register_profile("garmentimage", deadline=None, derandomize=True)
settings.load_profile("garmentimage")
