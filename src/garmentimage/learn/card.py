"""The card of a trained network: what it is, what it was made from, and how."""

from collections.abc import Mapping
from typing import Any


def model_card(
    name: str, what: str, use: str, facts: Mapping[str, Any], last: Mapping[str, float]
) -> str:
    """README.md of a network, with the metadata that the Hugging Face Hub reads.

    Args:
        name: of the network.
        what: a sentence on what it does.
        use: which of its files are for what, and how.
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

{what}

| made from | |
|---|---|
{_rows(facts)}

| of held-out garments, after the last epoch | |
|---|---|
{_rows({key.removeprefix("held-out "): f"{value:.5f}" for key, value in losses.items()})}

{use}
"""


def _rows(facts: Mapping[str, Any]) -> str:
    return "\n".join(f"| {key} | {value} |" for key, value in facts.items())
