"""The pages of the manual: linedrawd(1) from the words of `linedrawd --help`, linedrawd.toml(5) from the settings."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

FILES = {
    "/etc/linedrawd/linedrawd.toml": "every setting, with its reason and the value that holds while it is not set",
    "/var/lib/linedrawd/inbox": "what is dropped here is drawn; the group linedrawd may",
    "/var/lib/linedrawd/jobs": "a folder for each job: what was given, understood and drawn",
    "/var/log/linedrawd/linedrawd.log": "what happened; `linedrawd report JOB` makes one file of all that is of a job",
    "/usr/share/doc/linedrawd": "install.md, operating.md, errors.md and their neighbours",
}


def settings(text: str, *, version: str, date: str) -> str:
    """Of the settings file as it is shipped."""
    lines = [
        f'.TH LINEDRAWD.TOML 5 "{date}" "linedrawd {version}" "File Formats"',
        ".SH NAME",
        "linedrawd.toml \\- the settings of linedrawd",
        ".SH DESCRIPTION",
        f".nf\n{_plain(text)}\n.fi",
        ".SH SEE ALSO",
        ".BR linedrawd (1)",
    ]
    return "\n".join(lines) + "\n"


def commands(parser: argparse.ArgumentParser, *, version: str, date: str) -> str:
    """In the words of man(7). date: as 2026-11-24."""
    description = str(parser.description)
    lines = [
        f'.TH LINEDRAWD 1 "{date}" "linedrawd {version}" "User Commands"',
        ".SH NAME",
        "linedrawd \\- " + _plain(description.partition(":")[0].lower()),
        ".SH SYNOPSIS",
        ".B linedrawd\n[\\fIoptions\\fR]\n[\\fIcommand\\fR ...]",
        ".SH DESCRIPTION",
        _plain(description),
        ".SH OPTIONS",
        *_options(parser),
        ".SH COMMANDS",
        "Without a command it is the daemon.",
        *(line for words, command, said in _commands(parser) for line in _command(words, command, said)),
        ".SH FILES",
        *(f".TP\n.I {_plain(file)}\n{_plain(said)}" for file, said in FILES.items()),
        ".SH EXAMPLES AND EXIT STATUS",
        f".nf\n{_plain(str(parser.epilog))}\n.fi",
        ".SH SEE ALSO",
        ".BR linedrawd.toml (5)",
    ]
    return "\n".join(lines) + "\n"


def _commands(parser: argparse.ArgumentParser, words: str = "") -> Iterator[tuple[str, argparse.ArgumentParser, str]]:
    """Each command that has no others below it, in its order: its words, itself, and what is said of it in the list."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            said = {choice.dest: choice.help or "" for choice in action._choices_actions}
            for name, command in action.choices.items():
                below = list(_commands(command, f"{words}{name} "))
                yield from below or [(words + name, command, said.get(name, ""))]


def _command(words: str, command: argparse.ArgumentParser, said: str) -> Iterator[str]:
    usage = " ".join(command.format_usage().split()).removeprefix(f"usage: {command.prog} ")
    yield f".SS linedrawd {_plain(words)}"
    yield _plain(usage.replace("[-h] ", "").replace("[-h]", "")) + "\n.PP"
    yield _plain(str(command.description or said).rstrip(".")) + "."
    yield from _options(command)


def _options(parser: argparse.ArgumentParser) -> Iterator[str]:
    """What --help says of each option and word, but for the commands, and --help itself."""
    formatter = argparse.HelpFormatter(parser.prog)
    for action in parser._actions:
        is_told = action.help not in (None, argparse.SUPPRESS) and "--help" not in action.option_strings
        if is_told and not isinstance(action, argparse._SubParsersAction):
            yield f".TP\n\\fB{_plain(formatter._format_action_invocation(action))}\\fR"
            yield _plain(formatter._expand_help(action))


def _plain(text: str) -> str:
    """Nothing of it is taken for an order to the typesetter."""
    safe = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("`", "\\(ga")
    return "\n".join(f"\\&{line}" if line.startswith(".") else line for line in safe.splitlines())
