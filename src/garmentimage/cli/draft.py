"""The verbs that draft garments: kinds, bodies, draft, sample, gallery."""

import inspect
import json as json_module
import os
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from textwrap import indent
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, Group, Parameter

from garmentimage.cli.options import DEFAULT_BODY, Json, MeasuredBody, Out, OutFolder, Whole, within
from garmentimage.cli.terminal import (
    Progress,
    pattern_facts,
    print_json,
    print_line,
    print_written,
)
from garmentimage.cli.usage import group_of_verbs
from garmentimage.errors import DraftError, OutputError, quoted
from garmentimage.metrics import plain_table
from garmentimage.system import check_output, safe_name, shown_path, write_atomically

if TYPE_CHECKING:
    from garmentimage.body import BodyMeasurements
    from garmentimage.draft import Kind, Parameter as DraftParameter, Sample, Source

RECORDS = "samples.jsonl"
"""One line for each sample: file, seed, index, body, parameters, rejected draws."""
MAX_REASONS_SHOWN = 5
ALL_CORES = os.cpu_count() or 1
PATTERN_SUFFIX = ".json"
LEVELS = {"low": 0.0, "middle": 0.5, "high": 1.0}
"""Columns of the gallery: where in its range every parameter is."""


# --- kinds, bodies -------------------------------------------------------------------------------


def kinds(kind: str | None = None, /, *, json: Json = False) -> None:
    """List the kinds of garments, with their parameters and ranges.

    Args:
        kind: List this kind only.
    """
    from garmentimage.draft import KINDS, find_kind

    chosen = [find_kind(kind)] if kind else list(KINDS.values())
    if json:
        print_json({"kinds": [_kind_facts(each) for each in chosen]})
        return
    for each in chosen:
        print(f"{each.name}: {each.doc}")
        rows = [[name, _range(p), p.doc] for name, p in each.parameters.items()]
        print(indent(plain_table(rows, left=range(3)), "  ") + "\n")


def _kind_facts(kind: "Kind") -> dict[str, Any]:
    return {
        "kind": kind.name,
        "doc": kind.doc,
        "parameters": [
            {"name": p.name, "default": p.default, "doc": p.doc}
            | (
                {"options": list(p.options)}
                if p.options
                else {"low": p.low, "high": p.high, "unit": p.unit}
            )
            for p in kind.parameters.values()
        ],
    }


def _range(parameter: "DraftParameter") -> str:
    """The range of a parameter, its default and its unit."""
    if parameter.options:
        return " | ".join(map(str, parameter.options)) + f" ({parameter.default})"
    return f"{parameter.low:g} to {parameter.high:g} ({parameter.default:g}) {parameter.unit}"


def bodies(
    body: str | None = None,
    /,
    *,
    out: Annotated[Path | None, Parameter(name=("--out", "-o"), metavar="OUT.json")] = None,
    json: Json = False,
) -> None:
    """List bodies with their measurements [cm], or write those of one to a file.

    Args:
        body: A shipped body, or a JSON file of measurements; without it, all shipped ones.
        out: File for the measurements of this body, to be changed and given as --body.
    """
    from garmentimage.body import presets, save_measurements

    chosen = {body: measured_body(body)} if body else dict(presets())
    if out:
        if not body:
            raise DraftError("-o writes the measurements of one body; name it")
        check_output(out, (PATTERN_SUFFIX,), [body])
        save_measurements(out, chosen[body])
        print_written(out, {"measurements": len(asdict(chosen[body]))}, as_json=json)
        return
    columns = {name: asdict(each) for name, each in chosen.items()}
    if json:
        print_json({"bodies": columns})
        return
    fields = next(iter(columns.values()))
    rows = [[field, *(f"{each[field]:.1f}" for each in columns.values())] for field in fields]
    print(plain_table([["[cm]", *columns], *rows]))


# --- draft ---------------------------------------------------------------------------------------


