"""What engine processes do: names of tasks, and where their functions stand. Light; the functions are not.

A task is a function of two arguments, what it is asked and a callable that takes how far it is, and returns what the
other side shall have. Nothing else can be called from outside of a process.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

Tell = Callable[[Mapping[str, Any]], None]
Task = Callable[[Any, Tell], Any]

ROWS_TASK, PLAN_TASK, WORK_TASK, READ_TASK = "rows", "plan", "work", "read"
CHECK_ROWS_TASK, BATCH_FILE_TASK = "check_rows", "batch_file"
TASKS: Mapping[str, str] = MappingProxyType(
    {
        ROWS_TASK: "synth.jobs.engine_work:rows",
        PLAN_TASK: "synth.jobs.kinds.batch:plan",
        WORK_TASK: "synth.jobs.engine_work:work",
        READ_TASK: "synth.jobs.engine_work:read",
        CHECK_ROWS_TASK: "synth.jobs.kinds.batch:check",
        BATCH_FILE_TASK: "synth.jobs.kinds.batch:files",
    }
)


def task_of(name: str) -> Task:
    """Return the function of a task.

    Raises
    ------
    KeyError
        There is no such task.
    """
    module, _, function = TASKS[name].partition(":")
    found: Task = getattr(import_module(module), function)
    return found
