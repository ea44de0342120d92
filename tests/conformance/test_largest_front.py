"""The largest front that can be asked for is one that can be read back."""

from dataclasses import replace

import pytest

from synth.files import LARGEST, read_bytes
from synth.input_limits import INPUT_LIMITS
from tests.conformance.cases import CASES, answer

MORE = 20_000  # bytes per design, for what scatters (12 000 where six things do) and for what ties


@pytest.mark.parametrize("family", CASES)
def test_the_largest_front_can_be_read_back(family, tmp_path):
    front = answer(family, next(iter(CASES[family].feasible.values())), points=3)
    longest = max(front.designs, key=lambda d: len(replace(front, designs=[d]).files()["front.json"]))
    text = replace(front, designs=[longest] * INPUT_LIMITS.points).files()["front.json"]
    path = tmp_path / "front.json"
    path.write_text(text)
    assert len(read_bytes(path, "front")) == len(text.encode())
    assert len(text.encode()) + MORE * INPUT_LIMITS.points < LARGEST
