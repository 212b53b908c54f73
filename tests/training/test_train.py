"""A tiny network learns, goes on where it was stopped, and becomes a file that answers the same."""

import itertools
import json
import os
from pathlib import Path

import numpy as np
import onnx
import pytest
import torch

os.environ["ORT_DISABLE_TELEMETRY"] = "1"
import onnxruntime

from training import export, quickdraw, train
from training.bytewise import in_bytes
from training.canvas import Canvases, stack
from training.feed import feed, place_of
from training.network import MirrorUNet, Shape
from training.render import CANVAS_PX
from training.run import Config

pytestmark = [pytest.mark.training, pytest.mark.filterwarnings("ignore")]

TINY = [
    "--net",
    "9,3,2,2",
    "--channels",
    "8,12,16",
    "--threads",
    "1",
    "--wide-every",
    "0",
    "--no-bf16",
    "--validation",
    "16",
]


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Zigzags of our own, as many as the validation set takes and some to learn from."""
    random = np.random.default_rng(3)
    path = tmp_path_factory.mktemp("data") / "zigzags.ndjson"
    with path.open("w") as file:
        for _ in range(train.HELD_OUT + 200):
            strokes = [random.integers(0, 256, (2, random.integers(2, 6))).tolist() for _ in range(2)]
            file.write(json.dumps({"word": "zigzag", "drawing": strokes}) + "\n")
    return path


def run(data: Path, out: Path, *more: str) -> list[dict[str, float]]:
    assert train.main(["--data", str(data), "--out", str(out), *TINY, *more]) == 0
    history: list[dict[str, float]] = json.loads((out / "history.json").read_text())
    return history


def test_learning_finds_corners(data: Path, tmp_path: Path) -> None:
    """Seconds are enough for a small net to leave the floor (an untrained one stays below 5 %)."""
    before = run(data, tmp_path / "a", "--images", "4")[-1]
    after = run(data, tmp_path / "b", "--images", "480", "--optimiser", "muon", "--learning-rate", "0.02")[-1]
    assert after["paper_corners"] > 30.0 > before["paper_corners"]
    assert after["paper_mean"] > before["paper_mean"] + 20.0


def test_a_stopped_run_goes_on_as_if_it_had_not_been(data: Path, tmp_path: Path) -> None:
    """Same weights, bit for bit, on one thread."""
    rate = ["--warm-up", "0", "--fall", "0", "--plain-share", "0"]
    run(data, tmp_path / "whole", "--images", "16", *rate)
    run(data, tmp_path / "parts", "--images", "8", *rate)
    run(data, tmp_path / "parts", "--images", "16", "--resume", *rate)
    whole, parts = (torch.load(tmp_path / name / "checkpoint.pt")["net"] for name in ("whole", "parts"))
    assert all(torch.equal(whole[key], parts[key]) for key in whole)


def test_batches_made_ahead_by_other_processes_are_the_same(data: Path) -> None:
    sketches = quickdraw.read([data], limit=50)
    canvases, config = Canvases(sketches, None, seed=3), Config(data="", batch=3, wide_every=2, wide_px=237, curved=0.3)
    here, ahead = (feed(config, canvases, begin=1, workers=workers) for workers in (0, 2))
    for ours, theirs in itertools.islice(zip(here, ahead, strict=True), 4):
        assert np.array_equal(ours.ink, theirs.ink)
        assert np.array_equal(ours.label, theirs.label)


def test_batches_follow_each_other_without_gap_or_overlap() -> None:
    config = Config(data="", batch=4, wide_every=3)
    places = [place_of(config, number) for number in range(10)]
    assert [first for first, _, _ in places] == [0, *itertools.accumulate(count for _, count, _ in places[:-1])]
    assert [number for number, (_, _, side_px) in enumerate(places) if side_px] == [2, 5, 8]


def test_a_run_stops_in_time_and_goes_on(data: Path, tmp_path: Path) -> None:
    run(data, tmp_path, "--images", "100000", "--stop-after-s", "0")
    assert run(data, tmp_path, "--images", "4", "--resume")[-1]["images"] >= 4
    assert (tmp_path / "curves.png").stat().st_size > 1000


@pytest.mark.parametrize("batch_norm", [False, True])
def test_the_exported_graph_answers_like_the_network(batch_norm: bool) -> None:
    """The rewrite of transposed convolutions and the folding of normalisation are exact."""
    torch.manual_seed(5)
    net = MirrorUNet(Shape(7, 3, 2, 2, (5, 6, 7), batch_norm))
    for module in net.modules():
        if isinstance(module, torch.nn.BatchNorm2d):
            module.running_mean.normal_()
            module.running_var.uniform_(0.5, 2.0)
            torch.nn.init.normal_(module.weight)
    ink = torch.rand(2, 1, 79, 79)
    with torch.inference_mode():
        expected = net.eval()(ink).numpy()
    session = onnxruntime.InferenceSession(export.build(net).SerializeToString())
    (answer,) = session.run(None, {"ink": ink.numpy()})
    assert np.abs(answer - expected).max() <= 1e-4


def test_the_int8_file_agrees_with_the_float_network(data: Path, tmp_path: Path) -> None:
    run(data, tmp_path / "run", "--images", "160", "--optimiser", "muon", "--learning-rate", "0.02")
    checkpoint, model = tmp_path / "run" / "checkpoint.pt", tmp_path / "small.onnx"
    assert export.main([str(checkpoint), "--data", str(data), "-o", str(model)]) == 0
    manifest = json.loads(model.with_suffix(".json").read_text())
    assert manifest["labels"] == ["background", "lines", "corners"]
    ink = train.validation_sets(train.parse(["--data", str(data), "--out", "x", "--validation", "8"])[0])["paper"]
    batch = stack(ink).ink
    (said,) = onnxruntime.InferenceSession(str(model)).run(None, {"ink": batch})
    with torch.inference_mode():
        expected = export.load(checkpoint)(torch.from_numpy(batch)).numpy()
    assert (said.argmax(1) == expected.argmax(1)).mean() > 0.995


def test_unfolding_bytes_changes_no_answer(data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    torch.manual_seed(5)
    net = MirrorUNet(Shape(9, 3, 2, 2, (8, 12, 16), True)).eval()
    canvases = Canvases(quickdraw.read([data], limit=50), None, seed=7)
    plain, packed = tmp_path / "plain.onnx", tmp_path / "packed.onnx"
    with monkeypatch.context() as as_it_was:
        as_it_was.setattr(export, "in_bytes", lambda model: model)
        export.quantise(export.build(net), export.Pages(canvases, 2, 0.0), plain)
    onnx.save(in_bytes(onnx.load(plain)), packed)
    ink = np.random.default_rng(5).random((2, 1, CANVAS_PX, CANVAS_PX), np.float32)
    answers = [onnxruntime.InferenceSession(str(path)).run(None, {"ink": ink})[0] for path in (plain, packed)]
    assert (answers[0] == answers[1]).all()
    assert np.ptp(answers[0]) > 0
