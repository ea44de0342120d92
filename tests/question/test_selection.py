"""What remains of slots, counts and choices."""

import numpy as np
import pandas as pd

from synth.question.selection import Selection, SlotRows
from synth.tables.catalogs import Catalogs

RODS = pd.DataFrame({"designation": ["thin", "mid", "thick"], "diameter [mm]": [1.0, 2.0, 3.0]})


def test_a_mask_keeps_rows_values_and_labels_alike():
    table = Catalogs({"rods": RODS}).table("rods")
    rows = SlotRows("rod", table, np.arange(3), {"diameter": np.array([1.0, 2.0, 3.0])})
    selection = Selection([rows], {"strands": np.array([1.0, 2.0])}, {"end": np.array([0.0, 1.0])})
    selection.keep("rod", np.array([True, False, True]))
    selection.keep("strands", np.array([False, True]))
    selection.keep("end", np.array([True, False]))
    left = selection.slot("rod")
    assert left is not None
    assert (left.labels(), left.columns["diameter"].tolist()) == (["thin", "thick"], [1.0, 3.0])
    assert (selection.counts["strands"].tolist(), selection.choices["end"].tolist()) == ([2.0], [0.0])
    assert rows.labels() == ["thin", "mid", "thick"]
    assert selection.slot("strands") is None
