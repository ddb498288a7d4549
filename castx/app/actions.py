"""What the page can ask for: each action is a function or a command of the command line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from castx.app.checking import checked
from castx.app.commands import Commands
from castx.app.forms.actions import path_of, shown_forms, with_added, with_field
from castx.app.part_actions import PartActions, choices, new_arguments
from castx.app.runs.expected import expectation
from castx.app.runs.progress import RunProgress
from castx.app.scenes.asking import Scenes
from castx.app.session import Session
from castx.app.text.arguments import Asked, number_of, text_of, word_of
from castx.app.text.toml_lines import line_of
from castx.app.workplace import Workplace
from castx.errors import CaseError
from castx.results.files.folder import CHECKPOINT, REPORT
from castx.version import __version__

Answer = dict[str, Any]
SHOWN = (".html", ".png")
"""Ends of files that a tab of its own may show."""


class Actions:
    """The actions of a page by their names.

    Args:
        workplace: the folder.
        session: of the user.
    """

    def __init__(self, workplace: Workplace, session: Session) -> None:
        self.workplace = workplace
        self.commands = Commands(workplace.folder)
        self._session = session
        self._progress = RunProgress()
        self._parts = PartActions(workplace)
        self._scenes = Scenes()
        self.known: Mapping[str, Callable[[Asked], Answer]] = {
            "claim": self.claim,
            "leave": self.leave,
            "files": self.files,
            "open": self.open,
            "check": self.check,
            "save": self.save,
            "command": self.command,
            "state": self.state,
            "stop": self.stop,
            "show": self.show,
            "choices": lambda asked: choices(),
            "faces": self._parts.view,
            "surfaces": self._parts.surfaces,
            "propose": self._parts.proposed,
            "select": self._parts.selected,
            "name": self.name,
            "form": shown_forms,
            "mesh": self.mesh,
            "moment": self.moment,
            "expect": self.expect,
            "set": self.set,
            "add": lambda asked: self.save({**asked, "text": with_added(asked)}),
        }

    def claim(self, asked: Asked) -> Answer:
        """Let a window work with the page."""
        window = text_of(asked, "window")
        claimed = self._session.claim(window, asked.get("force") is True)
        return {"claimed": claimed, "folder": str(self.workplace.folder), "version": __version__}

    def leave(self, asked: Asked) -> Answer:
        """Let the window go that is being closed."""
        self._session.leave(text_of(asked, "window"))
        return {}

    def files(self, asked: Asked) -> Answer:
        """Return the files of the folder."""
        return dict(self.workplace.files())

    def open(self, asked: Asked) -> Answer:
        """Return the text of a case file, with its problems."""
        name = text_of(asked, "path")
        text, digest = self.workplace.read_case(name)
        return {"text": text, "digest": digest, **self._checked(name, text)}

    def check(self, asked: Asked) -> Answer:
        """Return the problems of a text that is not saved."""
        return self._checked(text_of(asked, "path"), text_of(asked, "text"))

    def save(self, asked: Asked) -> Answer:
        """Write a case file, and return its problems."""
        name, text = text_of(asked, "path"), text_of(asked, "text")
        digest = self.workplace.write_case(name, text, text_of(asked, "digest"))
        return {"text": text, "digest": digest, **self._checked(name, text)}

    def name(self, asked: Asked) -> Answer:
        """Give the faces of a selector a name, perhaps with a condition, in the case file."""
        return self.save({**asked, "text": self._parts.named(asked)})

    def set(self, asked: Asked) -> Answer:
        """Write the value of a field into the case file, and return the line where it stands."""
        answer = self.save({**asked, "text": with_field(asked)})
        return {**answer, "line": line_of(answer["text"], path_of(asked))}

    def mesh(self, asked: Asked) -> Answer:
        """Return the mesh that a text makes, as it is drawn."""
        path = self.workplace.case_path(text_of(asked, "path"))
        return self._scenes.mesh(text_of(asked, "text"), path)

    def moment(self, asked: Asked) -> Answer:
        """Return the last moment of a run, as it is drawn."""
        folder = self.workplace.path(text_of(asked, "results"))
        return self._scenes.moment(folder, text_of(asked, "field"))

    def expect(self, asked: Asked) -> Answer:
        """Return the time that a run of a text will take, by earlier ones of the folder."""
        path = self.workplace.case_path(text_of(asked, "path"))
        names = self.workplace.files()["results"]
        folders = ((name, self.workplace.path(name)) for name in names)
        return expectation(text_of(asked, "text"), path, number_of(asked, "cells"), folders)

    def _checked(self, name: str, text: str) -> Answer:
        return checked(text, self.workplace.case_path(name))

    def command(self, asked: Asked) -> Answer:
        """Start a command of castx on a case file."""
        name = text_of(asked, "path")
        kind = text_of(asked, "command")
        if kind == "new":
            return self._start(new_arguments(self.workplace, asked), asked)
        path = self.workplace.case_path(name) if kind != "report" else self.workplace.path(name)
        if not path.exists():
            raise CaseError(f"{name} is not there; save it first")
        if kind != "report" and self._changed(name, word_of(asked, "digest")):
            raise CaseError(
                f"{name} has changed on the disk since the page read it; look at it first"
            )
        if kind == "check":
            arguments = ["check", name]
        elif kind == "run":
            self._results(name)
            arguments = ["run", name, *(["--restart"] if asked.get("restart") is True else [])]
        elif kind == "report":
            arguments = ["report", name]
        else:
            raise CaseError(f"no command {word_of(asked, 'command')!r}")
        return self._start(arguments, asked)

    def _start(self, arguments: list[str], asked: Asked) -> Answer:
        return self.commands.start(arguments, number_of(asked, "columns")).state()

    def _results(self, name: str) -> str | None:
        """Return the name of the results folder of a case; None: the case cannot be run.

        Raises:
            CaseError: it lies outside the folder.
        """
        text, _ = self.workplace.read_case(name)
        case = self._checked(name, text)["case"]
        if case is None:
            return None
        return self.workplace.name_of(self.workplace.folder / case["results"])

    def state(self, asked: Asked) -> Answer:
        """Return the output of the last command, the progress of a run, and news of a case file."""
        last = self.commands.last
        folder = word_of(asked, "results")
        run = None
        if folder is not None:
            path = self.workplace.path(folder)
            run = self._progress.state(path, number_of(asked, "version"))
            run["report"] = (path / REPORT).is_file()
            run["checkpoint"] = (path / CHECKPOINT).is_dir()
        return {
            "command": None if last is None else last.state(number_of(asked, "since")),
            "run": run,
            "changed": self._changed(word_of(asked, "path"), word_of(asked, "digest")),
        }

    def _changed(self, name: str | None, digest: str | None) -> bool:
        """Return whether a case file has another text than the page read."""
        if name is None or digest is None or not self.workplace.case_path(name).is_file():
            return False
        return self.workplace.read_case(name)[1] != digest

    def stop(self, asked: Asked) -> Answer:
        """Tell the command to stop."""
        if self.commands.last is not None:
            self.commands.last.stop()
        return {}

    def show(self, asked: Asked) -> Answer:
        """Return the address at which a tab of its own shows a report or a picture."""
        name = text_of(asked, "path")
        if not name.endswith(SHOWN) or not self.workplace.path(name).is_file():
            raise CaseError(f"{name} is no page or picture that can be shown")
        return {"address": f"/show/{self._session.ticket(name)}"}
