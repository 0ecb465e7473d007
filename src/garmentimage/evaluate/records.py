"""Records of an evaluation: JSON lines in a folder, so that an interrupted run resumes.

`run.json` identifies networks, data and amounts; a folder with records of others is refused.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol, TypeVar, runtime_checkable

from garmentimage.errors import LearnError
from garmentimage.system import TimedOut, map_in_processes, shown_path, write_atomically

RUN_FILE = "run.json"


@runtime_checkable
class RecordedItem(Protocol):
    """One measurement; hashable."""

    @property
    def name(self) -> str:
        """File of its record."""

    @property
    def number(self) -> int:
        """Number of its record in the file."""


Item = TypeVar("Item", bound=RecordedItem)


class Records:
    """The records in a folder, by name and number.

    Args:
        folder: created if needed.
        amounts: how much is measured.
        networks: by name, what identifies each; networks of earlier calls are kept.

    Raises:
        LearnError: the folder holds records of other networks, data or amounts, is damaged, or
            cannot be used.
    """

    def __init__(
        self, folder: Path, amounts: Mapping[str, Any], networks: Mapping[str, Mapping[str, Any]]
    ) -> None:
        self.folder = folder
        self._known: dict[str, dict[int, dict[str, Any]]] = {}
        wanted = json.loads(json.dumps({"amounts": dict(amounts), "networks": dict(networks)}))
        file = folder / RUN_FILE
        try:
            folder.mkdir(parents=True, exist_ok=True)
            found = json.loads(file.read_text(encoding="utf-8")) if file.exists() else wanted
            others = [name for name in wanted["networks"] if name in found["networks"]]
            if found["amounts"] != wanted["amounts"] or any(
                found["networks"][name] != wanted["networks"][name] for name in others
            ):
                raise LearnError(
                    f"{shown_path(folder)}: holds records of other networks, data or amounts; "
                    "choose another folder"
                )
            wanted["networks"] = found["networks"] | wanted["networks"]
        except OSError as error:
            raise LearnError(
                f"{shown_path(folder)}: cannot be used ({error.strerror}); choose another folder"
            ) from None
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            if isinstance(error, LearnError):
                raise
            raise LearnError(f"{shown_path(file)}: is damaged; choose another folder") from None
        write_atomically(file, json.dumps(wanted, indent=1) + "\n")

    def get(self, name: str, number: int) -> dict[str, Any] | None:
        """A record, if it exists."""
        if name not in self._known:
            self._known[name] = self._read(self._file(name))
        return self._known[name].get(number)

    def append(self, name: str, number: int, record: Mapping[str, Any]) -> None:
        """Add a record."""
        file = self._file(name)
        line = json.dumps({"number": number, **record}) + "\n"
        if file.exists():
            text = file.read_text(encoding="utf-8")
            whole = text[: text.rfind("\n") + 1]
            if whole != text:  # the start of a line, written when the run was interrupted
                write_atomically(file, whole)
        with file.open("a", encoding="utf-8") as opened:
            opened.write(line)

    def gather(
        self,
        items: Sequence[Item],
        work: Callable[[Item], dict[str, Any]],
        *,
        workers: int,
        time_limit: float,
        progress: Callable[[int, int], None],
        is_whole: Callable[[Item, Mapping[str, Any]], bool] = lambda *_: True,
        begin: Callable[[Sequence[Item]], None] = lambda _: None,
    ) -> dict[Item, dict[str, Any]]:
        """The records of all items; missing ones are measured and stored.

        An item whose process hung or died has a record `lost` with the reason, and is measured
        again by the next run.

        Args:
            items: to measure.
            work: measures an item, in another process.
            workers: processes.
            time_limit: of an item, including what its process loads first [s].
            progress: called with the number of complete items, and of all.
            is_whole: whether a record has everything that is wanted of its item.
            begin: called with the items that will be measured, if any.
        """
        found = {}
        for item in items:
            record = self.get(item.name, item.number)
            if record is not None and is_whole(item, record):
                found[item] = record
        missing = [item for item in items if item not in found]
        if missing:
            begin(missing)
        progress(len(found), len(items))
        for outcome in map_in_processes(work, missing, workers=workers, time_limit=time_limit):
            item, made = missing[outcome.number], outcome.result
            if isinstance(made, TimedOut):
                found[item] = {"lost": made.reason}
            else:
                found[item] = made
                self.append(item.name, item.number, made)
            progress(len(found), len(items))
        return found

    def _file(self, name: str) -> Path:
        return self.folder / f"{name.replace(' ', '-').replace(',', '')}.jsonl"

    def _read(self, file: Path) -> dict[int, dict[str, Any]]:
        if not file.exists():
            return {}
        lines = file.read_text(encoding="utf-8").split("\n")
        try:
            # The last line is incomplete if the run was interrupted in writing it.
            found = [json.loads(line) for line in lines[:-1]]
            return {int(line.pop("number")): line for line in found}
        except (ValueError, KeyError, TypeError, AttributeError):
            raise LearnError(
                f"{shown_path(file)}: is damaged; remove it, and what it holds is measured again"
            ) from None
