"""How the command line is read and explained: usage errors, pages of help, completion."""

import inspect
import textwrap
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, get_args

from cyclopts import (
    App,
    CoercionError,
    CycloptsError,
    Group,
    MissingArgumentError,
    Parameter,
    RepeatArgumentError,
    UnknownCommandError,
    UnknownOptionError,
    UnusedCliTokensError,
    ValidationError,
)

from garmentimage.cli.terminal import UsageError, one_line
from garmentimage.errors import quoted
from garmentimage.system import did_you_mean

if TYPE_CHECKING:
    from cyclopts.help import HelpEntry, HelpPanel
    from rich.console import Console, ConsoleOptions

MAX_WIDTH = 100
LABEL_WIDTH = 26
"""Labels of options that are longer have a line of their own."""
MAX_CHOICES = 12
"""Of these a usage error lists all."""
VERB_NOUNS = {"train": "network", "evaluate": "subject", "draft": "kind"}
"""What stands after these verbs; after `garmentimage` it is a command."""


def group_of_verbs(name: str, summary: str, title: str) -> App:
    """A command that has verbs of its own, listed under a title unless they are in other groups."""
    return App(
        name=name,
        help=summary,
        help_format="plaintext",
        help_formatter=HelpPage(),
        group_commands=Group(title, sort_key=1000),
        group_arguments=Group("Arguments", sort_key=-2),
        group_parameters=Group("Options", sort_key=-1),
        default_parameter=Parameter(negative=()),
        suppress_keyboard_interrupt=False,
    )


def parse(app: App, words: Sequence[str]) -> tuple[Callable[..., Any], inspect.BoundArguments]:
    """The function that the words call, and its arguments."""
    try:
        verb, bound, _ = app.parse_args(words, print_error=False, exit_on_error=False)
    except CycloptsError as error:
        raise UsageError(_sentence(error)) from None
    if verb == app.help_print:
        chain, apps, _ = app.parse_commands([w for w in words if w not in app.help_flags])
        if not set(app.help_flags).intersection(words):
            raise UsageError(_ended(chain, f"a {_noun(chain).upper()} is missing"))
        if len(apps) == 1:  # the list of all verbs: their summaries stand in their modules
            for name in app:
                if not getattr(app._get_item(name), "help", None):
                    app[name]
    return verb, bound


# --- Usage errors --------------------------------------------------------------------------------


def _sentence(error: CycloptsError) -> str:
    """A usage error in one sentence that ends with where to read more."""
    return _ended(error.command_chain or (), _reason(error))


def _ended(chain: Sequence[str], reason: str) -> str:
    command = " ".join(("garmentimage", *chain))
    return f"{command}: {reason}; see {command} --help"


def _noun(chain: Sequence[str]) -> str:
    return VERB_NOUNS.get(chain[-1], "command") if chain else "command"


def _reason(error: CycloptsError) -> str:
    match error:
        case UnknownCommandError():
            assert error.app is not None and error.unused_tokens
            known = [name for name in error.app if not name.startswith("-")]
            word = error.unused_tokens[0]
            return f"there is no {_noun(error.command_chain or ())} {quoted(word)}" + _near(
                word, known
            )
        case UnknownOptionError():
            return _unknown_option(error.token.keyword or error.token.value, error)
        case UnusedCliTokensError():
            assert error.unused_tokens
            return f"{quoted(error.unused_tokens[0])} is one argument too many"
        case RepeatArgumentError():
            return f"{error.token.keyword} is given twice"
        case MissingArgumentError() if word := _unknown(error):
            return _unknown_option(word, error)  # the missing one, mistyped
        case MissingArgumentError():
            has_no_value = error.keyword is not None or error.tokens_so_far
            return f"{_name(error)} {'has no value' if has_no_value else 'is missing'}"
        case CoercionError():
            return _invalid(error)
        case ValidationError() if error.argument is not None:
            value = error.argument.value
            shown = quoted(value) if isinstance(value, str) else f"{value:.6g}"
            return f"{_name(error)} is {shown}; {error.exception_message}"
    return one_line(error).rstrip(".").replace(". ", "; ")


def _unknown(error: CycloptsError) -> str:
    """The first option among the words left that the verb does not have; empty if it has all."""
    known = _options(error)
    words = [word.partition("=")[0] for word in error.unused_tokens or ()]
    return next((word for word in words if word[:2] == "--" and word not in known), "")


