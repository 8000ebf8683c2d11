"""A wheel without traces of its machine: no path, time, random number or file mask; entries in order."""

from __future__ import annotations

import base64
import hashlib
import json
import zipfile
from pathlib import Path


def without_traces(wheel: Path, out: Path, folder: str) -> None:
    """Write the wheel anew: its bill of materials without ``folder``, without serial number and time."""
    with zipfile.ZipFile(wheel) as old:
        files = sorted((entry for entry in old.infolist() if not entry.is_dir()), key=lambda it: it.filename)
        entries = {entry.filename: (plain_mode(entry.external_attr), old.read(entry)) for entry in files}
    [record] = (name for name in entries if name.endswith(".dist-info/RECORD"))
    entries[record] = entries.pop(record)  # last, as the format has it
    for name, (attributes, data) in entries.items():
        if name.endswith(".cyclonedx.json"):
            entries[name] = (attributes, without_chance(data, folder))
    entries[record] = (
        entries[record][0],
        "".join(line(name, data) for name, (_, data) in entries.items() if name != record).encode()
        + f"{record},,\n".encode(),
    )
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as new:
        for name, (attributes, data) in entries.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.external_attr = attributes
            entry.create_system = 3  # Unix, wherever it is made
            entry.compress_type = zipfile.ZIP_DEFLATED
            new.writestr(entry, data)


def plain_mode(attributes: int) -> int:
    """Attributes of a file that all may read, and run where its maker may."""
    return (0o100755 if attributes >> 16 & 0o100 else 0o100644) << 16


def without_chance(data: bytes, folder: str) -> bytes:
    """A bill of materials that is the same each time."""
    bill = json.loads(data.decode().replace(folder, "/polhode"))
    bill.pop("serialNumber", None)
    bill["metadata"].pop("timestamp", None)
    return json.dumps(bill, indent=2, sort_keys=True).encode()


def line(name: str, data: bytes) -> str:
    """What RECORD says of a file."""
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(data)}\n"
