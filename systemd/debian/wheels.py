"""The parts of the package: wheels fetched for the Python of a board, unpacked without what the daemon never loads."""

from __future__ import annotations

import hashlib
import re
import shutil
import subprocess
import sys
import zipfile
from dataclasses import dataclass
from email.message import Message
from email.parser import BytesParser
from fnmatch import fnmatch
from pathlib import Path

import elf

PLATFORMS = {"amd64": "x86_64", "arm64": "aarch64"}
_MANYLINUX = ("manylinux_2_28", "manylinux_2_27", "manylinux_2_17", "manylinux2014")
EXTRAS = ("gpio", "pdf")
"""What the package holds of the extras of linedrawd's wheel."""
DEAD = {
    # The same library once more: the module for Python has its own copy inside.
    "onnxruntime": (
        "onnxruntime/capi/libonnxruntime.so*",
        "onnxruntime/backend/*",
        "onnxruntime/datasets/*",
        "onnxruntime/quantization/*",
        "onnxruntime/tools/*",
        "onnxruntime/transformers/*",
    ),
    "numpy": (
        "numpy/*/tests/*",
        "numpy/tests/*",
        "numpy/_core/include/*",
        "numpy/_core/_simd.*",
        "numpy/_core/_*_tests.*",
        "numpy/distutils/*",
        "numpy/f2py/*",
        "numpy/*.a",
        "numpy/*.pyi",
    ),
    "pydantic_core": ("pydantic_core/*.pyi",),
    # Films are not read: FFmpeg, and what it wants.
    "opencv_python_headless": (
        "cv2/*.pyi",
        "*.libs/libcrypto-*",
        "*.libs/libdrm-*",
        "*.libs/libssl-*",
        "*.libs/libswresample-*",
        "*.libs/libvpx-*",
    ),
}
"""What is left out of a part: patterns of paths, in which * also stands for /."""
EMPTY = ("*.libs/libavcodec-*", "*.libs/libavformat-*", "*.libs/libavutil-*", "*.libs/libswscale-*")
"""Libraries that OpenCV wants to be there, and of which nothing is ever called."""
UNCALLED = ("av_", "avcodec_", "avformat_", "avio_", "avutil_", "sws_", "swscale_")
"""How the names of their functions begin."""
_LICENCE = ("*licen[cs]e*", "*copying*", "*notice*", "*authors*")


@dataclass(frozen=True, slots=True)
class Part:
    """A wheel as it is packed. python: the only one that it is for. sha256: of the wheel as it came.

    common, bound, left_out: bytes that every Python and that one Python loads, and that are not packed.
    about: its METADATA. licences: texts by their paths.
    """

    wheel: str
    sha256: str
    python: str | None
    common: int
    bound: int
    left_out: int
    tops: frozenset[str]
    about: Message
    licences: dict[str, bytes]

    @property
    def name(self) -> str:
        return str(self.about["Name"])

    @property
    def version(self) -> str:
        return str(self.about["Version"])


def own_wheel(root: Path, folder: Path) -> Path:
    """Build linedrawd's wheel from a copy of the sources alone, so that nothing of an older build gets into it."""
    sources = folder / "sources"
    shutil.rmtree(sources, ignore_errors=True)
    for name in ("daemon", "firmware_protocol"):
        shutil.copytree(root / name, sources / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(root / name, sources)
    for old in folder.glob("linedrawd-*.whl"):
        old.unlink()
    _pip("wheel", "--no-deps", "--wheel-dir", str(folder), str(sources))
    return next(folder.glob("linedrawd-*.whl"))


def fetch(own: Path, arch: str, python: str, pins: Path, folder: Path) -> list[Path]:
    """Download all that linedrawd's wheel needs on this architecture and Python, as pinned. arch: as Debian says it."""
    folder.mkdir(parents=True, exist_ok=True)
    platforms = [f"--platform={tag}_{PLATFORMS[arch]}" for tag in _MANYLINUX]
    abis = [f"--abi={abi}" for abi in (f"cp{python.replace('.', '')}", "abi3", "none")]
    _pip(
        "download", "--only-binary=:all:", "--implementation=cp", f"--python-version={python}", *abis, *platforms,
        "--constraint", str(pins), "--dest", str(folder), f"{own}[{','.join(EXTRAS)}]",
    )  # fmt: skip
    return sorted(path for path in folder.glob("*.whl") if path.name != own.name)


def python_of(wheel: str) -> str | None:
    """The Python that a wheel is bound to by its name; None for one that serves several."""
    bound = re.search(r"-cp3(\d+)-cp3\1-", wheel)
    return f"3.{bound[1]}" if bound else None


def unpack(wheel: Path, folder: Path) -> Part:
    """Write what a board loads of the wheel below folder: into `common`, or into `python3.N` where it is bound to it.

    The libraries beside a bound wheel have their content's mark in their names, and are common to all.
    """
    python, name = python_of(wheel.name), wheel.name.split("-")[0]
    sizes, tops, licences, about = {True: 0, False: 0}, set[str](), dict[str, bytes](), Message()
    with zipfile.ZipFile(wheel) as given:
        entries = [entry for entry in given.infolist() if not entry.is_dir()]
        for path, content in ((entry.filename, given.read(entry)) for entry in entries):
            if is_licence(path):
                licences[path] = content
            elif not is_dead(name, path):
                is_bound = python is not None and ".libs/" not in path
                lean = leaner(path, content)
                _write(folder / (f"python{python}" if is_bound else "common") / path, lean)
                sizes[is_bound] += len(lean)
                tops.add(path.split("/")[0])
            if path.endswith(".dist-info/METADATA"):
                about = BytesParser().parsebytes(content)
        left_out = sum(entry.file_size for entry in entries) - sum(sizes.values())
    digest = hashlib.sha256(wheel.read_bytes()).hexdigest()
    return Part(wheel.name, digest, python, sizes[False], sizes[True], left_out, frozenset(tops), about, licences)


def is_dead(name: str, path: str) -> bool:
    """Also the list of what is in the wheel, which nobody reads: files are left out, and dpkg has sums of its own."""
    return path.endswith(".dist-info/RECORD") or any(fnmatch(path, pattern) for pattern in DEAD.get(name, ()))


def leaner(path: str, content: bytes) -> bytes:
    """The file as it is packed."""
    if any(fnmatch(path, pattern) for pattern in EMPTY):
        return elf.empty(content)
    return elf.without(content, UNCALLED) if fnmatch(path, "cv2/cv2.*.so") else content


def is_licence(path: str) -> bool:
    """A text of a licence: in the folder of the metadata for them, beside the metadata, or at the top of a part."""
    folder, _, name = path.rpartition("/")
    if ".dist-info/licenses/" in path:
        return True
    in_metadata = ".dist-info" in folder and not path.endswith((".json", ".py"))
    at_top = folder != "" and "/" not in folder and path.endswith((".txt", "LICENSE"))
    return bool(name) and (in_metadata or at_top) and any(fnmatch(name.lower(), pattern) for pattern in _LICENCE)


def _write(place: Path, content: bytes) -> None:
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_bytes(content)


def _pip(*words: str) -> None:
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "-qq"]
    subprocess.run([*pip, *words], check=True, timeout=1800)
