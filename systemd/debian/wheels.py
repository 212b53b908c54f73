"""The wheels of the package: fetched for the Python of a board, without what the daemon never loads."""

from __future__ import annotations

import base64
import csv
import hashlib
import io
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from email.message import Message
from email.parser import BytesParser
from fnmatch import fnmatch
from pathlib import Path

PLATFORMS = {"amd64": "x86_64", "arm64": "aarch64"}
_MANYLINUX = ("manylinux_2_28", "manylinux_2_27", "manylinux_2_17", "manylinux2014")
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
    "opencv_python_headless": ("cv2/*.pyi",),
}
"""What is left out of a part: patterns of paths, in which * also stands for /."""
_LICENCE = ("*licen[cs]e*", "*copying*", "*notice*", "*authors*")


@dataclass(frozen=True, slots=True)
class Part:
    """A wheel as it is packed. sha256: of the wheel as it came. unpacked, left_out: bytes. about: its METADATA."""

    path: Path
    sha256: str
    unpacked: int
    left_out: int
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
        "--constraint", str(pins), "--dest", str(folder), str(own),
    )  # fmt: skip
    return sorted(path for path in folder.glob("*.whl") if path.name != own.name)


def repack(wheel: Path, folder: Path, *, small: bool) -> Part:
    """Write the wheel anew into the folder, without its dead weight and with a RECORD that says so.

    small: squeezed with LZMA, which pip reads as well; takes minutes for all of them.
    """
    target = folder / wheel.name
    dead = DEAD.get(wheel.name.split("-")[0], ())
    unpacked, licences, about = 0, dict[str, bytes](), Message()
    method = zipfile.ZIP_LZMA if small else zipfile.ZIP_DEFLATED
    with (
        zipfile.ZipFile(wheel) as given,
        zipfile.ZipFile(target.with_suffix(".part"), "w", method, compresslevel=1) as packed,
    ):
        given_size = sum(entry.file_size for entry in given.infolist())
        kept = [entry for entry in given.infolist() if not any(fnmatch(entry.filename, pattern) for pattern in dead)]
        for entry in kept:
            content = given.read(entry)
            if entry.filename.endswith(".dist-info/RECORD"):
                content = record(content, {other.filename for other in kept})
            if entry.filename.endswith(".dist-info/METADATA"):
                about = BytesParser().parsebytes(content)
            if is_licence(entry.filename):
                licences[entry.filename] = content
            packed.writestr(entry, content, compress_type=method)
            unpacked += len(content)
    target.with_suffix(".part").rename(target)
    return Part(
        target, hashlib.sha256(wheel.read_bytes()).hexdigest(), unpacked, given_size - unpacked, about, licences
    )


def record(given: bytes, kept: Iterable[str]) -> bytes:
    """The rows of RECORD for the files that were kept."""
    left, text = set(kept), io.StringIO()
    rows = [row for row in csv.reader(io.StringIO(given.decode())) if row and row[0] in left]
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


def differences(wheel: Path) -> list[str]:
    """Where a wheel and its RECORD disagree; empty for a whole one."""
    with zipfile.ZipFile(wheel) as packed:
        name = next(name for name in packed.namelist() if name.endswith(".dist-info/RECORD"))
        said = {row[0]: row[1] for row in csv.reader(io.StringIO(packed.read(name).decode())) if row}
        files = {entry.filename for entry in packed.infolist() if not entry.is_dir()}
        wrong = sorted(files ^ set(said))
        return wrong + [file for file in sorted(files & set(said)) if said[file] not in ("", _hash(packed.read(file)))]


def is_licence(path: str) -> bool:
    """A text of a licence, in the folder of the metadata or at the top of a part."""
    folder, _, name = path.rpartition("/")
    in_metadata = ".dist-info" in folder and not path.endswith((".json", ".py"))
    at_top = folder != "" and "/" not in folder and path.endswith((".txt", "LICENSE"))
    return bool(name) and (in_metadata or at_top) and any(fnmatch(name.lower(), pattern) for pattern in _LICENCE)


def _hash(content: bytes) -> str:
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def _pip(*words: str) -> None:
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "-qq"]
    subprocess.run([*pip, *words], check=True, timeout=1800)
