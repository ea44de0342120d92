"""Who holds a claim: processes, named so that others on the same machine can tell whether they still live."""

from __future__ import annotations

import os
import socket
import uuid

from synth.system.operating_system import beginning, is_alive


def new_owner() -> str:
    """Return a name for this process that no other has: host, process, when it began, and a random part."""
    return f"{socket.gethostname()}/{os.getpid()}/{beginning(os.getpid())}/{uuid.uuid4().hex[:12]}"


def has_died(owner: str) -> bool:
    """True if an owner was a process of this machine that is gone; of other machines only the lease tells."""
    parts = owner.rsplit("/", 3)
    if len(parts) != 4 or parts[0] != socket.gethostname():
        return False
    process, begun = parts[1], parts[2]
    if not process.isdigit():
        return False
    return not is_alive(int(process)) or begun != beginning(int(process))  # or its number went to another process
