"""Net(k1, k2, d, r): sizes, and the promise that output and input have one size."""

import pytest
import torch

from training.network import MirrorUNet, Shape, build_net, legal_size_px, level_sizes, receptive_field_px

pytestmark = pytest.mark.training

NETS = {
    "7343": Shape(7, 3, 4, 3, (2, 3, 4, 5, 6)),
    "9342": Shape(9, 3, 4, 2, (2, 3, 4, 5, 6)),
    "9332": Shape(9, 3, 3, 2, (2, 3, 4, 5)),
    "9322": Shape(9, 3, 2, 2, (2, 3, 4)),
    "5521": Shape(5, 5, 2, 1, (2, 3, 4)),
}


def test_levels_of_the_papers_best_net() -> None:
    assert level_sizes(NETS["7343"], 221) == [211, 99, 43, 15, 1]


@pytest.mark.parametrize(
    ("net", "modulus", "rest", "least"),
    [("7343", 16, 13, 221), ("9342", 16, 1, 161), ("9332", 8, 1, 81), ("9322", 4, 1, 41)],
)
def test_legal_sizes(net: str, modulus: int, rest: int, least: int) -> None:
    legal = [size for size in range(30, 300) if level_sizes(NETS[net], size)]
    assert legal == list(range(least, 300, modulus))
    assert all(size % modulus == rest for size in legal)


def test_next_legal_size_is_the_smallest_that_fits() -> None:
    assert legal_size_px(NETS["7343"], 222) == 237


@pytest.mark.parametrize("net", NETS)
@pytest.mark.parametrize("batch_norm", [False, True])
def test_output_has_the_size_of_the_input(net: str, batch_norm: bool) -> None:
    shape = NETS[net]
    shape = Shape(shape.k1, shape.k2, shape.d, shape.r, shape.channels, batch_norm)
    size = legal_size_px(shape, 20)
    assert MirrorUNet(shape).eval()(torch.zeros(1, 1, size, size)).shape == (1, 3, size, size)


@pytest.mark.parametrize("net", ["9322", "5521"])
def test_an_output_pixel_sees_exactly_its_receptive_field(net: str) -> None:
    """Gradients of one output pixel reach as far as the arithmetic says, and no further."""
    shape = Shape(*[getattr(NETS[net], n) for n in ("k1", "k2", "d", "r", "channels")], batch_norm=False)
    size = legal_size_px(shape, 2 * receptive_field_px(shape))
    module = MirrorUNet(shape).double()
    for parameter in module.parameters():
        torch.nn.init.constant_(parameter, 0.1)
    middle = size // 2
    widest = 0
    for offset in range(2**shape.d):
        x = torch.rand(1, 1, size, size, dtype=torch.double, requires_grad=True)
        module(x)[0, 0, middle + offset, middle + offset].backward()
        seen = torch.nonzero(x.grad[0, 0].abs().sum(0) > 0).flatten()
        widest = max(widest, int(seen[-1] - seen[0]) + 1)
    assert widest == receptive_field_px(shape)


def test_channels_must_fit_the_depth() -> None:
    with pytest.raises(ValueError, match="5 channel widths"):
        Shape(7, 3, 4, 3, (8, 16))


def test_the_vanilla_net_keeps_sizes_too() -> None:
    shape = Shape(3, 3, 2, 2, (2, 3, 4), vanilla=True)
    assert legal_size_px(shape, 221) == 224
    assert build_net(shape).eval()(torch.zeros(1, 1, 28, 28)).shape == (1, 3, 28, 28)
