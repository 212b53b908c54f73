"""The parts of the package: unpacked without their dead weight, with what is never called replaced by nothing."""

from __future__ import annotations

import ctypes
import importlib.util
import os
import sys
import zipfile
from pathlib import Path
from types import ModuleType

import numpy
import pytest

DEBIAN = Path(__file__).parents[2] / "systemd/debian"


def _module(name: str) -> ModuleType:
    """A file of the folder that makes the package, which is no package of Python."""
    place = DEBIAN / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, place)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


elf = _module("elf")
wheels = _module("wheels")
_INFO = "numpy-2.0.dist-info"
_FILES = {
    "numpy/__init__.py": b"x = 1\n",
    "numpy/core/tests/test_x.py": b"assert True\n",
    "numpy/__init__.pyi": b"x: int\n",
    "numpy.libs/libblas-0a1b.so": b"any",
    f"{_INFO}/METADATA": b"Metadata-Version: 2.4\nName: numpy\nVersion: 2.0\nLicense-Expression: MIT\n",
    f"{_INFO}/licenses/LICENSE.txt": b"Do as you like.\n",
}


def wheel(folder: Path, name: str) -> Path:
    path = folder / name
    with zipfile.ZipFile(path, "w") as packed:
        for file, content in _FILES.items():
            packed.writestr(file, content)
    return path


def test_what_is_dead_is_left_out(tmp_path: Path) -> None:
    part = wheels.unpack(wheel(tmp_path, "numpy-2.0-py3-none-any.whl"), tmp_path / "parts")
    common = tmp_path / "parts/common"
    assert sorted(str(path.relative_to(common)) for path in common.rglob("*") if path.is_file()) == [
        f"{_INFO}/METADATA", "numpy.libs/libblas-0a1b.so", "numpy/__init__.py",
    ]  # fmt: skip
    assert (part.name, part.version, part.python, part.bound) == ("numpy", "2.0", None, 0)
    assert part.licences == {f"{_INFO}/licenses/LICENSE.txt": b"Do as you like.\n"}
    assert part.common + part.left_out == sum(map(len, _FILES.values()))
    assert part.left_out > len(_FILES["numpy/core/tests/test_x.py"])


def test_what_is_bound_to_a_python_lies_apart_from_the_libraries_beside_it(tmp_path: Path) -> None:
    part = wheels.unpack(wheel(tmp_path, "numpy-2.0-cp311-cp311-manylinux_2_28_x86_64.whl"), tmp_path / "parts")
    assert part.python == "3.11"
    assert (tmp_path / "parts/python3.11/numpy/__init__.py").exists()
    assert [path.name for path in (tmp_path / "parts/common").rglob("*.*")] == ["numpy.libs", "libblas-0a1b.so"]


@pytest.mark.parametrize(
    ("name", "python"),
    [("a-1-cp313-cp313-manylinux_2_28_aarch64.whl", "3.13"), ("a-1-cp37-abi3-manylinux_2_28_aarch64.whl", None)],
)
def test_the_name_of_a_wheel_says_which_python_it_is_bound_to(name: str, python: str | None) -> None:
    assert wheels.python_of(name) == python


NUMPY = Path(next(Path(numpy.__file__).parent.glob("linalg/_umath_linalg.*.so")))


def test_an_empty_library_loads_and_offers_nothing(tmp_path: Path) -> None:
    (tmp_path / "libempty.so").write_bytes(elf.empty(NUMPY.read_bytes()))
    library = ctypes.CDLL(str(tmp_path / "libempty.so"), mode=os.RTLD_NOW)
    with pytest.raises(AttributeError, match="PyInit__umath_linalg"):
        library.PyInit__umath_linalg  # noqa: B018 - to ask for it is the test
    assert (tmp_path / "libempty.so").stat().st_size < 1000


def test_a_library_gets_by_without_what_it_never_calls() -> None:
    given = NUMPY.read_bytes()
    weaker = elf.without(given, ("PyErr_", "PyNone_"))
    uncalled = {name for name in elf.wanted(given) if name.startswith("PyErr_")}
    assert uncalled
    assert elf.wanted(weaker) == elf.wanted(given) - uncalled
    assert len(weaker) == len(given)


def test_what_is_no_library_is_refused() -> None:
    with pytest.raises(ValueError, match="no library"):
        elf.empty(b"\x7fELF\x01\x01" + bytes(100))


@pytest.mark.parametrize(
    ("path", "is_one"),
    [
        ("a-1.dist-info/licenses/LICENSE", True),
        ("a-1.dist-info/licenses/PARTS/zlib.txt", True),
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
