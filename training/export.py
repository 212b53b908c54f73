"""From a checkpoint to the file the board runs: `python -m training.export RUN --data ... -o daemon/models/NAME`.

BatchNorm is folded into the kernels and every transposed convolution is rewritten as a plain one (exact): the quantiser
of onnxruntime's CPU provider knows only those. Then int8, QDQ, per channel, reduce_range (so that one file serves
processors with and without 8-bit dot products), calibrated on rendered training pages.
"""

from __future__ import annotations

import os

os.environ["ORT_DISABLE_TELEMETRY"] = "1"

import argparse
import hashlib
import json
import logging
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper
from onnxruntime.quantization import CalibrationDataReader, QuantFormat, QuantType, quantize_static
from onnxruntime.quantization.shape_inference import quant_pre_process
from torch import nn

from training import quickdraw
from training.bytewise import in_bytes
from training.canvas import Canvases
from training.measure import CLASSES
from training.network import MirrorUNet, Shape, legal_size_px, level_sizes
from training.render import CANVAS_PX

OPSET = 18
CALIBRATION_PAGES = 48
Array = NDArray[np.float32]


class Graph:
    """An ONNX graph under construction: each call appends a node and returns the name of its output."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.constants: list[Any] = []

    def node(self, kind: str, inputs: Sequence[str], **attributes: Any) -> str:
        name = f"{kind.lower()}_{len(self.nodes)}"
        self.nodes.append(helper.make_node(kind, list(inputs), [name], name=name, **attributes))
        return name

    def constant(self, value: NDArray[Any]) -> str:
        name = f"constant_{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(np.ascontiguousarray(value), name))
        return name

    def conv(self, x: str, kernel: Array, bias: Array, *, pads: Sequence[int] = (0, 0, 0, 0), stride: int = 1) -> str:
        inputs = [x, self.constant(kernel), self.constant(bias)]
        return self.node("Conv", inputs, pads=pads, strides=[stride] * 2, kernel_shape=kernel.shape[2:])

    def layer(self, x: str, convolution: nn.Module, norm: nn.Module | None) -> str:
        """One convolution of either kind, its normalisation folded in."""
        kernel, bias = folded(convolution, norm)
        if isinstance(convolution, nn.Conv2d):
            return self.conv(x, kernel, bias, stride=convolution.stride[0])
        assert isinstance(convolution, nn.ConvTranspose2d)
        if convolution.stride[0] == 1:
            return self.conv(x, kernel[:, :, ::-1, ::-1], bias, pads=[kernel.shape[2] - 1] * 4)
        return self.unfolded(self.conv(x, spread(kernel), np.repeat(bias, 4), pads=[1] * 4))

    def blocks_of_four(self, x: str, convolution: nn.ConvTranspose2d) -> str:
        """A stride-1 transposed convolution to few channels, whose answer has odd sides.

        Four neighbours are computed as the channels of one: matrix products three columns wide leave vector units idle.
        """
        kernel, bias = folded(convolution, None)
        wide, side = four_at_once(kernel[:, :, ::-1, ::-1]), kernel.shape[2]
        x = self.conv(x, wide, np.repeat(bias, 4), pads=[side - 1, side - 1, side, side], stride=2)
        return self.unfolded(x)

    def unfolded(self, x: str) -> str:
        """Four channels become a block of 2 x 2 px; the last row and column are one too many."""
        x = self.node("DepthToSpace", [x], blocksize=2, mode="CRD")
        ends = [self.constant(np.array(v, np.int64)) for v in ([0, 0], [-1, -1], [2, 3])]
        return self.node("Slice", [x, *ends])

    def sequence(self, x: str, layers: Sequence[nn.Module]) -> str:
        """Convolutions with their normalisation and ReLU, as training/network.py builds them."""
        for convolution, follower in zip(layers, [*layers[1:], None], strict=True):
            if isinstance(convolution, nn.Conv2d | nn.ConvTranspose2d):
                norm = follower if isinstance(follower, nn.BatchNorm2d) else None
                x = self.node("Relu", [self.layer(x, convolution, norm)])
        return x


def folded(convolution: Any, norm: Any) -> tuple[Array, Array]:
    """Kernel (out, in, k, k) and bias (out,) of convolution and normalisation together."""
    transposed = isinstance(convolution, nn.ConvTranspose2d)
    kernel = convolution.weight.detach().double()
    kernel = kernel.transpose(0, 1) if transposed else kernel
    bias = torch.zeros(kernel.size(0)).double() if convolution.bias is None else convolution.bias.detach().double()
    if norm is not None:
        scale = norm.weight.detach().double() / torch.sqrt(norm.running_var.double() + norm.eps)
        kernel, bias = (
            kernel * scale.view(-1, 1, 1, 1),
            (bias - norm.running_mean.double()) * scale + norm.bias.detach(),
        )
    return kernel.float().numpy(), bias.float().numpy()


def spread(kernel: Array) -> Array:
    """A stride-2 transposed 3 x 3 kernel as a 2 x 2 one to four times the channels (depth to space, CRD order).

    y[2j] = x[j] w[0] + x[j-1] w[2] and y[2j+1] = x[j] w[1], in each direction.
    """
    taps = np.zeros((2, 2, 3), np.float32)  # (phase, tap of the 2-kernel, tap of the 3-kernel)
    taps[0, 0, 2] = taps[0, 1, 0] = taps[1, 1, 1] = 1.0
    wide = np.einsum("pas,qbt,oist->opqiab", taps, taps, kernel)
    return wide.reshape(-1, *wide.shape[3:])


def four_at_once(kernel: Array) -> Array:
    """A stride-1 kernel (out, in, k, k) as a stride-2 one (4 out, in, k + 1, k + 1): an answer for each px of 2 x 2."""
    out, entering, side, _ = kernel.shape
    wide = np.zeros((out, 2, 2, entering, side + 1, side + 1), np.float32)
    for row, column in np.ndindex(2, 2):
        wide[:, row, column, :, row : row + side, column : column + side] = kernel
    return wide.reshape(4 * out, *wide.shape[3:])


def build(net: MirrorUNet) -> onnx.ModelProto:
    """The all-convolution float model. ink (N, 1, H, W) -> logits (N, 3, H, W), float32."""
    net.eval()
    graph = Graph()
    x = graph.sequence("ink", list(net.first))
    skips = [x]
    for down, level in zip(net.down, net.levels, strict=True):
        x = graph.sequence(graph.sequence(x, list(down)), list(level))
        skips.append(x)
    x = skips.pop()
    for up, mirror in zip(reversed(net.up), reversed(net.mirrors), strict=True):
        x = graph.sequence(graph.sequence(x, list(mirror)), list(up))
        x = graph.node("Concat", [skips.pop(), x], axis=1)
    x = graph.sequence(x, list(net.last))
    if legal_size_px(net.shape, CANVAS_PX) % 2:
        graph.blocks_of_four(x, net.logits)
    else:
        graph.layer(x, net.logits, None)
    graph.nodes[-1].output[0] = "logits"
    sides = [
        helper.make_tensor_value_info(n, TensorProto.FLOAT, ["pages", c, "height", "width"])
        for n, c in (("ink", 1), ("logits", 3))
    ]
    proto = helper.make_graph(graph.nodes, "mirror_unet", sides[:1], sides[1:], graph.constants)
    model = helper.make_model(proto, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=10)
    onnx.checker.check_model(model)
    return model


class Pages(CalibrationDataReader):  # type: ignore[misc]
    """Calibration pages, one at a time, from training rows."""

    def __init__(self, canvases: Canvases, count: int, curved: float) -> None:
        self._batches = iter([canvases.batch(k, 1, curved=curved).ink for k in range(count)])

    def get_next(self) -> dict[str, Array] | None:
        ink = next(self._batches, None)
        return None if ink is None else {"ink": ink}


def quantise(model: onnx.ModelProto, pages: CalibrationDataReader, path: Path) -> None:
    """Write the int8 model to path.

    The first convolution stays in float: it sees one channel, costs no less in int8, and a step of its 7-bit kernels
    shows at every line's edge. Ranges are averaged over the pages: the one loudest page of all makes steps coarse.
    """
    logging.getLogger().setLevel(logging.ERROR)
    with tempfile.TemporaryDirectory() as folder:
        plain, prepared = Path(folder, "float.onnx"), Path(folder, "prepared.onnx")
        onnx.save(model, plain)
        quant_pre_process(str(plain), str(prepared), skip_symbolic_shape=True)
        quantize_static(
            str(prepared), str(path), pages, quant_format=QuantFormat.QDQ, per_channel=True, reduce_range=True,
            activation_type=QuantType.QUInt8, weight_type=QuantType.QInt8,
            nodes_to_exclude=[model.graph.node[0].name], extra_options={"CalibMovingAverage": True},
        )  # fmt: skip
    onnx.save(in_bytes(onnx.load(path)), path)


def shape_of(config: dict[str, Any]) -> Shape:
    """The shape that a checkpoint's configuration holds."""
    return Shape(**(config["shape"] | {"channels": tuple(config["shape"]["channels"])}))


