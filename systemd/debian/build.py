"""Build dist/linedrawd_VERSION_ARCH.deb: parts for the Pythons of Debian 12 and 13, and every file in its place."""

from __future__ import annotations

import argparse
import gzip
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from email.utils import formatdate
from pathlib import Path

import man
from papers import copyright_of, sbom, texts
from wheels import PLATFORMS, Part, fetch, own_wheel, unpack

from daemon.cli.__main__ import whole_parser

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
PYTHONS = ("3.11", "3.13")
MAINTAINER = "linedrawd contributors <linedrawd@linedrawd.invalid>"
PLACES = {
    "systemd/linedrawd.service": "usr/lib/systemd/system/linedrawd.service",
    "systemd/debian/package.conf": "usr/lib/systemd/system/linedrawd.service.d/package.conf",
    "systemd/linedrawd.sysusers": "usr/lib/sysusers.d/linedrawd.conf",
    "systemd/linedrawd.tmpfiles": "usr/lib/tmpfiles.d/linedrawd.conf",
    "systemd/70-linedrawd.rules": "usr/lib/udev/rules.d/70-linedrawd.rules",
    "systemd/linedrawd.logrotate": "etc/logrotate.d/linedrawd",
    "systemd/linedrawd.toml": "etc/linedrawd/linedrawd.toml",
    "systemd/debian/environment": "usr/lib/linedrawd/environment",
    "systemd/debian/lintian-overrides": "usr/share/lintian/overrides/linedrawd",
    "tests/drawings/house.png": "usr/share/doc/linedrawd/examples/house.png",
    "systemd/drop-ins": "usr/share/doc/linedrawd/examples/drop-ins",
}
SCRIPTS = ("postinst", "prerm", "postrm")
MB = 1e6
INSTALLED_AT_MOST_MB = {"arm64": 190.0}
"""The bar of the whole package with its virtual environment."""


def main() -> None:
    """Build what the command line asks for, and print how large each part is."""
    args = _parser().parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    os.environ.setdefault("SOURCE_DATE_EPOCH", str(_last_change_s()))
    (ROOT / "build").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="deb-", dir=ROOT / "build") as folder:
        work = Path(folder)
        own = own_wheel(ROOT, work)
        shutil.copy(own, args.out)
        for arch in args.arch:
            parts = [unpack(own, work / f"parts-{arch}"), *_parts(own, arch, args, work)]
            package(parts, work / f"parts-{arch}", arch, args)


def package(parts: list[Part], unpacked: Path, arch: str, args: argparse.Namespace) -> Path:
    """Lay all files out, and make the package of them. Raises ValueError where it is larger than its bar."""
    tree = _emptied(unpacked.parent / f"linedrawd-{arch}")
    version = parts[0].version
    for source, place in PLACES.items():
        _install(ROOT / source, tree / place)
    library = tree / "usr/lib/linedrawd"
    _install(unpacked / "common", library / "common")
    _squeeze(unpacked, library / "bound.tar.xz", small=args.small)
    (library / "pythons").write_text(" ".join(f"python{python}" for python in args.python) + "\n")
    content = hashlib.sha256(b"".join(_digest(path) for path in _files(unpacked))).hexdigest()
    (library / "version").write_text(f"{version} {content[:16]}\n")
    (tree / "usr/bin").mkdir(parents=True)
    (tree / "usr/bin/linedrawd").symlink_to("/opt/linedrawd/bin/linedrawd")
    _write_papers(parts, version, arch, tree / "usr/share/doc/linedrawd")
    _write_manual(version, tree / "usr/share/man")
    made = max(_size(folder) + _bytecode(unpacked, folder) for folder in unpacked.glob("python*"))
    _write_control(version, arch, tree, made=made)
    file: Path = args.out / f"linedrawd_{version}_{arch}.deb"
    squeezed = ["-Zxz"] if args.small else ["-Zgzip", "-z1"]
    subprocess.run(["dpkg-deb", *squeezed, "--root-owner-group", "--build", tree, file], check=True)
    _print_sizes(parts, file, tree, made)
    installed_mb = (_size(tree) + made) / MB
    if args.small and installed_mb > INSTALLED_AT_MOST_MB.get(arch, installed_mb):
        raise ValueError(
            f"{file.name} takes {installed_mb:.0f} MB, at most {INSTALLED_AT_MOST_MB[arch]:g}: leave more out"
        )
    return file


