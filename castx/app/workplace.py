"""The folder of the page: its files by names, never outside it and never through links."""

from __future__ import annotations

import errno
import fcntl
import os
import stat
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path

from castx.case.cad.geometry import is_cad_file
from castx.errors import CaseError
from castx.results.files.folder import RECORD, write_whole

LARGEST_CASE = 4_000_000
"""Bytes of a case file."""
DEEPEST = 4
"""Folders inside each other that are listed."""
MOST = 500
"""Files that are listed."""
INSIDE_RESULTS = ("fields", "checkpoint")


class Workplace:
    """Files below a folder, by their paths relative to it.

    Args:
        folder: where the command was started, or that it was given.

    Raises:
        CaseError: it is no folder.
    """

    def __init__(self, folder: Path) -> None:
        try:
            self.folder = folder.resolve(strict=True)
        except OSError as error:
            raise CaseError(f"{folder}: {error.strerror}") from None
        if not self.folder.is_dir():
            raise CaseError(f"{folder} is no folder; give the one with your case files")
        self._writing = threading.Lock()

    def path(self, name: str) -> Path:
        """Return the path of a file or folder, which need not exist.

        Args:
            name: relative to the folder, with slashes.

        Raises:
            CaseError: it leads outside, through a link, or to a hidden file.
        """
        parts = name.split("/")
        if not name or "\0" in name or any(part in ("", ".", "..") for part in parts):
            raise CaseError(f"{name!r} is no path of a file below {self.folder}")
        if any(part.startswith(".") for part in parts):
            raise CaseError(f"{name} is hidden, and the page leaves hidden files alone")
        path = self.folder
        for part in parts:
            path = path / part
            try:
                if path.is_symlink():
                    raise CaseError(
                        f"{name} leads through a link, {path.name}; the page shows only files that "
                        "lie in its folder themselves"
                    )
            except OSError as error:
                raise CaseError(f"{name}: {error.strerror}") from None
        return path

    def name_of(self, path: Path) -> str:
        """Return the name of a file by its path.

        Raises:
            CaseError: it lies outside, or is reached through a link.
        """
        try:
            name = Path(os.path.abspath(path)).relative_to(self.folder).as_posix()
        except ValueError:
            raise CaseError(
                f"{path} lies outside of {self.folder}, where the page neither reads nor writes; "
                "move it here, or use the command line"
            ) from None
        self.path(name)
        return name

    def files(self) -> dict[str, list[str]]:
        """Return the names of case files, CAD files and results folders, sorted."""
        found: dict[str, list[str]] = {"cases": [], "parts": [], "results": []}
        for number, (kind, name) in enumerate(self._walked(self.folder, "", 0)):
            if number == MOST:
                break
            found[kind].append(name)
        return {kind: sorted(names) for kind, names in found.items()}

    def _walked(self, folder: Path, before: str, depth: int) -> Iterator[tuple[str, str]]:
        try:
            entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
        except OSError:
            return
        for entry in entries:
            name = before + entry.name
            if entry.name.startswith(".") or entry.is_symlink():
                continue
            if entry.is_dir(follow_symlinks=False):
                if entry.name in INSIDE_RESULTS:
                    continue
                if Path(entry.path, RECORD).is_file():
                    yield "results", name
                if depth < DEEPEST:
                    yield from self._walked(Path(entry.path), f"{name}/", depth + 1)
            elif entry.name.endswith(".toml"):
                yield "cases", name
            elif is_cad_file(entry.name):
                yield "parts", name

    def case_path(self, name: str) -> Path:
        """Return the path of a case file, which need not exist.

        Raises:
            CaseError: it is no name of a case file below the folder.
        """
        if not name.endswith(".toml"):
            raise CaseError(f"{name} is no case file: its name has to end with .toml")
        return self.path(name)

    def read_case(self, name: str) -> tuple[str, str]:
        """Return the text of a case file, and its digest.

        Raises:
            CaseError: it cannot be read.
        """
        content = self._content(name)
        try:
            return content.decode(), digest_of(content)
        except UnicodeDecodeError:
            raise CaseError(f"{name} is no text file in UTF-8") from None

    def _content(self, name: str) -> bytes:
        try:
            # Never a pipe that nobody writes to, and no link put here since.
            flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
            with os.fdopen(os.open(self.case_path(name), flags), "rb") as file:
                if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                    raise CaseError(f"{name} is no file")
                content = file.read(LARGEST_CASE + 1)
        except OSError as error:
            raise CaseError(f"{name} cannot be read: {error.strerror}") from None
        if len(content) > LARGEST_CASE:
            raise CaseError(f"{name} is too large; a case file has at most {LARGEST_CASE} bytes")
        return content

    def write_case(self, name: str, text: str, digest: str) -> str:
        """Write a case file and return its new digest.

        Args:
            name: of the file.
            text: its new text.
            digest: of the text that it had when the page read it; "" of a new file.

        Raises:
            CaseError: it has changed since, or cannot be written.
        """
        path, content = self.case_path(name), text.encode()
        if len(content) > LARGEST_CASE:
            raise CaseError(f"a case file has at most {LARGEST_CASE} bytes")
        with self._writing:
            there = digest_of(self._content(name)) if path.exists() else ""
            if there != digest:
                raise CaseError(
                    f"{name} has changed on the disk since the page read it, and was not written; "
                    "open it again, which shows what it holds now"
                )
            try:
                write_whole(path, text)
            except OSError as error:
                raise CaseError(f"{name} cannot be written: {error.strerror}") from None
        return digest_of(content)


def digest_of(content: bytes) -> str:
    """Return the digest of the content of a file."""
    return sha256(content).hexdigest()


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Keep a folder for this page alone; the kernel ends that with the process.

    Raises:
        CaseError: another page has it.
    """
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:  # some file systems lock no folders: one then has to know
            if error.errno in (errno.EWOULDBLOCK, errno.EAGAIN):
                raise CaseError(
                    f"castx app is open on {folder} already; use that page, or end it with Ctrl-C"
                ) from None
        yield
    finally:
        os.close(descriptor)
