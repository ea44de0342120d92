"""Databases as the tests of the queue have them."""

from __future__ import annotations

from tests.queue.conftest import database, emptied, new_database  # noqa: F401  (fixtures)
