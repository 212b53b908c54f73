"""A wheel that is written anew without its dead weight is whole, and says so itself."""

from __future__ import annotations

import importlib.util
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import pytest


def _module(name: str) -> ModuleType:
    """A file of the folder that makes the package, which is no package of Python."""
    place = Path(__file__).parents[2] / "systemd/debian" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"debian_{name}", place)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


wheels = _module("wheels")
_INFO = "numpy-2.0.dist-info"
_FILES = {
    "numpy/__init__.py": b"x = 1\n",
    "numpy/core/tests/test_x.py": b"assert True\n",
    "numpy/__init__.pyi": b"x: int\n",
    f"{_INFO}/METADATA": b"Metadata-Version: 2.4\nName: numpy\nVersion: 2.0\nLicense-Expression: MIT\n",
    f"{_INFO}/licenses/LICENSE.txt": b"Do as you like.\n",
}


def wheel(folder: Path) -> Path:
    path = folder / "numpy-2.0-py3-none-any.whl"
    rows = "".join(f"{name},{wheels._hash(content)},{len(content)}\n" for name, content in _FILES.items())
    with zipfile.ZipFile(path, "w") as packed:
        for name, content in (_FILES | {f"{_INFO}/RECORD": f"{rows}{_INFO}/RECORD,,\n".encode()}).items():
            packed.writestr(name, content)
    return path


@pytest.mark.parametrize("small", [True, False])
def test_what_is_dead_is_left_out_and_the_record_with_it(tmp_path: Path, small: bool) -> None:
    (tmp_path / "packed").mkdir()
    part = wheels.repack(wheel(tmp_path), tmp_path / "packed", small=small)
    with zipfile.ZipFile(part.path) as packed:
        assert sorted(packed.namelist()) == sorted(
            ["numpy/__init__.py", f"{_INFO}/METADATA", f"{_INFO}/RECORD", f"{_INFO}/licenses/LICENSE.txt"]
        )
    assert wheels.differences(part.path) == []
    assert (part.name, part.version) == ("numpy", "2.0")
    assert part.licences == {f"{_INFO}/licenses/LICENSE.txt": b"Do as you like.\n"}
    assert part.left_out > len(_FILES["numpy/core/tests/test_x.py"])


def test_a_wheel_whose_record_is_wrong_is_noticed(tmp_path: Path) -> None:
    path = wheel(tmp_path)
    with zipfile.ZipFile(path, "a") as packed:
        packed.writestr("numpy/more.py", b"")
    assert wheels.differences(path) == ["numpy/more.py"]


@pytest.mark.parametrize(
    ("path", "is_one"),
    [
        ("a-1.dist-info/licenses/LICENSE", True),
        ("a-1.dist-info/COPYING", True),
        ("onnxruntime/ThirdPartyNotices.txt", True),
        ("onnxruntime/LICENSE", True),
        ("packaging/licenses/__init__.py", False),
        ("a/b/c/LICENSE.py", False),
        ("a-1.dist-info/METADATA", False),
    ],
)
def test_the_texts_of_licences_are_found(path: str, is_one: bool) -> None:
    assert wheels.is_licence(path) is is_one
