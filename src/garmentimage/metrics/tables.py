"""Tables of figures, as Markdown and as plain text."""

from collections.abc import Collection, Sequence


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table, with a line break at the end.

    Example:
        >>> print(markdown_table(["", "a"], [["x", "1"]]), end="")
        | | a |
        |---|---|
        | x | 1 |
    """
    lines = [_markdown_row(head), "|---" * len(head) + "|", *map(_markdown_row, rows)]
    return "\n".join(lines) + "\n"


def plain_table(
    head: Sequence[str], rows: Sequence[Sequence[str]], left: Collection[int] = (0,)
) -> str:
    """A table of plain text; the columns `left` are aligned left, others right."""
    lines = [head, *rows]
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    return "\n".join(
        "  ".join(
            text.ljust(width) if k in left else text.rjust(width)
            for k, (text, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    )


def _markdown_row(cells: Sequence[str]) -> str:
    return "|" + "".join(f" {cell} |" if cell else " |" for cell in cells)