def load(checkpoint: Path) -> MirrorUNet:
    """The settled weights of a checkpoint. Raises FileNotFoundError, or RuntimeError when they do not fit."""
    state = torch.load(checkpoint, map_location="cpu")
    net = MirrorUNet(shape_of(state["config"]))
    net.load_state_dict({k: v.float() if v.is_floating_point() else v for k, v in state["settled"].items()})
    return net.eval()


def save_weights(path: Path, checkpoint: Path) -> None:
    """What a run can start from and nothing else, in half precision: a sixth of a checkpoint."""
    state = torch.load(checkpoint, map_location="cpu")
    settled = {k: v.half() if v.is_floating_point() else v for k, v in state["settled"].items()}
    torch.save({"settled": settled, "config": state["config"], "progress": state["progress"]}, path)


def write_manifest(model: Path, checkpoint: Path, *, seen_before: int = 0) -> None:
    """NAME.json beside NAME.onnx: what the file is. training.evaluate --manifest adds how good it is."""
    state = torch.load(checkpoint, map_location="cpu")
    config, progress = state["config"], state["progress"]
    shape = shape_of(config)
    manifest = {
        "file": model.name,
        "sha256": hashlib.sha256(model.read_bytes()).hexdigest(),
        "input": "ink: float32 (pages, 1, height, width), ink 1, paper 0",
        "output": "logits: float32 (pages, 3, height, width)",
        "labels": list(CLASSES),
        "tile_px": CANVAS_PX,
        "legal_sizes_px": [size for size in range(CANVAS_PX, 400) if level_sizes(shape, size)],
        "net": asdict(shape),
        "run": {k: v for k, v in config.items() if k not in ("shape", "data", "raw", "start")},
        "trained": {
            "images": seen_before + progress["images"],
            "last_run": {"images": progress["images"], "seconds": round(progress["seconds"])},
        },
        "data": "Quick, Draw! (Google), simplified and raw drawings",
        "data_licence": "CC BY 4.0",
        "figures": {},
    }
    model.with_suffix(".json").write_text(json.dumps(manifest, indent=1) + "\n")


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", type=Path)
    parser.add_argument("--data", type=Path, required=True, help="simplified training rows, for calibration")
    parser.add_argument("--raw", type=Path, help="raw training rows, for calibration")
    parser.add_argument(
        "-o", "--out", type=Path, required=True, help="the int8 file; the float one lies beside it with --float"
    )
    parser.add_argument("--float", action="store_true", help="keep the float model too")
    parser.add_argument("--weights", type=Path, help="also write the bare weights, from which --start goes on")
    parser.add_argument("--seen-before", type=int, default=0, help="canvases that the weights of --start had seen")
    given = parser.parse_args(arguments)
    model = build(load(given.checkpoint))
    if given.float:
        onnx.save(model, given.out.with_suffix(".float.onnx"))
    simplified = quickdraw.read([given.data], limit=2000)
    raw = quickdraw.read([given.raw], limit=2000) if given.raw else None
    pages = Pages(Canvases(simplified, raw, seed=7), CALIBRATION_PAGES, 0.5 if raw else 0.0)
    quantise(model, pages, given.out)
    write_manifest(given.out, given.checkpoint, seen_before=given.seen_before)
    if given.weights:
        save_weights(given.weights, given.checkpoint)
    print(f"{given.out}: {given.out.stat().st_size / 1e6:.2f} MB")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
