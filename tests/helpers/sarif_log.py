"""SARIF as a reader takes it: the part of the standard that polhode writes, and how edits are applied."""

from __future__ import annotations

from typing import Any, Final

__all__ = ["SCHEMA", "apply_fixes"]

WHOLE: Final = {"type": "integer", "minimum": 1}
COUNT: Final = {"type": "integer", "minimum": 0}
WORDS: Final = {"type": "string", "minLength": 1}


def _object(needed: str, **properties: Any) -> dict[str, Any]:
    """An object that has no other properties than these."""
    return {
        "type": "object",
        "additionalProperties": False,
        "required": needed.split(),
        "properties": properties,
    }


def _many(items: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {"type": "array", "items": items, **more}


MESSAGE: Final = _object("text", text=WORDS)
RICH: Final = _object("text", text=WORDS, markdown=WORDS)
LEVEL: Final = {"enum": ["none", "note", "warning", "error"]}
PLACE: Final = _object(
    "uri", uri={"type": "string", "pattern": r"^[^\s\\]+$"}, uriBaseId={"const": "%SRCROOT%"}
)
# Of section 3.30: text by lines and columns from 1, and bytes from 0.
REGION: Final = _object(
    "startLine startColumn endLine endColumn byteOffset byteLength",
    startLine=WHOLE,
    startColumn=WHOLE,
    endLine=WHOLE,
    endColumn=WHOLE,
    byteOffset=COUNT,
    byteLength=COUNT,
)
CHANGE: Final = _object(
    "artifactLocation replacements",
    artifactLocation=PLACE,
    replacements=_many(
        _object("deletedRegion", deletedRegion=REGION, insertedContent=_object("text", text=WORDS)),
        minItems=1,
    ),
)
RESULT: Final = _object(
    "ruleId ruleIndex level message locations partialFingerprints properties",
    ruleId=WORDS,
    ruleIndex=COUNT,
    level=LEVEL,
    message=MESSAGE,
    locations=_many(
        _object(
            "physicalLocation logicalLocations",
            physicalLocation=_object("artifactLocation", artifactLocation=PLACE, region=REGION),
            logicalLocations=_many(_object("name", name=WORDS, fullyQualifiedName=WORDS, kind=WORDS)),
        ),
        minItems=1,
        maxItems=1,
    ),
    partialFingerprints={"type": "object", "additionalProperties": WORDS},
    properties={"type": "object"},
    fixes=_many(
        _object("artifactChanges", description=MESSAGE, artifactChanges=_many(CHANGE, minItems=1)),
        uniqueItems=True,
    ),
    baselineState={"enum": ["new", "unchanged", "updated", "absent"]},
    suppressions=_many(
        _object(
            "kind",
            kind={"enum": ["inSource", "external"]},
            status={"enum": ["accepted", "underReview", "rejected"]},
            justification=WORDS,
        )
    ),
)
NOTE: Final = _object("message", level=LEVEL, message=MESSAGE, locations=_many({"type": "object"}))
RULE: Final = _object(
    "id",
    id=WORDS,
    name=WORDS,
    shortDescription=RICH,
    fullDescription=RICH,
    help=RICH,
    defaultConfiguration=_object("level", level=LEVEL),
)
RUN: Final = _object(
    "tool results",
    tool=_object(
        "driver",
        driver=_object(
            "name", name=WORDS, version=WORDS, semanticVersion=WORDS, rules=_many(RULE, uniqueItems=True)
        ),
    ),
    columnKind={"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
    originalUriBaseIds={"type": "object", "additionalProperties": _object("uri", uri=WORDS)},
    artifacts=_many(_object("location", location=PLACE), uniqueItems=True),
    invocations=_many(
        _object(
            "executionSuccessful",
            executionSuccessful={"type": "boolean"},
            exitCode={"type": "integer"},
            toolExecutionNotifications=_many(NOTE),
        )
    ),
    results=_many(RESULT),
)
#: The part of SARIF 2.1.0 that polhode writes; whatever else stands in a file is refused.
SCHEMA: Final = _object(
    "version runs",
    **{"$schema": {"type": "string", "format": "uri"}, "version": {"const": "2.1.0"}, "runs": _many(RUN)},
)


def apply_fixes(source: bytes, run: dict[str, Any]) -> bytes:
    """Apply the fixes of all results to the one file that they change, by lines and columns."""
    found = [
        replacement
        for result in run["results"]
        for fix in result.get("fixes", [])
        for change in fix["artifactChanges"]
        for replacement in change["replacements"]
    ]
    mark = b"\xef\xbb\xbf"
    head = mark if source.startswith(mark) else b""
    # Columns count UTF-16, and a byte order mark is no character of the first line.
    lines = [line.encode("utf-16-le") for line in source.removeprefix(mark).decode().split("\n")]
    ends = [0]
    for line in lines:
        ends.append(ends[-1] + len(line) + 2)
    text = "\n".encode("utf-16-le").join(lines)

    def place(region: dict[str, int], end: str) -> int:
        return ends[region[f"{end}Line"] - 1] + 2 * (region[f"{end}Column"] - 1)

    for one in sorted(found, key=lambda one: place(one["deletedRegion"], "start"), reverse=True):
        start, stop = (place(one["deletedRegion"], end) for end in ("start", "end"))
        inserted = one.get("insertedContent", {"text": ""})["text"].encode("utf-16-le")
        text = text[:start] + inserted + text[stop:]
    return head + text.decode("utf-16-le").encode()
