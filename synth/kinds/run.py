"""A request alone: the kind and the mapping that a job takes, answered in this process."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from synth.batches.batch import batch
from synth.kinds import kind as kind_of
from synth.kinds.batch import ROWS, UPLOAD, must_have_one_table
from synth.model.registry import load
from synth.question.request_fields import FIELDS
from synth.question.spec_patch import patched
from synth.results import ParetoFront
from synth.robust.rate import rate
from synth.search.synthesize import synthesize
from synth.studies.families.compare import compare
from synth.studies.infeasibility.explain import explain
from synth.studies.near_optimal import near_equals
from synth.studies.prices.run import chosen_designs, prices
from synth.studies.whatif.run import whatif
from synth.variants.size_range import size_range
from synth.verbs.request import in_request, known_keys
from synth.verbs.requests import OF, SPEC, Subject
from synth.verification.verify import verify

_OTHERS: tuple[Any, ...] = (compare, whatif, explain, prices, near_equals, rate, verify, batch, size_range)
FUNCTIONS: Mapping[str, Any] = MappingProxyType(
    {"synthesis": synthesize, "report": ParetoFront.report} | {one.__name__: one for one in _OTHERS}
)


def run(kind: str, request: Mapping[str, object], **more: Any) -> Any:
    """Answer a request by itself, as the service does as a job.

    Parameters
    ----------
    kind : str
        ``synthesis``, ``compare``, ``whatif``, ``explain``, ``prices``, ``near_equals``, ``rate``, ``verify``,
        ``report``, ``batch`` or ``size_range``.
    request : mapping
        As a job takes it; a spec file holds one. What a job names by an id stands there itself: under ``of`` the
        request, front or batch, under ``upload`` the path of a table.
    **more
        What only the function of the verb takes, such as ``progress``, ``output`` of a batch or ``folder`` of a report.

    Returns
    -------
    object
        What the function of the verb returns.

    Raises
    ------
    InputError
        When there is no such kind, a key is unknown, or a value is not of its kind.
    """
    verb = kind_of(kind).verb
    about: Any = request.get(OF)
    answer, fields = FUNCTIONS[verb.name], verb.request.fields()
    entries = {key: value for key, value in request.items() if key != OF}
    if verb.about is not Subject.QUESTION:
        values = dict(vars(verb.request.read(known_keys(entries, fields), in_request)))
        if verb.about is Subject.ROWS:
            must_have_one_table(entries)
            upload, rows = values.pop(UPLOAD), values.pop(ROWS)
            return answer(values.pop("family"), upload or rows, **values, **more)
        if verb.about is Subject.DESIGNS and (ranks := values.pop("design")) is not None:
            about = chosen_designs(about, ranks)
        return answer(about, **values, **more)
    spec = known_keys(entries if about is None else patched(about, entries), (*SPEC, *fields))
    values = {key: FIELDS[key].read(in_request(key), value) for key, value in spec.items() if key in FIELDS}
    values |= vars(verb.request.read(spec, in_request))
    family, options = FIELDS["family"].read(in_request("family"), values.pop("family", None)), values.get("options", {})
    accepted = inspect.signature(answer).parameters
    problem = family if kind == "compare" else load(family, **options)
    return answer(problem, **{key: value for key, value in values.items() if key in accepted}, **more)
