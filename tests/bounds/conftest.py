"""What tests of compiled boxes need."""

from collections.abc import Iterator

import pytest

from synth.bounds import compiled_boxes


@pytest.fixture(scope="module")
def compiled_quickly(own_cache: None) -> Iterator[None]:
    """Compile everything anew without optimisation: most of it is used only once, and bits do not depend on it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiled_boxes, "BOX_FLAGS", (*compiled_boxes.BOX_FLAGS, "-O0"))
        yield
