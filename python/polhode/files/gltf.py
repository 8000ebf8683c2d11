"""glTF as text: a ``.gltf`` file with its numbers beside it or in it, put into one GLB."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from pathlib import Path, PurePosixPath
from typing import Any, BinaryIO, Final
from urllib.parse import unquote

from polhode.errors import FileFormatError
from polhode.files.reading import read_bytes, text_of, with_way_out

__all__ = ["as_glb"]

_MOST_BUFFERS: Final = 1000


def as_glb(stream: BinaryIO, file: Path) -> bytes:
    """Put a glTF file and the binary files that it names into one.

    Parameters
    ----------
    stream : binary stream
    file : pathlib.Path
        Its name. Binary files are read from its own folder and those below it alone.
    """
    try:
        scene: Any = json.loads(text_of(stream, file, "a glTF file"))
        buffers = scene.get("buffers", [])
        if len(buffers) > _MOST_BUFFERS:
            raise ValueError(f"it names more than {_MOST_BUFFERS} buffers")
        starts, data = [], b""
        for buffer in buffers:
            part = _bytes_of(buffer["uri"], file)[: int(buffer["byteLength"])]
            if len(part) < int(buffer["byteLength"]):
                raise ValueError(
                    f"{buffer['uri'][:60]!r} holds {len(part)} bytes, not {buffer['byteLength']}"
                )
            starts.append(len(data))
            data += part + b"\0" * (-len(part) % 4)
        for view in scene.get("bufferViews", []):
            view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
            view["buffer"] = 0
        scene["buffers"] = [{"byteLength": len(data)}]
        for name in ("images", "textures", "materials", "samplers"):  # they change nothing of the shape
            scene.pop(name, None)
        for mesh in scene.get("meshes", []):
            for primitive in mesh["primitives"]:
                primitive.pop("material", None)
        described = json.dumps(scene).encode()
    except FileFormatError:
        raise
    except (ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        fault = with_way_out(reason[:200], "export it again")
        raise FileFormatError(f"{file}: not a readable glTF file: {fault}") from None
    described += b" " * (-len(described) % 4)
    size = 12 + 8 + len(described) + 8 + len(data)
    head = struct.pack("<5I", 0x46546C67, 2, size, len(described), 0x4E4F534A)
    return head + described + struct.pack("<2I", len(data), 0x004E4942) + data


def _bytes_of(address: str, file: Path) -> bytes:
    if address.startswith("data:"):
        kind, _, text = address.partition(",")
        if not kind.endswith(";base64"):
            raise ValueError("its numbers stand in it as something else than base64")
        try:
            return base64.b64decode(text, validate=True)
        except binascii.Error as error:
            raise ValueError(f"its numbers are no base64: {error}") from None
    path = PurePosixPath(unquote(address))
    if path.is_absolute() or ".." in path.parts or ":" in path.parts[0] or "\\" in address:
        raise ValueError(f"it names {address[:60]!r}, outside of its own folder; put it beside it")
    beside = file.parent / path
    if not beside.resolve().is_relative_to(file.parent.resolve()):
        raise ValueError(f"it names {address[:60]!r}, a link out of its own folder; put it beside it")
    return read_bytes(beside)
