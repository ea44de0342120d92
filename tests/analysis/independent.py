"""Computes the JSON of a calculation again: plain Python that imports nothing of clutchsynth."""

import math

TOLERANCE = 1e-6


def number(tree, values):
    kind, *rest = tree
    if kind == "q":
        return values[rest[0]]
    if kind == "n":
        return float(rest[0])
    if kind == "if":
        return number(rest[1] if number(rest[0], values) else rest[2], values)
    if kind == "f":
        return function(rest[0], [number(x, values) for x in rest[1]])
    if kind == "+":
        return sum(number(x, values) for x in rest[0])
    if kind == "*":
        over = math.prod(number(x, values) for x in rest[0])
        under = math.prod(number(x, values) for x in rest[1])
        return over / under if under else math.nan if not over else math.copysign(math.inf, over)
    a = [number(x, values) for x in rest]
    if kind == "neg":
        return -a[0]
    if kind == "not":
        return not a[0]
    if kind == "^":
        return power(*a)
    return {
        "<": lambda: a[0] < a[1],
        "<=": lambda: a[0] <= a[1],
        "==": lambda: a[0] == a[1],
        "!=": lambda: a[0] != a[1],
        "and": lambda: a[0] and a[1],
        "or": lambda: a[0] or a[1],
    }[kind]()


def power(base, exponent):
    try:
        result = base**exponent
    except (ZeroDivisionError, OverflowError):
        return math.inf
    return math.nan if isinstance(result, complex) else result


def function(name, a):
    if any(math.isnan(x) for x in a):
        return math.nan
    named = {"ln": math.log, "abs": abs, "min": min, "max": max}
    try:
        return float(named.get(name, getattr(math, name, None))(*a))
    except (ValueError, OverflowError):
        if name == "ln" and a[0] == 0:
            return -math.inf
        return math.inf if name == "exp" else math.nan


def recomputed(calculation, inputs):
    """Return all quantities, and per limit both sides, void, the verdict and the share used."""
    values = dict(inputs)
    for q in calculation["quantities"]:
        if q["kind"] in ("step", "derived", "helper"):
            values[q["name"]] = number(q["expression"], values)
    limits = calculation["limits"]
    sides = {x["name"]: (number(x["value"], values), number(x["limit"], values)) for x in limits}
    held = {x["name"]: holds(x, *sides[x["name"]]) for x in limits}
    failing = {x["name"] for x in limits if x.get("guard") and not held[x["name"]]}
    told = {}
    for x in limits:
        value, limit = sides[x["name"]]
        void = any(math.isnan(values[name]) for name in x.get("optional", ()))
        unknown = void or any(not held[guard] for guard in x.get("needs", ()))
        held[x["name"]] = held[x["name"]] or unknown
        used = None if unknown or math.isnan(value - limit) else share(x["sense"], value, limit)
        told[x["name"]] = (value, limit, void, held[x["name"]], used)
    for q in calculation["quantities"]:
        if failing & set(q.get("needs", ())):
            values[q["name"]] = math.nan
    return values, told


def holds(x, value, limit):
    size = max(abs(value), abs(limit), x["scale"])
    missed = {"at_most": value - limit, "at_least": limit - value, "equal": abs(value - limit)}[x["sense"]] / size
    return missed < 0 if x.get("guard") else missed <= TOLERANCE


def share(sense, value, limit):
    used, allowed = (limit, value) if sense == "at_least" else (value, limit)
    if sense == "equal":
        used, allowed = max(abs(value), abs(limit)), min(abs(value), abs(limit))
        same = value == limit or (value > 0) == (limit > 0)
        return 1.0 if value == limit else used / allowed if same and allowed > 0 else math.inf
    return used / allowed if used > 0 and allowed > 0 else 0.0 if used <= allowed else math.inf
