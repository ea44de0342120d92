"""The package ``formulas`` computes spreadsheets without any: an engine that knows nothing of ours."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np


@cache
def engine() -> Any:
    """Return the package; it is slow to import and warns of its own code, so nobody collects tests with it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import formulas
    return formulas


def computed(text: str, values: Mapping[str, float]) -> float:
    """Return what a formula of names comes to; not-a-number where it is an error."""
    function = engine().Parser().ast("=" + text)[1].compile()
    told = {name.upper(): value for name, value in values.items()}
    with np.errstate(all="ignore"):
        found = function(*(told[name] for name in function.inputs))
    try:
        return float(np.asarray(found, dtype=object).ravel()[0])
    except (TypeError, ValueError):
        return math.nan


class Spreadsheet:
    """A workbook whose cells can be typed into and are computed again."""

    def __init__(self, path: Path) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self._model = engine().ExcelModel().loads(str(path)).finish()
        self._book = path.name

    def with_typed(self, cells: Mapping[tuple[str, str], Any]) -> Any:
        """Return what tells the cells of the workbook after some were typed: by sheet and address, None for errors."""
        inputs = {self._key(*place): value for place, value in cells.items()}
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            found = dict(self._model.calculate(inputs=inputs or None).items())

        def cell(sheet: str, address: str) -> Any:
            value = found[self._key(sheet, address)].value[0, 0]
            if isinstance(value, (bool, np.bool_)):
                return bool(value)
            if isinstance(value, (int, float, np.number)):
                return float(value)
            return None if str(value).startswith("#") else str(value)

        return cell

    def _key(self, sheet: str, address: str) -> str:
        return f"'[{self._book}]{sheet.upper()}'!{address}"
