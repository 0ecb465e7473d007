"""Measures of the code of a checkout: sizes, complexity, tests, comments, public names.

    python scripts/measure_code.py [CHECKOUT...]

Prints a table with a column for each checkout (default: this one). A function's body is its lines
without the docstring; nested functions are counted apart. Cyclomatic complexity is 1 + branches,
loops, handlers, conditional expressions, boolean operators and comprehension clauses.
"""

import argparse
import ast
import io
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

PACKAGE = "src/garmentimage"
NUMERICAL = "kernel", "solve", "polish", "route", "compact", "relax", "step", "curve_fit", "walls"
"""Names of files of kernels and solvers contain one of these."""
BRANCHES = (
    ast.If, ast.For, ast.AsyncFor, ast.While, ast.ExceptHandler, ast.IfExp, ast.comprehension,
    ast.Assert, ast.match_case,
)  # fmt: skip
Function = ast.FunctionDef | ast.AsyncFunctionDef


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("checkouts", nargs="*", type=Path, default=[Path(__file__).parents[1]])
    folders = parser.parse_args().checkouts
    columns = [measures(folder) for folder in folders]
    names = [folder.resolve().name for folder in folders]
    print("| |" + "".join(f" {name} |" for name in names))
    print("|---" * (len(names) + 1) + "|")
    for measure in columns[0]:
        print(f"| {measure} |" + "".join(f" {column[measure]} |" for column in columns))
    return 0


def measures(checkout: Path) -> dict[str, str]:
    """All measures of a checkout, as text by name."""
    files = sorted((checkout / PACKAGE).rglob("*.py"))
    texts = [file.read_text(encoding="utf-8") for file in files]
    trees = [ast.parse(text) for text in texts]
    lengths = [text.count("\n") for text in texts]
    functions = [each for tree in trees for each in _functions(tree)]
    bodies = [_body_length(each) for each in functions]
    complexities = [_complexity(each) for each in functions]
    arguments = [_argument_count(each) for each in functions]
    comments = [_comment_count(text) for text in texts]
    numerical = [any(word in file.stem for word in NUMERICAL) for file in files]
    rooms = Counter(file.parent for file in files if file.name != "__init__.py")
    test_lines = sum(
        file.read_text(encoding="utf-8").count("\n") for file in (checkout / "tests").rglob("*.py")
    )
    total = sum(lengths)
    return {
        "files": f"{len(files)}",
        "lines": f"{total:,}",
        "file lines, median / p95 / max": _quantiles(lengths),
        "functions": f"{len(functions):,}",
        "body lines, median / p95 / max": _quantiles(bodies),
        "cyclomatic, p95 / max": _quantiles(complexities, median=False),
        "functions of more than 50 lines": f"{sum(n > 50 for n in bodies)}",
        "functions of more than 60 lines": f"{sum(n > 60 for n in bodies)}",
        "arguments, p95 / max": _quantiles(arguments, median=False),
        "test lines / source lines": f"{test_lines / total:.2f}",
        "public top-level names": f"{sum(len(_public_names(tree)) for tree in trees):,}",
        "comment lines": f"{sum(comments) / total:.1%}",
        "docstring lines": f"{sum(map(_docstring_lines, trees)) / total:.1%}",
        "comment lines of kernels and solvers": _share(comments, lengths, numerical),
        "files of a room, median / max": f"{np.median([*rooms.values()]):.0f} / "
        f"{max(rooms.values())}",
    }


def _quantiles(values: list[int], *, median: bool = True) -> str:
    parts = [np.percentile(values, 95), max(values)]
    return " / ".join(f"{n:.0f}" for n in ([np.median(values), *parts] if median else parts))


def _share(comments: list[int], lengths: list[int], chosen: list[bool]) -> str:
    total = sum(n for n, is_chosen in zip(lengths, chosen, strict=True) if is_chosen)
    found = sum(n for n, is_chosen in zip(comments, chosen, strict=True) if is_chosen)
    return f"{found / total:.1%}"


def _functions(tree: ast.AST) -> list[Function]:
    return [node for node in ast.walk(tree) if isinstance(node, Function)]


def _own(function: Function) -> Iterator[ast.AST]:
    """Nodes of a function without those of nested functions."""
    left: list[ast.AST] = list(function.body)
    while left:
        node = left.pop()
        yield node
        if not isinstance(node, Function):
            left.extend(ast.iter_child_nodes(node))


def _docstring_length(node: ast.AST) -> int:
    body = getattr(node, "body", None)
    if not body or not isinstance(body, list) or not isinstance(body[0], ast.Expr):
        return 0
    value = body[0].value
    if not isinstance(value, ast.Constant) or not isinstance(value.value, str):
        return 0
    return body[0].end_lineno - body[0].lineno + 1


def _docstring_lines(tree: ast.Module) -> int:
    """Lines of docstrings, those of constants and fields among them."""
    return sum(
        (node.end_lineno or node.lineno) - node.lineno + 1
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _body_length(function: Function) -> int:
    last = function.body[-1].end_lineno or function.lineno
    length = last - function.body[0].lineno + 1 - _docstring_length(function)
    nested = [node for node in _own(function) if isinstance(node, Function)]
    return length - sum((each.end_lineno or each.lineno) - each.lineno + 1 for each in nested)


def _complexity(function: Function) -> int:
    count = 1
    for node in _own(function):
        count += isinstance(node, BRANCHES)
        count += len(node.values) - 1 if isinstance(node, ast.BoolOp) else 0
        count += len(node.ifs) if isinstance(node, ast.comprehension) else 0
    return count


def _argument_count(function: Function) -> int:
    own = function.args
    return len(own.posonlyargs) + len(own.args) + len(own.kwonlyargs)


def _comment_count(text: str) -> int:
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return sum(token.type == tokenize.COMMENT for token in tokens)


def _public_names(tree: ast.Module) -> set[str]:
    """Functions and classes of a module without a leading underscore."""
    kinds = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
    return {
        node.name for node in tree.body if isinstance(node, kinds) and not node.name.startswith("_")
    }


if __name__ == "__main__":
    sys.exit(main())
