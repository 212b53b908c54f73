"""A job's folder: made once, filled by moves and writes that are whole or not there, also after a power cut."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from daemon.durable import PART, sync_folder, whole_file
from daemon.errors import NO_ROOM, DiskFull, DiskTrouble

CLAIMED = ".claimed-"
"""A picture of an inbox on another file system, while it is being copied: `.claimed-JOB`."""


def write_durably(path: Path, data: bytes) -> None:
    """Replace the file by `data`, whole or not at all. Raises DiskTrouble."""
    with _disk_trouble(path):
        with whole_file(path) as file:
            file.write(data)
        sync_folder(path.parent)


def write_all_durably(folder: Path, files: Mapping[str, bytes]) -> None:
    """As `write_durably`, in this order. After a power cut the first few of them are there. Raises DiskTrouble."""
    for name, data in files.items():
        with _disk_trouble(folder / name), whole_file(folder / name) as file:
            file.write(data)
    with _disk_trouble(folder):
        sync_folder(folder)


def make_folder(folder: Path) -> Path:
    """The folder, made with its parents where it is missing. Raises DiskTrouble."""
    with _disk_trouble(folder):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def free_bytes(folder: Path) -> int:
    """What may still be written on the disk of this folder."""
    disk = os.statvfs(folder)
    return disk.f_bavail * disk.f_frsize


def source_of(folder: Path) -> Path | None:
    """The picture of a job, None where it has not arrived."""
    return next((path for path in folder.glob("source*") if path.suffix != PART), None)


class JobFolders:
    """The folders of all jobs: `<number>-<name>`, numbered in the order in which the pictures came."""

    def __init__(self, root: Path) -> None:
        self.root = make_folder(root)
        self._number = max((number_of(name) for name in os.listdir(root)), default=0)

    def go_on_behind(self, job_ids: Iterable[str]) -> None:
        """No number of these jobs is given again, though their folders may have gone."""
        self._number = max([self._number, *map(number_of, job_ids)])

    def path(self, job_id: str) -> Path:
        return self.root / job_id

    def take(self, picture: Path, beside: Mapping[str, bytes] | None = None) -> str:
        """Move the picture into a new job's folder and return the job's id.

        The move is one rename; where the inbox lies on another file system the picture is first hidden there, then
        copied. beside: files by name that are in the folder before the picture is.
        Raises DiskTrouble, the picture is then still where it was, or FileNotFoundError when it has gone.
        """
        with self._new_folder(picture, beside or {}) as folder:
            try:
                picture.rename(folder / _source_name(picture))
            except OSError as error:
                if error.errno != errno.EXDEV:
                    raise
                # Before the picture is hidden: after a power cut the folder of its job must be there.
                sync_folder(folder)
                sync_folder(self.root)
                _take_from_elsewhere(picture, folder)
        # From here on it is the job's: what cannot be made durable is told when the job is recorded.
        with suppress(OSError):
            for changed in (picture.parent, folder, self.root):
                sync_folder(changed)
        return folder.name

    def copy(self, picture: Path, beside: Mapping[str, bytes] | None = None, *, name: str = "") -> str:
        """As `take`, but the picture stays where it is. Raises DiskTrouble and FileNotFoundError.

        The picture of another job is never written into: both then have the one file. name: what the picture is called,
        if not like its file.
        """
        with self._new_folder(Path(name) if name else picture, beside or {}) as folder:
            put = _link_or_copy if picture.parent.parent == self.root else _copy_durably
            put(picture, folder / _source_name(picture))
            sync_folder(folder)
            sync_folder(self.root)
        return folder.name

    def finish_claims(self, inbox: Path) -> None:
        """Copy again what a power cut left hidden in an inbox on another file system."""
        for hidden in inbox.glob(f"{CLAIMED}*"):
            folder = self.path(hidden.name.removeprefix(CLAIMED))
            if source_of(folder) is None:
                with _disk_trouble(folder):
                    folder.mkdir(exist_ok=True)
                    _copy_durably(hidden, folder / _source_name(Path(folder.name)))
            if source_of(folder) is not None:
                hidden.unlink()

    def strays(self, known: set[str]) -> list[str]:
        """Folders that hold a picture but whose job was never recorded; those without a picture are removed."""
        strays = [folder for folder in sorted(self.root.iterdir()) if folder.is_dir() and folder.name not in known]
        for folder in strays:
            if source_of(folder) is None:
                shutil.rmtree(folder, ignore_errors=True)
        return [folder.name for folder in strays if source_of(folder) is not None]

    @contextmanager
    def _new_folder(self, picture: Path, beside: Mapping[str, bytes]) -> Iterator[Path]:
        with _disk_trouble(self.root):
            folder = self._make(picture.stem)
            try:
                for name, data in beside.items():
                    with whole_file(folder / name) as file:
                        file.write(data)
                yield folder
            except OSError:
                shutil.rmtree(folder, ignore_errors=True)
                raise

    def _make(self, stem: str) -> Path:
        while True:
            self._number += 1
            folder = self.root / f"{self._number:06d}-{_slug(stem)}"
            try:
                folder.mkdir()
            except FileExistsError:
                continue
            return folder


def _take_from_elsewhere(picture: Path, folder: Path) -> None:
    hidden = picture.with_name(CLAIMED + folder.name)
    name = folder / _source_name(picture)
    picture.rename(hidden)
    try:
        _copy_durably(hidden, name)
    except OSError:
        hidden.rename(picture)
        raise
    # The next start does it where it cannot be done now.
    with suppress(OSError):
        hidden.unlink()


def _link_or_copy(picture: Path, copy: Path) -> None:
    """Some file systems know no links, and of a file of somebody else's none may be made."""
    try:
        copy.hardlink_to(picture)
    except OSError:
        _copy_durably(picture, copy)


def _copy_durably(picture: Path, copy: Path) -> None:
    with picture.open("rb") as given, whole_file(copy) as file:
        shutil.copyfileobj(given, file, 1 << 20)


def _source_name(picture: Path) -> str:
    suffix = picture.suffix.lower()
    return "source" + (suffix if re.fullmatch(r"\.[a-z0-9]{1,8}", suffix) and suffix != PART else "")


def _slug(stem: str) -> str:
    plain = unicodedata.normalize("NFKD", stem).encode("ascii", "ignore").decode("ascii").lower()
    return re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[:24].strip("-") or "picture"


def warnings_of(folder: Path) -> list[str]:
    """What the report of a plan warns of; nothing where there is no report that can be read."""
    try:
        found: list[str] = json.loads((folder / "report.json").read_text(encoding="utf-8"))["warnings"]
    except (OSError, ValueError, KeyError):
        return []
    return found


def number_of(job_id: str) -> int:
    """The number at its beginning, 0 where there is none."""
    found = re.match(r"(\d+)-", job_id)
    return int(found.group(1)) if found else 0


def is_called(job_id: str, wanted: str) -> bool:
    """Whether a person who says `wanted`, an id or the number at its beginning, means this job."""
    return job_id == wanted or (wanted.isdecimal() and job_id.startswith(f"{int(wanted):06d}-"))


@contextmanager
def _disk_trouble(place: Path) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise
    except OSError as error:
        trouble = DiskFull if error.errno in NO_ROOM else DiskTrouble
        raise trouble(f"{place} cannot be written ({error.strerror}): free the disk or correct its rights") from None
