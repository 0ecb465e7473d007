"""The verbs of the command line that make patterns: kinds, bodies, draft, sample, gallery."""

import argparse
import json
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from garmentimage.cli.terminal import Exit, print_json, print_written, say, whole_number
from garmentimage.errors import DraftError, OutputError, quoted
from garmentimage.system import did_you_mean, safe_name, shown_path, write_atomically

if TYPE_CHECKING:
    from garmentimage.body import BodyMeasurements
    from garmentimage.draft import Kind, Parameter, Sample, Source

RECORDS = "samples.jsonl"
"""One line for each sample: file, seed, index, body, parameters, rejected draws."""
REASONS_SHOWN = 5
TEMPLATE_SUFFIX = ".json"
BODY = "mean-female"
GALLERY_LEVELS = (("low", 0.0), ("middle", 0.5), ("high", 1.0))


# --- kinds ---------------------------------------------------------------------------------------


def kinds_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `kinds`."""
    parser.add_argument("kind", nargs="?", metavar="KIND", help="list only this one")


def run_kinds(options: argparse.Namespace) -> Exit:
    """List the kinds of garments with their parameters."""
    from garmentimage.draft import KINDS

    chosen = [_kind(options.kind)] if options.kind else list(KINDS.values())
    if options.json:
        print_json({"kinds": [_kind_facts(kind) for kind in chosen]})
        return Exit.OK
    for kind in chosen:
        print(f"{kind.name}: {kind.doc}")
        width = max(map(len, kind.parameters))
        for name, parameter in kind.parameters.items():
            print(f"  {name:{width}}  {_shown(parameter)}  {parameter.doc}")
        print()
    return Exit.OK


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


def _shown(parameter: "Parameter") -> str:
    """The range of a parameter, its default and its unit."""
    if parameter.options:
        text = " | ".join(map(str, parameter.options)) + f" ({parameter.default})"
    else:
        text = f"{parameter.low:g} to {parameter.high:g} ({parameter.default:g}) {parameter.unit}"
    return f"{text:36}"


# --- bodies --------------------------------------------------------------------------------------


def bodies_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `bodies`."""
    parser.add_argument("body", nargs="?", metavar="BODY", help="only this one, or a file of yours")
    parser.add_argument(
        "-o", "--out", type=Path, metavar="OUT.json", help="write its measurements, to be changed"
    )


def run_bodies(options: argparse.Namespace) -> Exit:
    """List the bodies with their measurements, or write down one."""
    from garmentimage.body import presets, save_measurements

    chosen = {options.body: _body(options.body)} if options.body else dict(presets())
    if options.out:
        if not options.body:
            raise DraftError("-o writes the measurements of one body; name it")
        _check_suffix(options.out)
        save_measurements(options.out, chosen[options.body])
        print_written(options, {"measurements": len(asdict(chosen[options.body]))})
        return Exit.OK
    if options.json:
        print_json({"bodies": {name: asdict(body) for name, body in chosen.items()}})
        return Exit.OK
    rows = {name: asdict(body) for name, body in chosen.items()}
    fields = list(next(iter(rows.values())))
    width = max(map(len, fields))
    print(f"{'[cm]':{width}}", *(f"{name[:18]:>18}" for name in rows))
    for field in fields:
        print(f"{field:{width}}", *(f"{row[field]:18.1f}" for row in rows.values()))
    return Exit.OK


# --- draft ---------------------------------------------------------------------------------------


def draft_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `draft_pattern`."""
    parser.add_argument("kind", metavar="KIND", help="see `garmentimage kinds`")
    parser.add_argument(
        "--param",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME=VALUE",
        help="what differs from the defaults; also as --NAME VALUE",
    )
    _add_body(parser, "")
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="OUT.json")


def run_draft(options: argparse.Namespace) -> Exit:
    """Draft one garment and save it."""
    from garmentimage.draft import draft_pattern
    from garmentimage.pattern.files import save_pattern

    _check_suffix(options.out)
    given = _pairs(options.param) | _options(options.rest)
    _kind(options.kind)
    pattern = draft_pattern(options.kind, _body(options.body), **given)
    save_pattern(pattern, options.out)
    print_written(options, {"panels": len(pattern.panels), "stitches": len(pattern.stitches)})
    return Exit.OK


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


def _options(words: Sequence[str]) -> dict[str, str]:
    """`--a 1 --b=2` as names and values."""
    for k, word in enumerate(words):
        is_value = k > 0 and words[k - 1].startswith("--") and "=" not in words[k - 1]
        if not is_value and not word.startswith("--"):
            raise DraftError(f"{quoted(word)} is no parameter; give --NAME VALUE")
    return _pairs([word.removeprefix("--") for word in words])


# --- sample --------------------------------------------------------------------------------------


def sample_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `sample`."""
    parser.add_argument(
        "source", metavar="KIND|TEMPLATE.json", help="a kind, or a 2021 template with parameters"
    )
    parser.add_argument("--count", type=whole_number, default=1, metavar="N", help="how many (1)")
    parser.add_argument("--seed", type=whole_number, default=0, metavar="S", help="0 unless told")
    _add_body(parser, ", or `any` to draw it, too")
    parser.add_argument(
        "--first", type=whole_number, default=0, metavar="K", help="index to begin at (0)"
    )
    parser.add_argument(
        "--workers",
        type=whole_number,
        default=os.cpu_count() or 1,
        metavar="W",
        help="processes (all)",
    )
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="FOLDER")


