from hypothesis import settings

# Deadlines measure the machine, not the code; the same examples on every run make failures repeat.
settings.register_profile("garmentimage", deadline=None, derandomize=True)
settings.load_profile("garmentimage")