def _parts(own: Path, arch: str, args: argparse.Namespace, work: Path) -> list[Part]:
    """Fetched and unpacked, each wheel once where it serves several Pythons."""
    fetched: dict[str, Path] = {}
    for python in args.python:
        for path in fetch(own, arch, python, ROOT / "constraints.txt", _emptied(work / f"fetched-{arch}-{python}")):
            fetched.setdefault(path.name, path)
    return [unpack(fetched[name], work / f"parts-{arch}") for name in sorted(fetched)]


def _squeeze(unpacked: Path, file: Path, *, small: bool) -> None:
    """What is bound to one Python. Files of the same name lie side by side: they are alike, and squeezed as one."""
    bound = [path for folder in unpacked.glob("python*") for path in _files(folder)]
    with tarfile.open(file, "w:xz", preset=8 if small else 0) as packed:
        for path in sorted(bound, key=lambda path: (path.name.split(".")[0], path.stat().st_size, path)):
            packed.add(path, path.relative_to(unpacked), filter=_plain)


def _plain(member: tarfile.TarInfo) -> tarfile.TarInfo:
    member.uid = member.gid = 0
    member.uname = member.gname = "root"
    member.mode, member.mtime = 0o644, _epoch_s()
    return member


def _bytecode(unpacked: Path, bound: Path) -> int:
    """Bytes of it, about: compiled by the Python that builds, all but what a board does not compile either."""
    cache = _emptied(unpacked.parent / "bytecode")
    seldom = re.findall(r"^seldom='(.*)'$", (HERE / "environment").read_text(encoding="utf-8"), re.MULTILINE)[0]
    compiler = [sys.executable, "-X", f"pycache_prefix={cache}", "-m", "compileall", "-q", "-x", seldom]
    subprocess.run([*compiler, unpacked / "common", bound], check=False)
    return _size(cache)


def _write_papers(parts: list[Part], version: str, arch: str, doc: Path) -> None:
    others = [part for part in parts if part.name != "linedrawd"]
    once = list({part.name: part for part in others}.values())
    own = (ROOT / "LICENSE").read_text(encoding="utf-8")
    (doc / "copyright").write_text(copyright_of(once, own), encoding="utf-8")
    for part in once:
        for path, content in texts(part).items():
            place = doc / "licenses" / part.name / _flat(path)
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
    (doc / "sbom.cdx.json").write_text(sbom(others, version=version, arch=arch), encoding="utf-8")
    for page in (ROOT / "docs").rglob("*.md"):
        _install(page, doc / page.relative_to(ROOT / "docs"))
    date = formatdate(_epoch_s(), localtime=False)
    said = f"linedrawd ({version}) stable; urgency=medium\n\n  * See CHANGELOG.md.\n\n -- {MAINTAINER}  {date}\n"
    _write_gzip(said, doc / "changelog.gz")
    _install(ROOT / "CHANGELOG.md", doc / "CHANGELOG.md")


def _write_manual(version: str, manual: Path) -> None:
    date = f"{datetime.fromtimestamp(_epoch_s(), UTC):%Y-%m-%d}"
    os.environ["COLUMNS"] = "80"
    _write_gzip(man.commands(whole_parser(), version=version, date=date), manual / "man1/linedrawd.1.gz")
    text = (ROOT / "systemd/linedrawd.toml").read_text(encoding="utf-8")
    _write_gzip(man.settings(text, version=version, date=date), manual / "man5/linedrawd.toml.5.gz")


