"""The most that a user may ask for at once: one record, so that every door refuses the same."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class InputLimits:
    """Maxima of what users state, all counts (of files in bytes); ``docs/specs.md`` lists them.

    Parameters
    ----------
    message : int
        Characters of the input that a message repeats in one place.
    points : int
        Designs of a front: its record, of 5 to 11 kB per design and up to 23 kB where much scatters, must stay well
        within the size of a file that is read back.
    limits : int
        Limits of one question, on all quantities together.
    steps : int
        Steps of a study.
    seed : int
        What random choices begin with.
    workers : int
        Processes or threads.
    samples : int
        Points at which the yield of a design is counted.
    scattered : int
        Things that scatter at a time.
    columns : int
        Columns of a table of rows.
    rows : int
        Rows of such a table: its file is read row by row, so that rows are what costs.
    row : int
        Characters of one of them, or of any row of a CSV file.
    families : int
        Families that are compared.
    listed : int
        Near-equal designs, variants or candidates for them.
    file : int
        Of any file that is read as a whole: nobody types more, and nothing of ours that is read again has more.
    spec_file : int
        Of a spec, which is written by hand: anything larger is another kind of file.
    workbook : int
        Of an Excel file when it is unpacked: sheets are packed to a fifth or a tenth.
    quantity : int
        Characters of a number, and of a unit.
    condition : int
        Characters of a condition of parts.
    nesting : int
        Brackets and nots of a condition inside each other.
    """

    message: int = 120
    points: int = 500
    limits: int = 200
    steps: int = 1000
    seed: int = 2**64 - 1
    workers: int = 1024
    samples: int = 2**20
    scattered: int = 8
    columns: int = 2000
    rows: int = 2_000_000
    row: int = 1_000_000
    families: int = 100
    listed: int = 10_000
    file: int = 20_000_000
    spec_file: int = 1_000_000
    workbook: int = 200_000_000
    quantity: int = 100
    condition: int = 10_000
    nesting: int = 50


INPUT_LIMITS = InputLimits()
