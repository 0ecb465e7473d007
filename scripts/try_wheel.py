"""Install the wheel into an empty environment and do the main job there, far from the checkout.

    python scripts/try_wheel.py dist

A pattern is drafted, encoded, decoded, compared and draped, and the bundled picture becomes a
pattern; all of it by the installed command, in a folder that holds nothing else.
"""

import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

CONSTRAINTS = Path(__file__).parents[1] / "constraints.txt"

STEPS = (
    "garmentimage --version",
    "garmentimage draft one-panel-dress -o dress.json",
    "garmentimage encode dress.json -o dress.npz",
    "garmentimage decode dress.npz -o again.json",
    "garmentimage check dress.json dress.npz again.json",
    "garmentimage roundtrip dress.json --workers 0 --report report.json",
    "garmentimage drape dress.json -o dress.glb --image dress.png",
    "garmentimage predict {picture} -o predicted",
)
MADE = ("dress.npz", "again.json", "dress.glb", "dress.png", "predicted/worn.json")
WHERE = """
import garmentimage.examples
print(garmentimage.examples.example_picture())
"""


def main(folder: Path) -> int:
    """Try the only wheel in `folder`; 1 where a step fails."""
    (wheel,) = folder.resolve().glob("*.whl")
    with tempfile.TemporaryDirectory() as scratch:
        place = Path(scratch)
        venv.create(place / "env", with_pip=True)
        scripts = place / "env" / ("Scripts" if os.name == "nt" else "bin")
        python = scripts / "python"
        install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run([python, *install, "-c", CONSTRAINTS, wheel], check=True)
        work = place / "work"
        work.mkdir()
        clean = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
        found = subprocess.run(
            [python, "-c", WHERE], cwd=work, env=clean, check=True, capture_output=True, text=True
        )
        picture = found.stdout.strip()
        if not Path(picture).is_relative_to(place):
            print(f"the package was imported from {picture}, not from the wheel", file=sys.stderr)
            return 1
        for step in STEPS:
            print(step.format(picture="worn.png"), flush=True)
            program, *words = (word.format(picture=picture) for word in step.split())
            subprocess.run([scripts / program, *words], cwd=work, env=clean, check=True)
        missing = [name for name in MADE if not (work / name).is_file()]
        print(f"missing: {', '.join(missing)}" if missing else f"{wheel.name} works")
        return int(bool(missing))


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
