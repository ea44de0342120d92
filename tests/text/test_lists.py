"""Lists of names with commas between them, where names have commas themselves."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from synth.batches.batch import batch
from synth.text.plain_text import as_list, listed

names = st.text('ab,"/ 3').map(str.strip).filter(bool)


@given(st.lists(names, min_size=1, max_size=5))
@settings(deadline=None, derandomize=True, max_examples=300)
def test_lists_are_read_as_they_were_written(several: list[str]) -> None:
    assert listed(as_list(several)) == several


def test_quotes_that_do_not_close_mean_nothing() -> None:
    assert listed('"core 2, core 3') == ['"core 2', "core 3"]
    assert listed("core 2,,core 3") == ["core 2", "", "core 3"]
    assert listed("") == [""]


def test_designations_with_commas_from_table_to_result(tmp_path: Path) -> None:
    (tmp_path / "core_plates.csv").write_text('designation,thickness [mm]\n"stock, thin",1.9\n"stock, thick",2.4\n')
    row = (
        "load_torque,driver_speed,driven_inertia,fix,parts\n600 N*m,254 rpm,30,ramp_time = 2 s; friction_surfaces = 10"
    )
    cell = 'friction_pair = paper_wet; outer_plate: ""stock, thin"", ""stock, thick""; inner_plate: ""stock, thin""'
    (tmp_path / "rows.csv").write_text(f'{row},"{cell}"\n')
    result = batch(
        "multi_plate_clutch",
        tmp_path / "rows.csv",
        tmp_path / "out",
        objectives=["mass"],
        points=1,
        catalogs={"core_plates": str(tmp_path / "core_plates.csv")},
    )
    assert result.counts == {"optimal": 1}, result.rows()["explanation"].tolist()
    assert result.designs()[["inner_plate", "outer_plate"]].values.tolist() == [["stock, thin", "stock, thin"]]
