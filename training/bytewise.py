"""An int8 model that unfolds channels into pixels as bytes, not as floats: the same answers bit by bit, sooner.

python -m training.bytewise daemon/models/linedrawd.onnx
"""

from __future__ import annotations

import argparse
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from onnx import helper, numpy_helper


class Quantised:
    """The nodes and constants of a model of QuantizeLinear and DequantizeLinear pairs."""

    def __init__(self, graph: Any) -> None:
        self.nodes = [onnx.NodeProto.FromString(node.SerializeToString()) for node in graph.node]
        self.constants = {constant.name: constant for constant in graph.initializer}
        self.maker = {name: node for node in self.nodes for name in node.output}

    def takers(self, node: Any) -> list[Any]:
        return [other for other in self.nodes if node.output[0] in other.input]

    def taker(self, node: Any) -> Any:
        (only,) = self.takers(node)
        return only

    def turn(self, convolution: Any, order: Any) -> None:
        """The channels that the convolution gives in another order."""
        for name in convolution.input[1:]:
            for each in self.maker[name].input:
                values = numpy_helper.to_array(self.constants[each])[order]
                self.constants[each] = numpy_helper.from_array(np.ascontiguousarray(values), each)

    def replace(self, gone: Sequence[Any], new: Sequence[Any]) -> None:
        """The nodes `new` where the last of those was that go."""
        last = self.nodes.index(gone[-1])
        self.nodes[last : last + 1] = new
        for node in gone[:-1]:
            self.nodes.remove(node)

    def constant(self, name: str, values: Sequence[int]) -> str:
        self.constants[name] = numpy_helper.from_array(np.array(values, np.int64), name)
        return name


def in_bytes(model: onnx.ModelProto) -> onnx.ModelProto:
    """The model with the same answers: each DepthToSpace with its Slice works on bytes, four channels at a time.

    What follows a DepthToSpace works on each value by itself, so it can as well come before. The channels of the
    convolution are sorted by the pixel of 2 x 2 that they become: a pixel's channels stay together and are copied as
    one. ReLU becomes a LeakyReLU of slope 0, which onnxruntime looks up in a table of 256 bytes.
    """
    quantised = Quantised(model.graph)
    for node in [node for node in quantised.nodes if node.op_type == "DepthToSpace"]:
        _unfold(quantised, node)
    wanted = {name for node in quantised.nodes for name in node.input}
    constants = [constant for name, constant in quantised.constants.items() if name in wanted]
    sides = model.graph.input, model.graph.output
    proto = helper.make_graph(quantised.nodes, model.graph.name, *sides, constants)
    changed = helper.make_model(proto, opset_imports=model.opset_import, ir_version=model.ir_version)
    onnx.checker.check_model(changed)
    return changed


def _unfold(quantised: Quantised, node: Any) -> None:
    floats = quantised.maker[node.input[0]]
    given = quantised.maker[floats.input[0]]
    convolution = quantised.maker[given.input[0]]
    cut = quantised.taker(node)
    gone, before, levels, out = [floats, node, cut], [], floats.input[1:], cut.output[0]
    x = given.output[0]
    if quantised.takers(cut):
        relu = quantised.taker(cut)
        again = quantised.taker(relu)
        back = quantised.taker(again)
        gone += [relu, again, back]
        levels, out = back.input[1:], back.output[0]
        bare, x = f"{node.name}_bare", f"{node.name}_bytes"
        before = [
            helper.make_node("DequantizeLinear", floats.input, floats.output, name=floats.name),
            helper.make_node("LeakyRelu", floats.output, [bare], name=relu.name, alpha=0.0),
            helper.make_node("QuantizeLinear", [bare, *again.input[1:]], [x], name=again.name),
        ]
    channels = len(numpy_helper.to_array(quantised.constants[quantised.maker[convolution.input[2]].input[0]])) // 4
    quantised.turn(convolution, np.arange(4 * channels).reshape(channels, 4).T.ravel())
    moves = _moves(quantised, node.name, x, channels)
    after = helper.make_node("DequantizeLinear", [moves[-1].output[0], *levels], [out], name=f"{node.name}_floats")
    quantised.replace(gone, [*before, *moves, after])


def _moves(quantised: Quantised, name: str, x: str, channels: int) -> list[Any]:
    """(N, 4 C, H, W) to (N, C, 2 H - 1, 2 W - 1); a Reshape's 0 stands for the side as it was, -1 for the rest."""

    def sides(step: str, *values: int) -> str:
        return quantised.constant(f"{name}_{step}", values)

    steps: list[tuple[str, list[str], dict[str, Any]]] = [
        ("Transpose", [], {"perm": [0, 2, 3, 1]}),
        ("Reshape", [sides("blocks", 0, 0, 0, 2, 2 * channels)], {}),
        ("Transpose", [], {"perm": [0, 1, 3, 2, 4]}),
        ("Reshape", [sides("rows", 0, 0, 0, -1, channels)], {}),
        ("Reshape", [sides("page", 0, 1, -1, 0, channels)], {}),
        ("Squeeze", [sides("one", 1)], {}),
        ("Slice", [sides("first", 0, 0), sides("last", -1, -1), sides("axes", 1, 2)], {}),
        ("Transpose", [], {"perm": [0, 3, 1, 2]}),
    ]
    nodes = []
    for number, (kind, more, attributes) in enumerate(steps):
        made = f"{name}_{number}"
        nodes.append(helper.make_node(kind, [x, *more], [made], name=made, **attributes))
        x = made
    return nodes


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path, help="NAME.onnx, written anew, and NAME.json beside it its hash")
    path = parser.parse_args(arguments).model
    onnx.save(in_bytes(onnx.load(path)), path)
    manifest = json.loads(path.with_suffix(".json").read_text())
    manifest["sha256"] = hashlib.sha256(path.read_bytes()).hexdigest()
    path.with_suffix(".json").write_text(json.dumps(manifest, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
