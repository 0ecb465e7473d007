"""How a network is trained. Needs no torch, so that the command line can list it quickly."""

import os
from dataclasses import dataclass
from typing import Literal

from garmentimage.errors import LearnError

Accelerator = Literal["cpu", "gpu", "cuda", "mps", "auto"]
Precision = Literal["auto", "32-true", "bf16-mixed", "16-mixed"]
MAX_SEED = 2**31 - 1


@dataclass(frozen=True)
class TrainingSettings:
    """How a network is trained.

    Raises:
        LearnError: a number out of its range, or more devices than the machine has cores.
    """

    epochs: int = 40
    """Times through the data."""
    batch: int = 64
    """Garments of a step."""
    rate: float = 2e-3
    """Highest learning rate; it falls along a cosine."""
    decay: float = 1e-2
    """Weight decay."""
    seed: int = 0
    """Of the first weights, the order of the garments and all noise."""
    accelerator: Accelerator = "cpu"
    """Device that trains."""
    devices: int = 1
    """Devices of each node."""
    nodes: int = 1
    """Machines."""
    precision: Precision = "auto"
    """As Lightning Fabric names it; auto takes what the accelerator computes fastest."""

    def __post_init__(self) -> None:
        for name in ("epochs", "batch", "devices", "nodes"):
            if getattr(self, name) < 1:
                raise LearnError(f"{name} is {getattr(self, name)}; give 1 or more")
        if not 0 < self.rate < 1:
            raise LearnError(f"rate is {self.rate}; give more than 0 and less than 1")
        if not 0 <= self.decay < 1:
            raise LearnError(f"decay is {self.decay}; give 0 or more and less than 1")
        if not 0 <= self.seed <= MAX_SEED:
            raise LearnError(f"seed is {self.seed}; give 0 to {MAX_SEED}")
        cores = os.cpu_count() or 1
        if self.accelerator == "cpu" and self.devices > cores:
            raise LearnError(f"devices is {self.devices}; this machine has {cores} cores")
