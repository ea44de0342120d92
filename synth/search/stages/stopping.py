"""What is known when the search is stopped before its end."""

from __future__ import annotations

from synth.search.front_claim import claim_no_less, note_open_boxes
from synth.search.front_state import FrontState
from synth.search.stages.spreading import different, spread


def stop_early(state: FrontState) -> None:
    """Keep the known designs when time runs out; the unresolved boxes bound the proven gap."""
    if state.reporting and state.proof.closed:
        # The designs stand; only what the objectives do not see is left as it is.
        state.proof.note_covered_within(state.rule.tolerance)
        state.proof.give_up()
        return
    note_open_boxes(state)
    state.proof.give_up()
    staircase, known = state.proof.staircase, state.form.archive
    proven = staircase.finished() if staircase is not None and len(known) else []
    candidates = spread(state, proven or list(known), state.task.oversampled)
    state.front = spread(state, different(state, candidates), state.task.settings.points)
    claim_no_less(state)
