"""What a message has to say so that its reader knows the way out."""

from __future__ import annotations

import re

__all__ = ["LEAVE_OUT", "commands_in", "names_way_out"]

_VERBS = (
    "add|ask|call|check|choose|close|correct|create|cut|divide|end|expand|export|give|heal|integrate|keep|leave|lower|"
    "model|name|orient|pack|pass|pickle|place|put|read|remove|rename|reverse|save|set|search|send|start|state|take|"
    "triangulate|unpack|use|write"
)
_WAY_OUT = re.compile(
    rf"(?:[;:,] |\(|\bor )(?:first |either )?(?:{_VERBS})\b"  # what to do
    r"|^(?:[\w-]+: )?(?:give|state|write) "
    r"|\bexpected |\bmust | (?:has|have) to stand|\bnot expected\b|\bmay be "  # what is right
    r"|is (?:it|the file) cut short\?|[Dd]id you mean|Choose from|\bmeant\?|for example "
    r"|say so: |polhode \w+ (?:reads|judges|tells)|; .*RigidBody\.from_|; words for the reader may stand in"
    r"|pip install |with_way_out\(|; a rotation keeps"
)

LEAVE_OUT = re.compile(
    r"leave (?:it|(?P<option>--[a-z-]+)|one of the two) out|leave out (?P<other>--[a-z-]+)"
)


def names_way_out(message: str) -> bool:
    """Whether a message says what to do, or what would be right."""
    return bool(_WAY_OUT.search(message))


def commands_in(message: str) -> set[str]:
    """Options and commands that a message names behind what it is about."""
    text = message.removeprefix("polhode: ")
    text = re.sub(r"^--[a-z-]+(?: and --[a-z-]+)?: ", "", text)
    text = re.sub(r"\(see polhode[a-z -]*--help\)", "", text)
    return set(re.findall(r"(?<![\w-])--[a-z][a-z-]*|polhode [a-z]+(?= reads| judges)|gunzip", text))
