"""A picture is in the inbox or in a job's folder, whole, and in no moment in neither."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from daemon.errors import DiskTrouble
from daemon.jobs.folder import CLAIMED, JobFolders, source_of, write_durably
from tests.daemon.jobs.test_journal import full_disk


@pytest.fixture
def inbox(tmp_path: Path) -> Path:
    (tmp_path / "inbox").mkdir()
    return tmp_path / "inbox"


def drop(inbox: Path, name: str, text: bytes = b"picture") -> Path:
    (inbox / name).write_bytes(text)
    return inbox / name


def test_a_picture_is_moved_into_a_folder_of_its_own(tmp_path: Path, inbox: Path) -> None:
    folders = JobFolders(tmp_path / "jobs")
    job = folders.take(drop(inbox, "Mein Häuschen.PNG"))
    assert job == "000001-mein-hauschen"
    assert (folders.path(job) / "source.png").read_bytes() == b"picture"
    assert list(inbox.iterdir()) == []


def test_two_pictures_of_one_name_are_two_jobs(tmp_path: Path, inbox: Path) -> None:
    folders = JobFolders(tmp_path / "jobs")
    jobs = [folders.take(drop(inbox, "a.png", text)) for text in (b"1", b"2")]
    assert jobs == ["000001-a", "000002-a"]
    assert [(folders.path(job) / "source.png").read_bytes() for job in jobs] == [b"1", b"2"]


def test_numbers_go_on_after_a_restart(tmp_path: Path, inbox: Path) -> None:
    JobFolders(tmp_path / "jobs").take(drop(inbox, "a.png"))
    assert JobFolders(tmp_path / "jobs").take(drop(inbox, "a.png")) == "000002-a"


@pytest.mark.parametrize(
    ("name", "source"),
    [
        ("a.tar.gz", "source.gz"),
        ("noext", "source"),
        ("x.日本", "source"),
        ("😀.webp", "source.webp"),
        (" .j p", "source"),
    ],
)
def test_any_name_becomes_a_plain_one(tmp_path: Path, inbox: Path, name: str, source: str) -> None:
    folders = JobFolders(tmp_path / "jobs")
    found = source_of(folders.path(folders.take(drop(inbox, name))))
    assert found is not None
    assert found.name == source


def test_a_picture_that_has_gone_leaves_no_folder(tmp_path: Path, inbox: Path) -> None:
    folders = JobFolders(tmp_path / "jobs")
    with pytest.raises(FileNotFoundError):
        folders.take(inbox / "gone.png")
    assert list(folders.root.iterdir()) == []


@pytest.fixture
def elsewhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """Renaming into a job's folder fails as it does from another file system."""
    rename = Path.rename

    def across(self: Path, target: Path) -> Path:
        if Path(target).parent.parent.name == "jobs" and self.parent != Path(target).parent:
            raise OSError(errno.EXDEV, "Invalid cross-device link")
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", across)


@pytest.mark.usefixtures("elsewhere")
def test_a_picture_on_another_file_system_is_copied_and_removed(tmp_path: Path, inbox: Path) -> None:
    folders = JobFolders(tmp_path / "jobs")
    job = folders.take(drop(inbox, "a.png"))
    assert [file.name for file in folders.path(job).iterdir()] == ["source.png"]
    assert list(inbox.iterdir()) == []


@pytest.mark.usefixtures("elsewhere")
def test_a_full_disk_leaves_the_picture_in_the_inbox(tmp_path: Path, inbox: Path) -> None:
    folders = JobFolders(tmp_path / "jobs")
    picture = drop(inbox, "a.png", b"x" * 5000)
    with full_disk(1000), pytest.raises(DiskTrouble, match="free the disk"):
        folders.take(picture)
    assert picture.read_bytes() == b"x" * 5000
    assert list(folders.root.iterdir()) == []


@pytest.mark.parametrize("call", ["rename", "mkdir"])
def test_a_read_only_file_system_leaves_the_picture_in_the_inbox(
    tmp_path: Path, inbox: Path, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    """rename: the inbox is read-only; mkdir: the folder of the jobs is."""
    folders = JobFolders(tmp_path / "jobs")
    picture = drop(inbox, "a.png")

    def refuse(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    with monkeypatch.context() as patch:
        patch.setattr(Path, call, refuse)
        with pytest.raises(DiskTrouble, match=r"Read-only file system.*correct its rights"):
            folders.take(picture)
    assert picture.read_bytes() == b"picture"
    assert list(folders.root.iterdir()) == []
    assert folders.take(picture).endswith("-a")


def test_a_copy_that_a_power_cut_broke_off_is_made_again(tmp_path: Path, inbox: Path) -> None:
    folders = JobFolders(tmp_path / "jobs")
    (folders.root / "000001-a").mkdir()
    (folders.root / "000001-a" / "source.png.part").write_bytes(b"pic")
    drop(inbox, f"{CLAIMED}000001-a")
    folders.finish_claims(inbox)
    assert (folders.root / "000001-a" / "source").read_bytes() == b"picture"
    assert list(inbox.iterdir()) == []
    assert folders.strays(set()) == ["000001-a"]


def test_a_folder_that_never_got_its_picture_is_removed_and_the_others_are_found(tmp_path: Path, inbox: Path) -> None:
    folders = JobFolders(tmp_path / "jobs")
    first, second = (folders.take(drop(inbox, name)) for name in ("a.png", "b.png"))
    (folders.root / "000009-empty").mkdir()
    assert folders.strays({first}) == [second]
    assert not (folders.root / "000009-empty").exists()


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path: Path) -> None:
    write_durably(tmp_path / "report.json", b"old")
    with full_disk(10), pytest.raises(DiskTrouble):
        write_durably(tmp_path / "report.json", b"n" * 100)
    assert [(file.name, file.read_bytes()) for file in tmp_path.iterdir()] == [("report.json", b"old")]


def test_a_hidden_picture_whose_folder_a_power_cut_has_taken_becomes_a_job_all_the_same(
    tmp_path: Path, inbox: Path
) -> None:
    folders = JobFolders(tmp_path / "jobs")
    drop(inbox, f"{CLAIMED}000001-a")
    folders.finish_claims(inbox)
    assert (folders.root / "000001-a" / "source").read_bytes() == b"picture"
    assert list(inbox.iterdir()) == []


@pytest.mark.usefixtures("elsewhere")
def test_what_belongs_beside_a_picture_is_there_before_it(
    tmp_path: Path, inbox: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folders = JobFolders(tmp_path / "jobs")
    picture = drop(inbox, "a.png")
    rename, found = Path.rename, []

    def look_first(self: Path, target: Path) -> Path:
        if Path(target).name.startswith(CLAIMED):
            found.extend(path.name for path in (folders.root / "000001-a").iterdir())
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", look_first)
    job = folders.take(picture, {"side.toml": b"copies = 2"})
    assert found == ["side.toml"]
    assert sorted(path.name for path in folders.path(job).iterdir()) == ["side.toml", "source.png"]