def __getattr__(name: str) -> App:
    """The verb `draft`, whose kinds are loaded only where it is called."""
    if name != "draft":
        raise AttributeError(name)
    from garmentimage.draft import KINDS

    app = group_of_verbs(
        "draft",
        "Draft a garment of a kind.\n\nEach kind has parameters of its own; see "
        "`garmentimage draft KIND --help`.",
        "Kinds",
    )
    for kind in KINDS.values():
        summary = f"Draft {kind.doc.rstrip('.')}."
        app.command(_draft_command(kind), name=kind.name, help=summary)
    return app


def _draft_command(kind: "Kind") -> Callable[..., None]:
    """A function whose keyword arguments are the parameters of a kind."""

    def draft(
        *,
        out: Path,
        body: str = DEFAULT_BODY,
        param: Sequence[str] = (),
        json: bool = False,
        **given: Any,
    ) -> None:
        from garmentimage.draft import draft_pattern
        from garmentimage.pattern.files import save_pattern

        check_output(out, (PATTERN_SUFFIX,), [body])
        parameters = _pairs(param) | given
        pattern = draft_pattern(kind.name, measured_body(body), **parameters)
        save_pattern(pattern, out)
        print_written(out, pattern_facts(pattern), as_json=json)

    group = Group(f"Parameters of {kind.name}", sort_key=1)
    options: dict[str, tuple[Any, Any]] = {
        "out": (Annotated[Out, Parameter(help="The pattern (.json).")], inspect.Parameter.empty),
        "body": (MeasuredBody, DEFAULT_BODY),
        "param": (
            Annotated[
                list[str],
                Parameter(
                    consume_multiple=1,
                    metavar="NAME=VALUE",
                    help="Parameters by name, instead of the options below.",
                    show_default=False,
                ),
            ],
            [],
        ),
        "json": (Json, False),
        **{name: _option(each, group) for name, each in kind.parameters.items()},
    }
    keyword = inspect.Parameter.KEYWORD_ONLY
    draft.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [
            inspect.Parameter(name, keyword, default=default, annotation=hint)
            for name, (hint, default) in options.items()
        ]
    )
    draft.__annotations__ = {name: hint for name, (hint, _) in options.items()}
    return draft


def _option(parameter: "DraftParameter", group: Group) -> tuple[Any, Any]:
    """The type of an option for a parameter, and its default."""
    if parameter.options:
        choices = tuple(map(str, parameter.options))
        shown = Parameter(choices=choices, help=parameter.doc, group=group)
        return Annotated[str, shown], str(parameter.default)
    low, high, unit = parameter.low, parameter.high, parameter.unit
    shown = Parameter(
        help=f"{parameter.doc} [{low:g} to {high:g}{unit and ' ' + unit}]",
        validator=within(low, high, unit),
        show_default=f"{parameter.default:g}",
        group=group,
    )
    return Annotated[float, shown], parameter.default


def _pairs(words: Sequence[str]) -> dict[str, str]:
    """`a=1 b 2` as names and values."""
    found: dict[str, str] = {}
    left = list(words)
    while left:
        name, is_pair, value = left.pop(0).partition("=")
        if not is_pair:
            if not left:
                raise DraftError(f"parameter {quoted(name)} has no value; give {name}=VALUE")
            value = left.pop(0)
        found[name.replace("-", "_")] = value
    return found


# --- sample, gallery -----------------------------------------------------------------------------


