"""Who holds a claim: processes, named so that others on the same machine can tell whether they still live."""

from __future__ import annotations

import os
import socket
import uuid
from pathlib import Path


def new_owner() -> str:
    """Return a name for this process that no other has: host, process, when it began, and a random part."""
    return f"{socket.gethostname()}/{os.getpid()}/{_beginning(os.getpid())}/{uuid.uuid4().hex[:12]}"


def has_died(owner: str) -> bool:
    """Tell whether an owner was a process of this machine that is gone; of other machines only the lease tells."""
    parts = owner.rsplit("/", 3)
    if len(parts) != 4 or parts[0] != socket.gethostname():
        return False
    process, beginning = parts[1], parts[2]
    if not process.isdigit():
        return False
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return True
    except OSError:
        return False
    return beginning != _beginning(int(process))  # the number went to another process


def _beginning(process: int) -> str:
    """Return when a process began, in the clock ticks of the system; an empty text where it does not tell."""
    try:
        return Path(f"/proc/{process}/stat").read_text(encoding="ascii", errors="replace").rsplit(")", 1)[1].split()[19]
    except (OSError, IndexError):
        return ""


def cores() -> int:
    """Return the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
