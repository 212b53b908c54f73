"""Arrivals: a picture in the inbox becomes a job, or as many as it has pages and its side file asks for copies."""

from __future__ import annotations

import errno
import hashlib
from collections import defaultdict
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from daemon.config import Settings
from daemon.errors import DiskTrouble, SettingsError
from daemon.intake.inbox import readable
from daemon.intake.pages import UNCOUNTED, count_pages
from daemon.intake.side import Wishes, parse, read_bytes
from daemon.jobs.arrival import ARRIVAL_NAME, Arrival, arrival_in
from daemon.jobs.desk import GONE, Desk
from daemon.jobs.folder import free_bytes, source_of
from daemon.jobs.record import read_record
from daemon.jobs.states import State
from daemon.jobs.wishes import SIDE_NAME, machines_for, with_wishes

_TWIN = "the same picture as job {twin} (duplicates = 'skip'): `linedrawd again {twin}` draws it anew"
_NOT_DRAWN = (State.FAILED, State.CANCELLED, State.INTERRUPTED)


class Arrivals:
    """Takes pictures in. Every cut, at any moment, leaves each picture in the inbox or in a job that is found again."""

    def __init__(
        self,
        desk: Desk,
        settings: Settings,
        *,
        free: Callable[[Path], int] = free_bytes,
        pages: Callable[[Path], int] = count_pages,
    ) -> None:
        self._desk, self.settings, self._free, self._pages = desk, settings, free, pages
        self._jobs_of: dict[int, list[str]] | None = None
        self._hashes: dict[str, str] = {}
        self._unfinished: list[tuple[list[str], Arrival, Path | None]] = []

    def take(self, picture: Path, beside: Path | None, *, inbox: str = "") -> None:
        """Make jobs of a picture and its side file, which then lie there no longer.

        inbox: the machine whose inbox they lie in; "" for that of all. Raises SettingsError for a side file that is
        wrong, DiskTrouble, or FileNotFoundError; they then still do, or what is still to be done is left to `finish`.
        """
        self._check_room()
        name = readable(picture.name)
        said, wishes = self._wishes(beside, inbox)
        twin = self._twin(picture, said) if self.settings.intake.duplicates == "skip" else ""
        copies, pages = (1, 1) if twin else (wishes.copies, self._counted(picture))
        side, machine = beside.name if beside else "", wishes.machine or inbox
        # The twin too, before the picture is taken: whoever finds it after a cut must not draw it again.
        arrival = Arrival(name, side, copies, inbox=inbox, machine=machine, twin=twin)
        # Of one whose pages nobody knows none is left out in silence: it fails where it has several.
        arrival = replace(arrival, pages=pages) if pages else replace(arrival, page=UNCOUNTED)
        files = {ARRIVAL_NAME: arrival.encoded()}
        if beside:
            files[SIDE_NAME] = said
        made = [self._desk.folders.take(picture, files)]
        try:
            self._add(made, arrival, beside)
        except DiskTrouble:
            self._unfinished.append((made, arrival, beside))
            raise

    def finish(self) -> None:
        """Make the jobs that a full disk has kept from being made of a picture that was taken. Raises DiskTrouble."""
        while self._unfinished:
            made, arrival, beside = self._unfinished[0]
            try:
                self._add(made, arrival, beside)
            except FileNotFoundError:
                self._desk.trouble(GONE.format(job=made[-1]))
            del self._unfinished[0]

    def recover(self, inboxes: Mapping[str, Path]) -> None:
        """After a start, before the desk: make the jobs whose pictures had come in but were not recorded.

        inboxes: the folders, by the machine whose they are, "" for that of all. Where the journal is lost, the folders
        of the others have a record each, and the desk takes them over.
        """
        folders = self._desk.folders
        for inbox in inboxes.values():
            folders.finish_claims(inbox)
        for job in folders.strays({job.id for job in self._desk.journal.jobs()}):
            folder = folders.path(job)
            arrival = arrival_in(folder) if read_record(folder) is None else None
            if arrival is not None and self._desk.journal.job(job) is None:
                inbox, more = inboxes.get(arrival.inbox, inboxes[""]), len(arrival.jobs()) - 1
                made = [job, *(_copies_of(folders.root, job)[:more] if more else [])]
                self._add(made, arrival, inbox / arrival.side if arrival.side else None)

    def _check_room(self) -> None:
        floor_mb, root = self.settings.keep.free_mb, self._desk.folders.root
        free_mb = self._free(root) / 1e6
        if free_mb < floor_mb:
            raise DiskTrouble(
                f"only {free_mb:.0f} MB are free on the disk of {root}, no picture is taken below {floor_mb:g} MB: "
                "free the disk or lower free_mb"
            )

    def _wishes(self, beside: Path | None, inbox: str) -> tuple[bytes, Wishes]:
        if beside is None:
            return b"", Wishes()
        place = readable(beside.name)
        try:
            said = read_bytes(beside)
        except FileNotFoundError:
            raise
        except OSError as error:
            raise SettingsError(f"{place} cannot be read ({error.strerror}): put a file there that can") from None
        wishes = parse(said, place)
        if inbox and wishes.machine not in ("", inbox):
            raise SettingsError(
                f"{place}: machine = '{wishes.machine}', but this is the inbox of {inbox}: leave it out"
            )
        for machine in [inbox] if inbox else machines_for(self.settings, wishes, place):
            with_wishes(self.settings, wishes, machine, place)
        return said, wishes

    def _counted(self, picture: Path) -> int:
        """Its pages. Raises FileNotFoundError where another picture has taken its place meanwhile."""
        before, pages, after = picture.lstat(), self._pages(picture), picture.lstat()
        if any(getattr(before, each) != getattr(after, each) for each in ("st_ino", "st_size", "st_mtime_ns")):
            raise FileNotFoundError(errno.ENOENT, "changed while its pages were counted", str(picture))
        return pages

    def _add(self, made: list[str], arrival: Arrival, beside: Path | None) -> None:
        """The copies' folders first: a job that is recorded has them all. Then the side file, then the record.

        made: the job whose folder holds the picture, and those of its copies and pages that are there already, in the
        order in which they were made: page by page, then the next copy. Those that follow are added to it.
        Raises DiskTrouble, or FileNotFoundError where the picture has been deleted.
        """
        job, folders = made[0], self._desk.folders
        folder = folders.path(job)
        jobs = arrival.jobs()
        for one in jobs[len(made) :]:
            # The last one's: where no link can be made of somebody else's file, one can of our first copy.
            source = source_of(folders.path(made[-1]))
            if source is None:
                raise FileNotFoundError(errno.ENOENT, "deleted", str(folder))
            files = {ARRIVAL_NAME: one.copy(job).encoded()}
            if (folder / SIDE_NAME).exists():
                files[SIDE_NAME] = (folder / SIDE_NAME).read_bytes()
            made.append(folders.copy(source, files, name=arrival.name))
        if beside is not None:
            _remove_taken(beside, folder / SIDE_NAME)
        # Not before all of them have their folders: what is recorded is not looked at again after a cut.
        for each, one in zip(made, jobs, strict=True):
            if self._desk.journal.job(each) is not None:
                continue
            if arrival.twin:
                self._desk.add_dropped(each, one.called, _TWIN.format(twin=arrival.twin))
            else:
                self._desk.add(each, one.called, bound_to=arrival.machine)
        self._remember(made)

    def _twin(self, picture: Path, said: bytes) -> str:
        """The job, drawn or still to be drawn, whose picture and side file are these, byte for byte; "" for none."""
        journal = self._desk.journal
        found = _hash(picture, said)
        for job_id in self._known().get(picture.stat().st_size, []):
            job = journal.job(job_id)
            if job is not None and job.state not in _NOT_DRAWN and self._hash_of(job_id) == found:
                return job_id
        return ""

    def _known(self) -> dict[int, list[str]]:
        """The jobs by the size of their picture: most pictures are told apart by it and are never read for this."""
        if self._jobs_of is None:
            self._jobs_of = defaultdict(list)
            self._remember([job.id for job in self._desk.journal.jobs()])
        return self._jobs_of

    def _remember(self, jobs: list[str]) -> None:
        if self._jobs_of is None:
            return
        for job in jobs:
            source = source_of(self._desk.folders.path(job))
            if source is not None:
                self._jobs_of[source.stat().st_size].append(job)

    def _hash_of(self, job_id: str) -> str:
        if job_id not in self._hashes:
            folder = self._desk.folders.path(job_id)
            source, side = source_of(folder), folder / SIDE_NAME
            self._hashes[job_id] = "" if source is None else _hash(source, side.read_bytes() if side.exists() else b"")
        return self._hashes[job_id]


def _copies_of(root: Path, job: str) -> list[str]:
    arrived = {path.parent.name: arrival_in(path.parent) for path in sorted(root.glob(f"*/{ARRIVAL_NAME}"))}
    return [copy for copy, arrival in arrived.items() if arrival is not None and arrival.copy_of == job]


def _remove_taken(beside: Path, taken: Path) -> None:
    """Only what was taken: another one may have been put in its place meanwhile."""
    with suppress(OSError):
        if taken.read_bytes() == beside.read_bytes():
            beside.unlink()


def _hash(picture: Path, said: bytes) -> str:
    with picture.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256")
    digest.update(said)
    return digest.hexdigest()
