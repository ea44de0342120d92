"""What tests of families read from a question and from a design."""

from synth.question.catalogs import as_catalogs
from tests.asking import instance_of


def requirements_in_si(problem, requirements):
    """Return all requirements as simulations and curves take them: in SI, None where an optional one is not given."""
    instance = instance_of(problem, requirements, as_catalogs(None))
    return {name: instance.values.requirements.get(name) for name in instance.model.declaration.requirements}


def remarks(found):
    """Return the names of the remarks on a design."""
    return {text.split(":")[0] for text in found.advice}
