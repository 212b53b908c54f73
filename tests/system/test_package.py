"""The Debian package lives from its installation to its purge, and a wheel alone holds the same daemon.

Needs root and the packages mmdebstrap, systemd-container and lintian; without them these tests fail.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tarfile
import venv
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.system import package
from tests.system.debian_root import PROJECT, host_suite
from tests.systemd.test_wheels import wheels

pytestmark = pytest.mark.system

DOC = "usr/share/doc/linedrawd"
BOUND = "usr/lib/linedrawd/bound.tar.xz"


@pytest.fixture(scope="module")
def deb(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As the variable DEB names it, else made now, quickly."""
    return Path(os.environ.get("DEB") or package.build(tmp_path_factory.mktemp("dist"), suite=host_suite())).absolute()


@pytest.fixture(scope="module")
def files(deb: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """What the package holds, unpacked."""
    folder = tmp_path_factory.mktemp("files")
    subprocess.run(["dpkg-deb", "-x", deb, folder], check=True)
    yield folder
    shutil.rmtree(folder)


def test_from_the_installation_to_the_purge(deb: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with capsys.disabled():
        print()
        package.whole_life(deb, host_suite(), tmp_path, lambda words: print(f"  {words}", flush=True))


def test_lintian_finds_no_error(deb: Path) -> None:
    assert shutil.which("lintian"), "lintian is not installed: apt-get install lintian"
    said = subprocess.run(
        ["lintian", "--allow-root", "--fail-on", "error", deb], capture_output=True, text=True, check=False
    )
    assert said.returncode == 0, said.stdout


def test_nothing_dead_is_inside(files: Path) -> None:
    inside = {path: size for path, size in _inside(files).items() if wheels.is_dead(path.split("/")[0], path)}
    assert inside == {}
    assert not [path for path in _inside(files) if "libonnxruntime.so" in path or "libcrypto" in path]


def test_films_are_not_read_and_pictures_are(files: Path) -> None:
    """OpenCV loads with empty libraries in the place of FFmpeg's."""
    common = files / "usr/lib/linedrawd/common"
    empty = [path for path in (common / "opencv_python_headless.libs").iterdir() if path.stat().st_size < 1000]
    assert {path.name.split("-")[0] for path in empty} == {"libavcodec", "libavformat", "libavutil", "libswscale"}
    subprocess.run(["tar", "-xJf", files / BOUND, "--strip-components=1", "-C", common], check=True)
    code = f"import cv2; assert cv2.imread({str(PROJECT / 'tests/drawings/house.png')!r}).any(); print(cv2.__file__)"
    environment = {"PYTHONPATH": str(common), "LD_BIND_NOW": "1"}
    said = subprocess.run(
        ["/usr/bin/python3", "-B", "-c", code], env=environment, check=True, capture_output=True, text=True
    )
    assert said.stdout.startswith(str(common))


def test_each_part_is_listed_with_its_licence_and_its_text(files: Path) -> None:
    listed = json.loads((files / DOC / "sbom.cdx.json").read_text())["components"]
    metadata = {path.split("/")[0] for path in _inside(files) if path.endswith(".dist-info/METADATA")}
    kept = {folder.removesuffix(".dist-info").lower() for folder in metadata if not folder.startswith("linedrawd")}
    assert {"-".join(part["bom-ref"].split("-")[:2]).lower() for part in listed} == kept
    papers = (files / DOC / "copyright").read_text()
    for part in listed:
        assert part["licenses"][0]["expression"], part
        assert f"\nLicense: {part['name']}\n" in papers
        texts = list((files / DOC / "licenses" / part["name"]).iterdir())
        assert any(len(text.read_text(encoding="utf-8")) > 500 for text in texts), part


def _inside(files: Path) -> dict[str, int]:
    """The bytes of each file of the parts, by its path in a virtual environment."""
    common = files / "usr/lib/linedrawd/common"
    sizes = {str(path.relative_to(common)): path.stat().st_size for path in common.rglob("*") if path.is_file()}
    with tarfile.open(files / BOUND) as bound:
        return sizes | {member.name.partition("/")[2]: member.size for member in bound}


def test_a_wheel_on_its_own_installs_the_same_daemon(deb: Path, tmp_path: Path) -> None:
    venv.create(tmp_path / "venv", with_pip=True)
    python = tmp_path / "venv/bin/python"
    (wheel,) = deb.parent.glob("linedrawd-*.whl")
    pip = [python, "-m", "pip", "--disable-pip-version-check", "install", "-qq"]
    subprocess.run([*pip, "--constraint", PROJECT / "constraints.txt", wheel], check=True, timeout=600)
    picture = PROJECT / "tests/drawings/house.png"
    for program, out in (([tmp_path / "venv/bin/linedrawd"], "own"), ([sys.executable, "-m", "daemon.cli"], "sources")):
        folder = PROJECT if out == "sources" else tmp_path
        subprocess.run([*program, "plan", picture, "-o", tmp_path / out], check=True, cwd=folder, timeout=120)
    own, sources = (tmp_path / out / "house/program.gcode" for out in ("own", "sources"))
    assert own.read_bytes() == sources.read_bytes()
    draw = [tmp_path / "venv/bin/linedrawd", "draw", picture, "--device", "sim", "--state-dir", tmp_path / "state"]
    subprocess.run(draw, check=True, cwd=tmp_path, timeout=120)
