"""Which encoding a table is in: recognised beyond doubt, or asked back; never read as another text."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from synth.batches.row_table import read_table
from synth.errors import InputError
from synth.tables.encodings import ALPHABETS, decoded, known_encoding
from synth.tables.reading import load_table
from tests.terminal.entry import in_process

SURE = [
    ("cp1252", "Größe [mm²];Länge;Übermaß ± 5 °C;J [kg·m²];V [dm³];Ø 20;1 ¾ in"),
    ("cp1252", "Kupplungsbelag „grob“ – fein;5 €"),
    ("cp1252", "plaque à friction carrée"),
    ("cp1252", "stålplåt, häl"),
    ("cp1252", "cuña nº 3"),
    ("cp1252", "aço à prova"),
    ("cp1250", "třecí obložení č. 1"),
    ("cp1250", "řezaná"),
    ("cp1250", "płyta cierna węglowa"),
    ("cp1250", "przemysł"),
    ("cp1250", "Łożysko"),
    ("cp1250", "žeľezo"),
    ("cp932", "摩擦板 カタログ"),
    ("cp932", "鋼板 厚さ [mm]"),
    ("cp932", "鋼板"),
]


@pytest.mark.parametrize(("encoding", "text"), SURE)
def test_what_is_of_one_language_in_one_page_is_recognised(encoding: str, text: str) -> None:
    raw = f"a;b\r\n{text};1\r\n".encode(encoding)
    assert decoded(raw, "x.csv") == (raw.decode(encoding), encoding)


@pytest.mark.parametrize(
    ("encoding", "text", "other"),
    [
        ("cp1250", "čep", "cp1252 for 'èep' or --encoding cp1250 for 'čep'"),
        ("cp1250", "acélőr", "cp1252 for 'acélõr' or --encoding cp1250 for 'acélőr'"),
        ("cp1252", "løsøre", "cp1252 for 'løsøre' or --encoding cp1250 for 'lřsřre'"),
        ("cp1252", "pièce", "cp1252 for 'pièce' or --encoding cp1250 for 'pičce'"),
    ],
)
def test_what_may_be_two_texts_is_asked_back_with_both(encoding: str, text: str, other: str) -> None:
    with pytest.raises(InputError) as asked:
        decoded(f"a;b\n1;{text}\n".encode(encoding), "x.csv")
    assert asked.value.field == "x.csv, line 2"
    assert other in asked.value.expected
    assert decoded(f"a;b\n1;{text}\n".encode(encoding), "x.csv", encoding) == (f"a;b\n1;{text}\n", encoding)


@pytest.mark.parametrize(
    ("encoding", "text"),
    [
        ("cp1251", "Диск сцепления"),
        ("cp1253", "ελαστική"),
        ("cp1254", "ğışık"),
        ("gbk", "摩擦片 钢"),
        ("big5", "摩擦片 鋼"),
        ("euc-jp", "マサツ"),
        ("euc-kr", "마찰판"),
        ("cp850", "Länge"),
        ("cp437", "Länge"),
        ("mac-roman", "Größe"),
    ],
)
def test_what_is_in_no_page_that_is_known_is_asked_back(encoding: str, text: str) -> None:
    with pytest.raises(InputError, match=r"x\.csv, line 2: .*--encoding"):
        decoded(f"a;b\n{text};1\n".encode(encoding), "x.csv")
    assert decoded(f"{text};1\n".encode(encoding), "x.csv", encoding)[0] == f"{text};1\n"


LETTERS = {page: [sorted({*a, *a.upper()} - {"SS"}) for a in alphabets] for page, alphabets in ALPHABETS.items()}
PAGES = st.sampled_from(sorted(ALPHABETS))
ASCII = st.text(st.characters(min_codepoint=97, max_codepoint=122), min_size=1, max_size=4)


@given(st.data(), PAGES)
@settings(deadline=None, derandomize=True, max_examples=300)
def test_a_text_is_read_as_it_was_written_or_asked_back(data: st.DataObject, page: str) -> None:
    letters = data.draw(st.sampled_from(LETTERS[page]))
    parts = data.draw(st.lists(ASCII | st.sampled_from(letters) | st.sampled_from([" ", ";", "°", " – "]), min_size=1))
    raw = "".join(parts).encode(page, "ignore")
    assume(raw.isascii() or raw.decode("utf-8", "ignore").encode() != raw)  # two capitals may be one letter of UTF-8
    try:
        text, _ = decoded(raw, "x.csv")
    except InputError as asked:
        assert "--encoding" in asked.expected  # noqa: PT017
    else:
        assert text == raw.decode(page)


def test_encodings_by_name() -> None:
    assert known_encoding("Shift_JIS", "encoding") == "shift_jis"
    for name in ("cp99", "", "base64", "hex", "rot13", "\0", "x" * 999):
        with pytest.raises(InputError, match="encoding"):
            known_encoding(name, "encoding")
    with pytest.raises(InputError, match=r"x\.csv, line 2: .*expected text in shift_jis, as is stated"):
        decoded(b"a\n\x81", "x.csv", "shift_jis")


def test_an_encoding_behind_the_name(tmp_path: Path) -> None:
    own = tmp_path / "own.csv"
    own.write_bytes("designation;mass [kg]\nčep;1,5\n".encode("cp1250"))
    table = load_table(Path(f"{own}#encoding=cp1250"), shipped=False)
    assert (table.name, table.designations) == ("own", ("čep",))
    assert table.readings == (
        "own.csv: semicolons between the columns, text in Windows-1250, decimal commas in mass [kg]",
    )
    rows = read_table(f"{own}#encoding=cp1250")
    assert [cells[0] for _, cells in rows.lines()] == ["čep"]
    assert rows.digest() != read_table(own).digest()
    for wrong in ("#encoding=cp99", "#rows=visible", "#encoding=cp1250#encoding=cp1252"):
        with pytest.raises(InputError):
            load_table(Path(f"{own}{wrong}"), shipped=False)


@pytest.mark.slow
def test_rows_of_a_batch_in_an_encoding_that_is_stated(tmp_path: Path) -> None:
    header = "stroj;load_torque [N*m];driver_speed [1/min];driven_inertia [kg*m2]"
    (tmp_path / "rows.csv").write_bytes(f"{header}\nčep;60,5;1500;0,5\n".encode("cp1250"))
    words = ["batch", "rows.csv", "-o", "out", "--family", "cone_clutch", "--points", "1", "--objective", "mass"]
    done = in_process(*words, folder=tmp_path)
    assert done.returncode == 2
    assert "--encoding cp1250 for 'čep'" in done.stderr
    done = in_process(*words, "--encoding", "cp1250", folder=tmp_path)
    assert done.returncode == 0
    assert "text in Windows-1250" in done.stderr
    assert "čep" in (tmp_path / "out" / "designs.csv").read_text(encoding="utf-8")