def _write_gzip(text: str, place: Path) -> None:
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def _write_control(version: str, arch: str, tree: Path, *, made: int) -> None:
    """Installed-Size holds what is made in /opt too, which dpkg does not see."""
    control = tree / "DEBIAN"
    control.mkdir()
    said = {
        "@VERSION@": version,
        "@ARCH@": arch,
        "@MAINTAINER@": MAINTAINER,
        "@SIZE_KB@": str((_size(tree) + made) // 1024),
    }
    text = (HERE / "control").read_text(encoding="utf-8")
    for word, value in said.items():
        text = text.replace(word, value)
    (control / "control").write_text(text, encoding="utf-8")
    for name in ("conffiles", "triggers", *SCRIPTS):
        _install(HERE / name, control / name)
    for path in sorted(path for path in tree.rglob("*") if path.is_file() and not path.is_symlink()):
        if control not in path.parents:
            digest = hashlib.md5(path.read_bytes(), usedforsecurity=False).hexdigest()
            with (control / "md5sums").open("a") as sums:
                sums.write(f"{digest}  {path.relative_to(tree)}\n")
    (control / "md5sums").chmod(0o644)


def _print_sizes(parts: list[Part], file: Path, tree: Path, made: int) -> None:
    library = tree / "usr/lib/linedrawd"
    print(f"\n{file.name}: {file.stat().st_size / MB:.1f} MB; MB of each part:")
    print(f"  {'':42}{'common':>8}{'bound':>8}{'left out':>10}")
    for part in parts:
        name = "-".join(part.wheel.split("-")[:3])
        print(f"  {name:42}{part.common / MB:8.1f}{part.bound / MB:8.1f}{part.left_out / MB:10.1f}")
    common, bound, all_of_it = _size(library / "common"), _size(library / "bound.tar.xz"), _size(tree)
    print(f"  installed: {common / MB:.1f} for every Python, {bound / MB:.1f} for one of them, squeezed,")
    print(f"  {(all_of_it - common - bound) / MB:.1f} of papers and the rest, {made / MB:.1f} unpacked and bytecode:")
    print(f"  {(all_of_it + made) / MB:.1f} MB in all", flush=True)


def _install(source: Path, place: Path) -> None:
    """A file, or a folder of files, with the rights that a package gives."""
    for path in _files(source):
        target = place / path.relative_to(source) if source.is_dir() else place
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
        target.chmod(0o755 if path.name in (*SCRIPTS, "environment") else 0o644)


def _files(source: Path) -> Iterator[Path]:
    return (path for path in sorted(source.rglob("*")) if path.is_file()) if source.is_dir() else iter([source])


def _digest(path: Path) -> bytes:
    return hashlib.sha256(path.read_bytes()).digest()


def _emptied(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def _flat(path: str) -> str:
    """The name of a text of a licence, told apart from others of the same name by the folders above it."""
    inside = path.rpartition(".dist-info/")[2].removeprefix("licenses/")
    return inside.replace("/", "-")


def _size(tree: Path) -> int:
    """Bytes of a file, or of all files below a folder."""
    return sum(path.stat().st_size for path in _files(tree) if not path.is_symlink())


def _epoch_s() -> int:
    return int(os.environ["SOURCE_DATE_EPOCH"])


def _last_change_s() -> int:
    """When the sources were last committed, or now where there is no git."""
    said = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True, check=False)
    return int(said.stdout) if said.returncode == 0 else int(time.time())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--arch", nargs="+", choices=PLATFORMS, default=list(PLATFORMS))
    parser.add_argument("--python", nargs="+", choices=PYTHONS, default=list(PYTHONS))
    parser.add_argument("--out", type=Path, default=ROOT / "dist")
    parser.add_argument(
        "--quick",
        dest="small",
        action="store_false",
        help="squeezed little: in seconds, half as large again; for tests",
    )
    return parser


if __name__ == "__main__":
    main()