def run_sample(options: argparse.Namespace) -> Exit:
    """Draw garments at random and save them with a record of what was drawn."""
    from tqdm import tqdm

    from garmentimage.draft import sample

    source = _source(options.source)
    out: Path = options.out
    if out.exists() and not out.is_dir():
        raise OutputError(f"{shown_path(out)}: is a file; name a folder")
    drawn = sample(
        source,
        options.count,
        options.seed,
        body=_body(options.body) if _is_file(options.body) else options.body,
        workers=options.workers,
        first=options.first,
    )
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{shown_path(out)}: cannot be made ({error.strerror})") from None
    records = _records(out / RECORDS)
    count = 0
    reasons: dict[str, int] = {}
    try:
        for one in tqdm(drawn, total=options.count, unit="pattern", leave=False, disable=None):
            records |= _save(one, out)
            count += 1
            for reason in one.rejected:
                reasons[reason] = reasons.get(reason, 0) + 1
    finally:  # also what was made before Ctrl-C is listed
        write_atomically(out / RECORDS, "".join(f"{line}\n" for line in records.values()))
    _report(options, count, reasons)
    return Exit.OK


def _records(path: Path) -> dict[str, str]:
    """The lines of a folder's records by file, which new samples join; none where none are."""
    if not path.exists():
        return {}
    try:
        lines = path.read_text("utf-8").split("\n")
        return {str(json.loads(line)["file"]): line for line in lines if line}
    except (OSError, ValueError, TypeError, KeyError):
        raise OutputError(
            f"{shown_path(path)}: is no list of samples that this one could join; move it, or name "
            "another folder"
        ) from None


def _save(one: "Sample", folder: Path) -> dict[str, str]:
    """Write a sample's pattern; its line of the records by file."""
    from garmentimage.pattern.files import save_pattern

    name = f"{safe_name(one.source)}_{one.seed}_{one.index:06d}.json"
    save_pattern(one.pattern, folder / name)
    return {name: json.dumps({"file": name, **one.record()}, ensure_ascii=False)}


def _report(options: argparse.Namespace, count: int, reasons: dict[str, int]) -> None:
    rejected = sum(reasons.values())
    share = rejected / max(count + rejected, 1)
    if options.json:
        facts = {"out": str(options.out), "patterns": count, "rejected": rejected}
        print_json({**facts, "rejected_share": share, "reasons": reasons})
        return
    print(f"{shown_path(options.out)}: {count} patterns and {RECORDS}; {rejected} of", end=" ")
    print(f"{count + rejected} draws rejected ({share:.1%})")
    for reason, times in sorted(reasons.items(), key=lambda item: -item[1])[:REASONS_SHOWN]:
        say(f"rejected {times} x: {reason}")


# --- gallery -------------------------------------------------------------------------------------


def gallery_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `gallery`."""
    parser.add_argument("kinds", nargs="*", metavar="KIND", help="all unless told")
    _add_body(parser, "")
    parser.add_argument("-o", "--out", type=Path, required=True, metavar="OUT.png")


def run_gallery(options: argparse.Namespace) -> Exit:
    """Draw kinds at low, middle and high values of all their parameters on one sheet."""
    from garmentimage.draft import KINDS, drafted
    from garmentimage.render import show_sheet

    chosen = [_kind(name) for name in options.kinds] or list(KINDS.values())
    body = _body(options.body)
    rows = {
        kind.name: [drafted(kind, body, level) for _, level in GALLERY_LEVELS] for kind in chosen
    }
    show_sheet(rows, columns=[name for name, _ in GALLERY_LEVELS], out=options.out)
    print_written(options, {"kinds": len(rows)})
    return Exit.OK


# --- shared --------------------------------------------------------------------------------------


def _add_body(parser: argparse.ArgumentParser, more: str) -> None:
    parser.add_argument(
        "--body",
        default=BODY,
        metavar="BODY",
        help=f"a shipped body or a JSON file of measurements{more} ({BODY})",
    )


def _body(name: str) -> "BodyMeasurements":
    """A shipped body, or one from a file."""
    from garmentimage.body import load_measurements, measurements

    if _is_file(name):
        body = load_measurements(name)
        body.check()
        return body
    return measurements(name)


def _is_file(body: str) -> bool:
    return body.lower().endswith(".json")


def _check_suffix(out: Path) -> None:
    if out.suffix.lower() != ".json":
        raise OutputError(f"{shown_path(out)}: the name must end in .json")


def _kind(name: str) -> "Kind":
    from garmentimage.draft import KINDS

    if name not in KINDS:
        raise DraftError(f"there is no kind {quoted(name)}; {did_you_mean(name, KINDS)}")
    return KINDS[name]


def _source(name: str) -> "Source":
    if not name.lower().endswith(TEMPLATE_SUFFIX):
        return _kind(name)
    from garmentimage.draft.templates import Template

    return Template.read(name)
