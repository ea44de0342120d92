"""What engine processes do: names of tasks, and where their functions stand. Light; the functions are not.

A task is a function of two arguments, what it is asked and a callable that takes how far it is, and returns what the
other side shall have. Nothing else can be called from outside of a process.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

ReportProgress = Callable[[Mapping[str, Any]], None]
Task = Callable[[Any, ReportProgress], Any]

ROWS_TASK, PLAN_TASK, WORK_TASK, READ_TASK = "rows", "plan", "work", "read"
CHECK_ROWS_TASK, BATCH_FILE_TASK = "check_rows", "batch_file"
FAMILIES_TASK, DECLARATION_TASK, EXAMPLES_TASK = "families", "declaration", "examples"
CHECK_TASK, EVALUATE_TASK, CHANGED_TASK = "check", "evaluate", "changed"
FILES_TASK, RENDER_TASK, DESIGNS_TASK = "files", "render", "designs"
UPLOAD_TASK, TABLE_TEXT_TASK, PART_TABLE_TASK = "upload", "table_text", "part_table"
TABLES_TASK = "tables"
TASKS: Mapping[str, str] = MappingProxyType(
    {
        ROWS_TASK: "synth.workers.engine_work:rows",
        PLAN_TASK: "synth.kinds.batch:plan",
        WORK_TASK: "synth.workers.engine_work:work",
        READ_TASK: "synth.workers.engine_work:read",
        CHECK_ROWS_TASK: "synth.kinds.batch:check",
        BATCH_FILE_TASK: "synth.kinds.batch:files",
        FAMILIES_TASK: "synth.workers.engine_questions:families",
        DECLARATION_TASK: "synth.workers.engine_questions:declaration",
        EXAMPLES_TASK: "synth.workers.engine_questions:examples",
        CHECK_TASK: "synth.workers.engine_questions:check",
        EVALUATE_TASK: "synth.workers.engine_questions:evaluate",
        CHANGED_TASK: "synth.workers.engine_questions:changed",
        FILES_TASK: "synth.workers.engine_questions:files",
        RENDER_TASK: "synth.workers.engine_questions:render",
        DESIGNS_TASK: "synth.kinds.designs:page",
        UPLOAD_TASK: "synth.kinds.brought:rows_of_file",
        TABLE_TEXT_TASK: "synth.kinds.brought:text_of_file",
        PART_TABLE_TASK: "synth.kinds.brought:part_table",
        TABLES_TASK: "synth.kinds.shipped:tables",
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
    task: Task = getattr(import_module(module), function)
    return task
