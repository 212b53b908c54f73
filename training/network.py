"""Net(k1, k2, d, r): the mirror U-Net of Raghav et al. 2020, Sec. 3.1, and the arithmetic of its sizes.

Going down, valid convolutions: k1 x k1 first, then r - 1 of k2 x k2, and at each of the d levels below a strided one
followed by r more. Going up, the mirror image by valid transposed convolutions. Every skip connection meets its partner
at exactly its own size: nothing is cropped and nothing is padded. The paper has no normalisation; BatchNorm after every
convolution is ours (it folds away at export).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn import functional

CLASSES = ("background", "lines", "corners")
STRIDE = 2


@dataclass(frozen=True, slots=True)
class Shape:
    """The tuple of the paper and what it leaves open: channels of each level (d + 1 of them) and normalisation."""

    k1: int = 7
    k2: int = 3
    d: int = 4
    r: int = 3
    channels: tuple[int, ...] = (8, 16, 32, 64, 128)
    batch_norm: bool = True
    vanilla: bool = False

    def __post_init__(self) -> None:
        if len(self.channels) != self.d + 1:
            raise ValueError(f"{self.d} levels below the first need {self.d + 1} channel widths, not {self.channels}")


def build_net(shape: Shape) -> nn.Module:
    """The network of a shape, untrained: weights as Ronneberger et al. 2015 (Sec. 3) begin, N(0, 2 / fan-in)."""
    net = VanillaUNet(shape) if shape.vanilla else MirrorUNet(shape)
    for module in net.modules():
        if isinstance(module, nn.Conv2d | nn.ConvTranspose2d):
            inputs = module.in_channels * module.kernel_size[0] * module.kernel_size[1]
            if isinstance(module, nn.ConvTranspose2d):
                inputs //= module.stride[0] * module.stride[1]
            nn.init.normal_(module.weight, std=(2.0 / inputs) ** 0.5)
            if module.bias is not None:
                nn.init.zeros_(module.bias)
    return net


def level_sizes(shape: Shape, size_px: int) -> list[int] | None:
    """Side of the maps at each level for a square input of side `size_px`; None where the sizes do not work out.

    They do if and only if every (n - k2) is even and every level is left with at least one pixel; a vanilla net takes
    what its poolings divide evenly.
    """
    if shape.vanilla:
        return None if size_px % STRIDE**shape.d else [size_px // STRIDE**level for level in range(shape.d + 1)]
    sizes = [size_px - (shape.k1 - 1) - (shape.r - 1) * (shape.k2 - 1)]
    for _ in range(shape.d):
        if (sizes[-1] - shape.k2) % STRIDE:
            return None
        sizes.append((sizes[-1] - shape.k2) // STRIDE + 1 - shape.r * (shape.k2 - 1))
    return sizes if min(sizes) >= 1 else None


def legal_size_px(shape: Shape, at_least_px: int) -> int:
    """The smallest input side >= at_least_px for which output and input have one size."""
    size_px = at_least_px
    while level_sizes(shape, size_px) is None:
        size_px += 1
    return size_px


def receptive_field_px(shape: Shape) -> int:
    """Side of the square of input pixels that an output pixel can see."""
    reach, step = (shape.k1 - 1) + (shape.r - 1) * (shape.k2 - 1), 1
    for _ in range(shape.d):
        reach += step * (shape.k2 - 1)
        step *= STRIDE
        reach += step * shape.r * (shape.k2 - 1)
    # The way up mirrors the way down: what a bottom cell spreads over is as wide again.
    return 2 * reach + 1


def blocks(kind: type[nn.Module], widths: Sequence[int], kernels: Sequence[int], batch_norm: bool) -> nn.Sequential:
    """Convolutions of one level, each with normalisation and ReLU."""
    layers: list[nn.Module] = []
    for before, after, kernel in zip(widths[:-1], widths[1:], kernels, strict=True):
        layers += unit(kind(before, after, kernel, bias=not batch_norm), after, batch_norm)
    return nn.Sequential(*layers)


def unit(convolution: nn.Module, channels: int, batch_norm: bool) -> Iterator[nn.Module]:
    yield convolution
    if batch_norm:
        yield nn.BatchNorm2d(channels, momentum=0.02)
    yield nn.ReLU(inplace=True)


class MirrorUNet(nn.Module):
    """float32 (N, 1, H, W), ink 1 and paper 0, to logits (N, 3, H, W): background, lines, corners. H, W legal sizes."""

    def __init__(self, shape: Shape) -> None:
        super().__init__()
        self.shape = shape
        c, r, k2, norm = shape.channels, shape.r, shape.k2, shape.batch_norm
        conv, up = nn.Conv2d, nn.ConvTranspose2d
        self.first = blocks(conv, [1] + [c[0]] * r, [shape.k1] + [k2] * (r - 1), norm)
        self.down, self.levels = nn.ModuleList(), nn.ModuleList()
        self.up, self.mirrors = nn.ModuleList(), nn.ModuleList()
        for above, below in pairwise(c):
            self.down.append(nn.Sequential(*unit(conv(above, below, k2, stride=STRIDE, bias=not norm), below, norm)))
            self.levels.append(blocks(conv, [below] * (r + 1), [k2] * r, norm))
            self.up.append(nn.Sequential(*unit(up(below, above, k2, stride=STRIDE, bias=not norm), above, norm)))
        for level, width in enumerate(c[1:], start=1):
            entering = width if level == shape.d else 2 * width
            self.mirrors.append(blocks(up, [entering] + [width] * r, [k2] * r, norm))
        self.last = blocks(up, [2 * c[0]] + [c[0]] * (r - 1), [k2] * (r - 1), norm)
        self.logits = up(c[0] if r > 1 else 2 * c[0], len(CLASSES), shape.k1)

    def forward(self, x: Tensor) -> Tensor:
        x = self.first(x)
        skips = [x]
        for down, level in zip(self.down, self.levels, strict=True):
            x = level(down(x))
            skips.append(x)
        x = skips.pop()
        for up, mirror in zip(reversed(self.up), reversed(self.mirrors), strict=True):
            x = up(mirror(x))
            x = torch.cat([skips.pop(), x], dim=1)
        logits: Tensor = self.logits(self.last(x))
        return logits


class VanillaUNet(nn.Module):
    """The U-Net of Ronneberger et al. 2015 as the paper compares it, its (3 3 4 2): float32 in and out as MirrorUNet.

    Padded convolutions, 2 x 2 max pooling, 2 x 2 up-convolutions. Sides must be multiples of 2 ** d.
    """

    def __init__(self, shape: Shape) -> None:
        super().__init__()
        self.shape = shape
        c, norm = shape.channels, shape.batch_norm
        self.levels, self.up, self.mirrors = nn.ModuleList(), nn.ModuleList(), nn.ModuleList()
        for level, (before, width) in enumerate(pairwise((1, *c))):
            kernels = [shape.k1 if level == 0 else shape.k2, *[shape.k2] * (shape.r - 1)]
            self.levels.append(blocks(Padded, [before] + [width] * shape.r, kernels, norm))
        for above, below in pairwise(c):
            self.up.append(nn.ConvTranspose2d(below, above, STRIDE, stride=STRIDE))
            self.mirrors.append(blocks(Padded, [2 * above] + [above] * shape.r, [shape.k2] * shape.r, norm))
        self.logits = nn.Conv2d(c[0], len(CLASSES), 1)

    def forward(self, x: Tensor) -> Tensor:
        skips = []
        for level in self.levels:
            x = level(functional.max_pool2d(x, STRIDE) if skips else x)
            skips.append(x)
        x = skips.pop()
        for up, mirror in zip(reversed(self.up), reversed(self.mirrors), strict=True):
            x = mirror(torch.cat([skips.pop(), up(x)], dim=1))
        logits: Tensor = self.logits(x)
        return logits


class Padded(nn.Conv2d):
    """A convolution whose output has the size of its input."""

    def __init__(self, before: int, after: int, kernel: int, *, bias: bool = True) -> None:
        super().__init__(before, after, kernel, padding=kernel // 2, bias=bias)
