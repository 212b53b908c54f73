"""One training run: what it depends on, its network and optimiser, and where it stands."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

import torch
from torch import Tensor, nn

from training.canvas import Batch, Source, stack
from training.loss import LOSSES, omega
from training.measure import Confusion
from training.muon import Muon
from training.network import Shape, build_net
from training.render import Sample

SETTLING_FIRST = 1 << 40
"""Number of the first canvas that normalisation statistics are taken from: beyond any that is trained on."""
SETTLING_BATCH, SETTLING_BATCHES = 8, 24


@dataclass(frozen=True, slots=True)
class Config:
    """Everything a run depends on; stored beside its checkpoint."""

    data: str
    raw: str | None = None
    shape: Shape = field(default_factory=Shape)
    loss: str = "mwx"
    omega_exponent: float = 0.5
    plain_share: float = 0.15
    optimiser: str = "adamw"
    learning_rate: float = 4e-3
    weight_decay: float = 1e-4
    warm_up: float = 0.05
    fall: float = 0.4
    batch: int = 4
    curved: float = 0.45
    wide_every: int = 6
    wide_px: int = 285
    ema: float = 0.998
    clip: float = 5.0
    seed: int = 0
    seconds: float | None = None
    images: int | None = None
    bf16: bool = True
    threads: int = 0
    start: str | None = None
    validation: int = 160
    """Held-out sketches that the validation is measured on."""


@dataclass(slots=True)
class Progress:
    """What a checkpoint holds besides weights: how far the run is and what it has measured."""

    images: int = 0
    batches: int = 0
    seconds: float = 0.0
    history: list[dict[str, float]] = field(default_factory=list)

    def share(self, config: Config) -> float:
        """0 at the start, 1 at the end of the budget."""
        if config.images is not None:
            return min(1.0, self.images / config.images)
        return min(1.0, self.seconds / (config.seconds or 1.0))


def learning_rate(config: Config, share: float) -> float:
    """Trapezoid: up, level, then down by a straight line."""
    up = min(1.0, (share + 1e-4) / config.warm_up) if config.warm_up else 1.0
    down = min(1.0, (1.0 - share) / config.fall) if config.fall else 1.0
    return config.learning_rate * min(up, down)


class Average:
    """Exponential moving average of weights and buffers, warmed up so that the start is forgotten."""

    def __init__(self, net: nn.Module, decay: float) -> None:
        self._decay, self.steps = decay, 0
        self.state = {name: value.detach().clone().float() for name, value in net.state_dict().items()}

    def update(self, net: nn.Module) -> None:
        self.steps += 1
        keep = min(self._decay, self.steps / (self.steps + 10))
        for name, value in net.state_dict().items():
            if value.is_floating_point():
                self.state[name].lerp_(value.detach(), 1.0 - keep)
            else:
                self.state[name].copy_(value)


class Run:
    """One training run: network, optimiser, average, and where it stands."""

    def __init__(self, config: Config, folder: Path) -> None:
        self.config, self.folder = config, folder
        self.device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
        torch.manual_seed(config.seed)
        self.net = build_net(config.shape).to(self.device, memory_format=torch.channels_last)
        if config.start:
            self.net.load_state_dict(_floats(torch.load(config.start, map_location=self.device)["settled"]))
        self.average = Average(self.net, config.ema)
        self.optimiser = _optimiser(self.net, config)
        self.weights = omega(config.omega_exponent).to(self.device)
        self.progress = Progress()

    def step(self, batch: Batch) -> float:
        share = self.progress.share(self.config)
        rate = learning_rate(self.config, share)
        for group in self.optimiser.param_groups:
            group["lr"] = rate
        loss_of = LOSSES["plain" if share > 1.0 - self.config.plain_share else self.config.loss]
        x = torch.from_numpy(batch.ink).to(self.device, memory_format=torch.channels_last)
        y = torch.from_numpy(batch.label).to(self.device)
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.config.bf16):
            logits = self.net(x)
        loss: Tensor = loss_of(logits.float(), y, self.weights)
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(self.net.parameters(), self.config.clip)
        self.optimiser.step()
        self.average.update(self.net)
        self.progress.images += len(batch.ink)
        self.progress.batches += 1
        return float(loss.detach())

    def settle(self, canvases: Source) -> nn.Module:
        """The averaged weights with normalisation statistics of their own.

        Statistics gathered during training lag behind weights that move fast: with Muon they cost 30 points of IoU.
        """
        net = build_net(self.config.shape).to(self.device, memory_format=torch.channels_last)
        net.load_state_dict(self.average.state)
        norms = [m for m in net.modules() if isinstance(m, nn.BatchNorm2d)]
        for norm in norms:
            norm.reset_running_stats()
            norm.momentum = None  # type: ignore[assignment]  # plain mean of all batches
        net.train()
        for k in range(SETTLING_BATCHES if norms else 0):
            ink = canvases.batch(SETTLING_FIRST + k * SETTLING_BATCH, SETTLING_BATCH, curved=self.config.curved).ink
            with torch.inference_mode():
                net(torch.from_numpy(ink).to(self.device, memory_format=torch.channels_last))
        return net.eval()

    def validate(self, net: nn.Module, sets: dict[str, list[Sample]]) -> dict[str, float]:
        """Pooled IoU on each set in percent, and the unweighted cross-entropy; kept in the history."""
        figures = {"images": float(self.progress.images), "seconds": self.progress.seconds}
        for name, samples in sets.items():
            confusion, losses = Confusion(), []
            for first in range(0, len(samples), 8):
                batch = stack(samples[first : first + 8])
                x = torch.from_numpy(batch.ink).to(self.device, memory_format=torch.channels_last)
                with torch.inference_mode(), torch.autocast(self.device.type, torch.bfloat16, enabled=self.config.bf16):
                    logits = net(x).float().cpu()
                confusion.add(logits.argmax(dim=1).numpy(), batch.label)
                losses.append(float(LOSSES["plain"](logits, torch.from_numpy(batch.label), self.weights)))
            figures[f"{name}_loss"] = sum(losses) / len(losses)
            figures |= {f"{name}_{label}": value for label, value in confusion.percent().items()}
        self.progress.history.append(figures)
        return figures

    def save(self, settled: nn.Module) -> None:
        """Checkpoint, written whole or not at all."""
        state = {
            "settled": settled.state_dict(),
            "net": self.net.state_dict(),
            "average": self.average.state,
            "average_steps": self.average.steps,
            "optimiser": self.optimiser.state_dict(),
            "progress": asdict(self.progress),
            "config": asdict(self.config),
        }
        self.folder.mkdir(parents=True, exist_ok=True)
        torch.save(state, self.folder / "checkpoint.pt.part")
        (self.folder / "checkpoint.pt.part").replace(self.folder / "checkpoint.pt")
        (self.folder / "config.json").write_text(json.dumps(asdict(self.config), indent=1) + "\n")
        (self.folder / "history.json").write_text(json.dumps(self.progress.history, indent=1) + "\n")

    def load(self) -> None:
        """Go on from the folder's checkpoint."""
        state = torch.load(self.folder / "checkpoint.pt", map_location=self.device)
        self.net.load_state_dict(state["net"])
        self.average.state, self.average.steps = state["average"], state["average_steps"]
        self.optimiser.load_state_dict(state["optimiser"])
        self.progress = Progress(**state["progress"])


def _optimiser(net: nn.Module, config: Config) -> torch.optim.Optimizer:
    parameters = list(net.parameters())
    if config.optimiser == "rmsprop":
        return torch.optim.RMSprop(parameters, lr=config.learning_rate, alpha=0.9)
    if config.optimiser == "muon":
        return Muon(parameters, config.learning_rate, weight_decay=config.weight_decay)
    return torch.optim.AdamW(parameters, lr=config.learning_rate, weight_decay=config.weight_decay)


def _floats(state: dict[str, Tensor]) -> dict[str, Tensor]:
    return {name: value.float() if value.is_floating_point() else value for name, value in state.items()}