def sample(
    source: str,
    /,
    *,
    out: OutFolder,
    count: Whole = 1,
    seed: Whole = 0,
    body: MeasuredBody = DEFAULT_BODY,
    first: Whole = 0,
    workers: Annotated[Whole, Parameter(show_default="all cores")] = ALL_CORES,
    json: Json = False,
) -> None:
    """Draw random garments from a seed.

    Args:
        source: A kind of garment, or a template of 2021 with parameters (.json).
        count: Number of garments.
        seed: The same seed gives the same garments, on any number of workers.
        body: A shipped body, a JSON file of measurements, or any to draw the body, too.
        first: Index of the first garment.
        workers: Processes.
    """
    from garmentimage.draft import sample as draw

    origin = _source(source)
    if out.exists() and not out.is_dir():
        raise OutputError(f"{shown_path(out)}: is a file; name a folder")
    wearer = measured_body(body) if _is_file(body) else body
    drawn = draw(origin, count, seed, body=wearer, workers=workers, first=first)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{shown_path(out)}: cannot be made ({error.strerror})") from None
    records = _records(out / RECORDS)
    made = 0
    reasons: dict[str, int] = {}
    try:
        with Progress("pattern", count) as progress:
            for one in drawn:
                records |= _save(one, out)
                made += 1
                progress.advance()
                for reason in one.rejected:
                    reasons[reason] = reasons.get(reason, 0) + 1
    finally:  # also what was made before Ctrl-C is listed
        write_atomically(out / RECORDS, "".join(f"{line}\n" for line in records.values()))
    _report(out, made, reasons, as_json=json)


def _records(path: Path) -> dict[str, str]:
    """The lines of a folder's records by file, which new samples join; none where there is none."""
    if not path.exists():
        return {}
    try:
        lines = path.read_text("utf-8").split("\n")
        return {str(json_module.loads(line)["file"]): line for line in lines if line}
    except (OSError, ValueError, TypeError, KeyError):
        raise OutputError(
            f"{shown_path(path)}: not a list of samples that new ones could join; move it, or name "
            "another folder"
        ) from None


def _save(one: "Sample", folder: Path) -> dict[str, str]:
    """Write a sample's pattern; its line of the records by file."""
    from garmentimage.pattern.files import save_pattern

    name = f"{safe_name(one.source)}_{one.seed}_{one.index:06d}.json"
    save_pattern(one.pattern, folder / name)
    return {name: json_module.dumps({"file": name, **one.record()}, ensure_ascii=False)}


def _report(out: Path, count: int, reasons: dict[str, int], *, as_json: bool) -> None:
    rejected = sum(reasons.values())
    share = rejected / max(count + rejected, 1)
    if as_json:
        facts = {"out": str(out), "patterns": count, "rejected": rejected}
        print_json({**facts, "rejected_share": share, "reasons": reasons})
        return
    print(
        f"{shown_path(out)}: {count} patterns and {RECORDS}; {rejected} of {count + rejected} "
        f"draws rejected ({share:.1%})"
    )
    for reason, times in sorted(reasons.items(), key=lambda item: -item[1])[:MAX_REASONS_SHOWN]:
        print_line(f"rejected {times} x: {reason}")


def gallery(*kinds: str, out: Out, body: MeasuredBody = DEFAULT_BODY, json: Json = False) -> None:
    """Draw kinds at low, middle and high values of all their parameters.

    Args:
        kinds: Kinds to draw; without any, all.
        out: The picture (.png or .svg).
    """
    from garmentimage.draft import KINDS, drafted, find_kind
    from garmentimage.render import SUFFIXES, show_sheet

    check_output(out, SUFFIXES, [])
    chosen = [find_kind(name) for name in kinds] or list(KINDS.values())
    wearer = measured_body(body)
    rows = {each.name: [drafted(each, wearer, x) for x in LEVELS.values()] for each in chosen}
    show_sheet(rows, columns=list(LEVELS), out=out)
    print_written(out, {"kinds": len(rows)}, as_json=json)


# --- Shared --------------------------------------------------------------------------------------


def measured_body(name: str) -> "BodyMeasurements":
    """A shipped body, or one from a file of measurements."""
    from garmentimage.body import load_measurements, measurements

    if _is_file(name):
        body = load_measurements(name)
        body.check()
        return body
    return measurements(name)


def _is_file(body: str) -> bool:
    return body.lower().endswith(".json")


def _source(name: str) -> "Source":
    from garmentimage.draft import find_kind
    from garmentimage.draft.templates import Template

    return Template.read(name) if name.lower().endswith(PATTERN_SUFFIX) else find_kind(name)