def _unknown_option(word: str, error: CycloptsError) -> str:
    return f"there is no option {quoted(word)}" + _near(word, _options(error), most=0)


def _options(error: CycloptsError) -> list[str]:
    """Names of all options of the verb that is called."""
    assert error.app is not None
    return [name for each in error.app.assemble_argument_collection() for name in each.names]


def _invalid(error: CoercionError) -> str:
    """A value of another type, or not one of the choices."""
    word = error.token.value if error.token else ""
    choices = error.argument.get_choices(force=True) if error.argument else None
    if choices and int not in get_args(error.target_type):
        return f"{_name(error)} is {quoted(word)}" + _near(word, choices)
    words = " or ".join([_type_name(error.target_type), *(choices or ())])
    return f"{_name(error)} is {quoted(word)}, not a {words}"


def _type_name(hint: Any) -> str:
    hints = get_args(hint) or (hint,)
    return "whole number" if int in hints else "number" if float in hints else "valid value"


def _name(error: CycloptsError) -> str:
    """The option or argument, as the user writes it."""
    argument = error.argument
    if argument is None:
        return "an argument"
    keyword = getattr(error, "keyword", None) or next(
        (token.keyword for token in argument.tokens if token.keyword), None
    )
    is_option = argument.index is None or keyword
    return keyword or argument.name if is_option else argument.name.lstrip("-").upper()


def _near(word: str, known: Sequence[str], most: int = MAX_CHOICES) -> str:
    """Which of the known names may be meant; else all of them, if they are few."""
    otherwise = None if len(known) <= most else ""
    hint = did_you_mean(word.partition("=")[0], known, otherwise=otherwise)
    return hint and f"; {hint}"


# --- Pages of help -------------------------------------------------------------------------------


# ruff: noqa: ARG002 - cyclopts calls its formatter with all of these
class HelpPage:
    """Pages of help as plain text: a column of options, a column of words."""

    def render_usage(self, console: "Console", options: "ConsoleOptions", usage: Any) -> None:
        """Print the line that shows how the command is called."""
        console.out(f"Usage: {_plain(usage)}\n", highlight=False)

    def render_description(
        self, console: "Console", options: "ConsoleOptions", description: Any
    ) -> None:
        """Print the docstring of the verb, without its arguments."""
        console.out(f"{_plain(description)}\n", highlight=False)

    def __call__(self, console: "Console", options: "ConsoleOptions", panel: "HelpPanel") -> None:
        """Print a group of verbs or options."""
        if not panel.entries:
            return
        width = min(console.width, MAX_WIDTH)
        page = [f"{panel.title}:"]
        if words := _plain(panel.description):
            page += textwrap.wrap(words, width, initial_indent="  ", subsequent_indent="  ")
        rows = [
            (", ".join(entry.display_labels_with_metavar), _words(entry)) for entry in panel.entries
        ]
        column = min(max((len(label) for label, _ in rows), default=0), LABEL_WIDTH) + 4
        for label, words in rows:
            lines = textwrap.wrap(words, max(width - column, 20))
            if len(label) <= LABEL_WIDTH and lines:
                label = f"{label:{column - 2}}{lines.pop(0)}"
            page += [f"  {label}", *(" " * column + line for line in lines)]
        console.out("\n".join([*page, ""]), highlight=False)


def _words(entry: "HelpEntry") -> str:
    """What an option is for, its choices and its default."""
    parts = [one_line(_plain(entry.description))]
    if entry.choices:
        parts.append(f"[choices: {', '.join(entry.choices)}]")
    if entry.default not in (None, "False"):
        parts.append(f"[default: {entry.default}]")
    if entry.required:
        parts.append("[required]")
    return " ".join(parts)


def _plain(text: Any) -> str:
    """The characters of a text of the library rich, or of cyclopts' wrapper of one."""
    text = getattr(text, "primary_renderable", text)
    return str(getattr(text, "plain", text) or "").strip()


# --- Completion ----------------------------------------------------------------------------------


def completion(shell: Literal["bash", "zsh", "fish"], /) -> None:
    """Print a script that completes verbs and options in a shell.

    Where to keep it: for bash, ~/.local/share/bash-completion/completions/garmentimage; for zsh,
    _garmentimage in a folder of fpath; for fish, ~/.config/fish/completions/garmentimage.fish.

    Args:
        shell: Shell that reads the script.
    """
    from garmentimage.cli.app import command_line

    print(command_line().generate_completion(shell=shell))
