"""JavaScript modules that the explorer of reports and the pages of the service both take."""

from __future__ import annotations

from functools import cache
from importlib.resources import files


@cache
def ui_files() -> dict[str, str]:
    """Texts of the modules by name; they are served beside those that import them."""
    modules = (path for path in files(__name__).iterdir() if path.name.endswith(".js"))
    return {path.name: path.read_text(encoding="utf-8") for path in modules}


def as_script(name: str) -> str:
    """Text of a module whose functions a plain script behind it may call."""
    return ui_files()[name].replace("export ", "")
