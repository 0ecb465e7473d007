"""The model card of a trained network."""

from collections.abc import Mapping
from typing import Any


def model_card(
    name: str, summary: str, usage: str, facts: Mapping[str, Any], last: Mapping[str, float]
) -> str:
    """README.md of a network, with metadata for the Hugging Face Hub.

    Args:
        name: of the network.
        summary: a sentence on what it does.
        usage: which of its files are for what, and how.
        facts: recipe, data, commit, seed and the like.
        last: the last line of its log.
    """
    losses = {key: value for key, value in last.items() if key.startswith("held-out ")}
    return f"""---
library_name: garmentimage
license: mit
tags: [sewing patterns, garments]
---

# {name}

{summary}

| made from | |
|---|---|
{_rows(facts)}

| of held-out garments, after the last epoch | |
|---|---|
{_rows({key.removeprefix("held-out "): f"{value:.5f}" for key, value in losses.items()})}

{usage}
"""


def _rows(facts: Mapping[str, Any]) -> str:
    return "\n".join(f"| {key} | {value} |" for key, value in facts.items())
