"""The explorer as one HTML file, as a frame for notebooks, and as the files that a service hands out."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Mapping
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any

from synth.ui import ui_files

MODULES = "synth.reports.explorer"
FIRST = "page.js"
IMPORT = re.compile(r'^import \{([^}]*)\} from "\./([a-z]+\.js)";\n', re.MULTILINE)
EXPORT = re.compile(r"^export ((?:async )?function|class|const|let) (\w+)", re.MULTILINE)
LEAST_HEIGHT, MOST_HEIGHT = 300, 4000  # of a frame, in pixels


@cache
def explorer_files() -> dict[str, str]:
    """Return the modules and style sheets by name, as a service hands them out; ``explorer.js`` has ``mount``."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in files(MODULES).iterdir() if _handed_out(path.name)}
    return dict(sorted((texts | ui_files()).items()))


def _handed_out(name: str) -> bool:
    return name.endswith((".js", ".css"))


def explorer_page(record: Mapping[str, Any]) -> str:
    """Return the explorer of a front as one HTML file: nothing is fetched, and only the script that is meant runs.

    Parameters
    ----------
    record : mapping
        As :func:`synth.reports.explorer.record.explorer_record` returns it.
    """
    script, style = one_script(), explorer_files()["explorer.css"] + explorer_files()["page.css"]
    policy = (
        f"default-src 'none'; script-src {_digest(script)}; style-src {_digest(style)}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{escape(policy)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="{escape(str(record["program"]))}">
<title>{escape(str(record["title"]))}: explorer</title>
<link rel="icon" href="data:,">
<style>{style}</style>
</head>
<body>
<main id="explorer"></main>
<noscript><p>The explorer needs JavaScript. report.html beside it tells the same front without.</p></noscript>
<script type="application/json" id="record">{inline_json(record)}</script>
<script type="module">{script}</script>
</body>
</html>
"""


def explorer_frame(record: Mapping[str, Any], height: int = 760) -> str:
    """Return the explorer as a frame for a notebook: closed off from the page around it, without any address."""
    high = min(MOST_HEIGHT, max(LEAST_HEIGHT, int(height)))
    return (
        f'<iframe title="{escape(str(record["title"]))}: explorer" sandbox="allow-scripts allow-downloads" '
        f'width="100%" height="{high}" style="border:0" srcdoc="{escape(explorer_page(record))}"></iframe>'
    )


def inline_json(record: Mapping[str, Any]) -> str:
    """Return a record as JSON that cannot end the element it stands in."""
    text = json.dumps(record, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026").translate(LINE_ENDS)


LINE_ENDS = {0x2028: "\\u2028", 0x2029: "\\u2029"}


@cache
def one_script() -> str:
    """Return all modules as one: each in a function of its own, in order of what they import."""
    wrapped: list[str] = []
    done: set[str] = set()

    def add(name: str) -> None:
        if name in done:
            return
        done.add(name)
        text = explorer_files()[name]
        for _, other in IMPORT.findall(text):
            add(other)
        names = [match[1] for match in EXPORT.findall(text)]
        body = IMPORT.sub(lambda match: f"const {{{match[1]}}} = {_variable(match[2])};\n", text)
        body = EXPORT.sub(r"\1 \2", body)
        wrapped.append(f"const {_variable(name)} = (() => {{\n{body}return {{ {', '.join(names)} }};\n}})();\n")

    add(FIRST)
    return "".join(wrapped)


def _variable(name: str) -> str:
    return f"module_{name.removesuffix('.js')}"


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
