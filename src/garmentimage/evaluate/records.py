"""Records of an evaluation: files of JSON lines in a folder, so that one that was stopped goes on.

`run.json` tells what they are records of; those of other networks, data or amounts are refused.
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
    """One thing to measure; it can be a key of a dictionary."""

    @property
    def name(self) -> str:
        """Of the records that its record is one of."""

    @property
    def number(self) -> int:
        """Of its record among them."""


Item = TypeVar("Item", bound=RecordedItem)


class Records:
    """The records in a folder, by name and number.

    Args:
        folder: made where it is not there.
        amounts: how much is measured.
        networks: by name, what tells each from others; those of earlier calls stay.

    Raises:
        LearnError: the folder holds records of others, is damaged, or cannot be used.
    """

    def __init__(
        self, folder: Path, amounts: Mapping[str, Any], networks: Mapping[str, Mapping[str, Any]]
    ) -> None:
        self.folder = folder
        self._known: dict[str, dict[int, dict[str, Any]]] = {}
        told = json.loads(json.dumps({"amounts": dict(amounts), "networks": dict(networks)}))
        file = folder / RUN_FILE
        try:
            folder.mkdir(parents=True, exist_ok=True)
            found = json.loads(file.read_text(encoding="utf-8")) if file.exists() else told
            others = [name for name in told["networks"] if name in found["networks"]]
            if found["amounts"] != told["amounts"] or any(
                found["networks"][name] != told["networks"][name] for name in others
            ):
                raise LearnError(
                    f"{shown_path(folder)}: holds records of other networks, data or amounts; "
                    "choose another folder"
                )
            told["networks"] = found["networks"] | told["networks"]
        except OSError as error:
            raise LearnError(
                f"{shown_path(folder)}: cannot be used ({error.strerror}); choose another folder"
            ) from None
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            if isinstance(error, LearnError):
                raise
            raise LearnError(f"{shown_path(file)}: is damaged; choose another folder") from None
        write_atomically(file, json.dumps(told, indent=1) + "\n")

    def kept(self, name: str, number: int) -> dict[str, Any] | None:
        """The record of a name and a number, if it is there."""
        if name not in self._known:
            self._known[name] = self._read(self._file(name))
        return self._known[name].get(number)

    def keep(self, name: str, number: int, record: Mapping[str, Any]) -> None:
        """Add a record."""
        file = self._file(name)
        line = json.dumps({"number": number, **record}) + "\n"
        if file.exists():
            kept = file.read_text(encoding="utf-8")
            whole = kept[: kept.rfind("\n") + 1]
            if whole != kept:  # the end of a line that was being written when it was stopped
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
        is_whole: Callable[[Item, Mapping[str, Any]], bool] = lambda item, record: True,
        begin: Callable[[Sequence[Item]], None] = lambda missing: None,
    ) -> dict[Item, dict[str, Any]]:
        """The records of all items; what is not there is measured now, and kept.

        Args:
            items: what there should be records of.
            work: measures an item, in a process of its own.
            workers: processes.
            time_limit: for an item, and for what its process must load before it [s].
            progress: called with how many are done, and of how many.
            is_whole: whether a record holds all that is wanted of its item.
            begin: called with what will be measured, if anything.

        Returns:
            By item; who was lost has a record `lost` that says why, and is tried again next time.
        """
        found = {}
        for item in items:
            record = self.kept(item.name, item.number)
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
                self.keep(item.name, item.number, made)
            progress(len(found), len(items))
        return found

    def _file(self, name: str) -> Path:
        return self.folder / f"{name.replace(' ', '-').replace(',', '')}.jsonl"

    def _read(self, file: Path) -> dict[int, dict[str, Any]]:
        if not file.exists():
            return {}
        lines = file.read_text(encoding="utf-8").split("\n")
        try:
            # The last one has no end where a run was stopped while it wrote.
            found = [json.loads(line) for line in lines[:-1]]
            return {int(line.pop("number")): line for line in found}
        except (ValueError, KeyError, TypeError, AttributeError):
            raise LearnError(
                f"{shown_path(file)}: is damaged; remove it, and what it holds is measured again"
            ) from None
