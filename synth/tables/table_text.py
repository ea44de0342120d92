"""Tables that are no files: their text, under the reference by which a question names them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True, kw_only=True)
class TableText:
    """A table of a user's own as the text of a CSV file.

    Parameters
    ----------
    reference : str
        By which questions name it: ``my_linings@3``. Whoever keeps the text never changes it under the same reference.
    csv : str
        What would stand in the file.
    schema : str
        What would stand in the schema file beside it; nothing where it has none.
    """

    reference: str
    csv: str
    schema: str = ""

    @cached_property
    def digest(self) -> str:
        """SHA-256 of both texts."""
        return hashlib.sha256(self.csv.encode() + b"\0" + self.schema.encode()).hexdigest()
