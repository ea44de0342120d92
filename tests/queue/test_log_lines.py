"""The log of a service is JSON, line by line, whatever its processes say."""

from __future__ import annotations

import io
import json
import subprocess
import sys
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from synth.queue.log_lines import JsonLines, log_line
from tests.waiting import PATIENCE

SPEAKS = """
import logging, multiprocessing, sys, threading, warnings

from synth.queue.log_lines import follow_switch, json_lines, log_line
from synth.queue.served_process import begin_to_serve


def child():
    begin_to_serve()
    warnings.warn("of a child")
    raise ValueError("in a child cs_0123456789012345678901234567890123")


if __name__ == "__main__":
    with json_lines():
        print(log_line("request", status=200), file=sys.stderr)
        print("two\\nlines", file=sys.stderr)
        warnings.warn("divide by zero")
        logging.getLogger("somebody").error("not closed")
        thread = threading.Thread(target=lambda: 1 / 0)
        thread.start()
        thread.join()
        process = multiprocessing.get_context("spawn").Process(target=child)
        process.start()
        process.join()
        print("no end", end="", file=sys.stderr)
    print("plain again", file=sys.stderr)
"""


def test_all_that_is_said_is_json(tmp_path: Any) -> None:
    program = tmp_path / "speaks.py"
    program.write_text(SPEAKS)
    done = subprocess.run([sys.executable, program], capture_output=True, text=True, check=True, timeout=PATIENCE)
    *lines, last = done.stderr.splitlines()
    assert last == "plain again"
    told = [json.loads(line) for line in lines]
    assert told[0]["status"] == 200
    texts = [line["text"] for line in told if line["event"] == "said"]
    assert texts[:2] == ["two", "lines"]
    assert texts[-1] == "no end"
    for part in ("divide by zero", "not closed", "ZeroDivisionError", "of a child", "in a child cs_..."):
        assert [text for text in texts if part in text], part
    assert len({line["process"] for line in told if "process" in line}) == 2


@given(st.lists(st.text(st.characters(exclude_categories=("Cs",), exclude_characters="{"), max_size=12)))
def test_any_text_comes_as_lines_of_json(parts: list[str]) -> None:
    kept = io.StringIO(newline="")
    stream = JsonLines(kept)
    for part in parts:
        assert stream.write(part) == len(part)
    stream.close_lines()
    told = [json.loads(line) for line in kept.getvalue().split("\n")[:-1]]
    assert all(isinstance(line, dict) for line in told)
    assert [line["text"] for line in told] == [line for line in "".join(parts).split("\n") if line.strip()]


def test_what_is_a_line_of_the_log_stays_as_it_is() -> None:
    kept = io.StringIO()
    line = log_line("request", path="a\nb", token=3)
    JsonLines(kept).write(f"{line}\n")  # type: ignore[arg-type]
    assert kept.getvalue() == f"{line}\n"
