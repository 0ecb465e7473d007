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


def plain_table(rows: Sequence[Sequence[str]], left: Collection[int] = (0,)) -> str:
    """A table of plain text; the columns `left` are aligned left, others right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(
            text.ljust(width) if k in left else text.rjust(width)
            for k, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )


def _markdown_row(cells: Sequence[str]) -> str:
    return "|" + "".join(f" {cell} |" if cell else " |" for cell in cells)
