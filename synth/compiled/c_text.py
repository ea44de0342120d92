"""C text that code is generated from: templates, which are files of their own, and what operations are in C."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

import casadi as ca

# Per operation: its value from those of the arguments, which are registers.
EXPRESSIONS = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_POW: "v_pow({0}, {1})",
    ca.OP_CONSTPOW: "v_pow({0}, {1})",
    ca.OP_LT: "{0} < {1}",
    ca.OP_LE: "{0} <= {1}",
    ca.OP_EQ: "{0} == {1}",
    ca.OP_NE: "{0} != {1}",
    ca.OP_FMOD: "v_fmod({0}, {1})",
    ca.OP_COPYSIGN: "v_copysign({0}, {1})",
    ca.OP_FMIN: "v_min({0}, {1})",
    ca.OP_FMAX: "v_max({0}, {1})",
    ca.OP_ATAN2: "v_atan2({0}, {1})",
    ca.OP_HYPOT: "v_hypot({0}, {1})",
    ca.OP_NEG: "-{0}",
    ca.OP_EXP: "v_exp({0})",
    ca.OP_LOG: "v_log({0})",
    ca.OP_SQRT: "v_sqrt({0})",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "{0} + {0}",
    ca.OP_SIN: "v_sin({0})",
    ca.OP_COS: "v_cos({0})",
    ca.OP_TAN: "v_tan({0})",
    ca.OP_ASIN: "v_asin({0})",
    ca.OP_ACOS: "v_acos({0})",
    ca.OP_ATAN: "v_atan({0})",
    ca.OP_FLOOR: "v_floor({0})",
    ca.OP_CEIL: "v_ceil({0})",
    ca.OP_FABS: "v_abs({0})",
    ca.OP_SIGN: "v_sign({0})",
    ca.OP_ERF: "v_erf({0})",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_SINH: "v_sinh({0})",
    ca.OP_COSH: "v_cosh({0})",
    ca.OP_TANH: "v_tanh({0})",
    ca.OP_ASINH: "v_asinh({0})",
    ca.OP_ACOSH: "v_acosh({0})",
    ca.OP_ATANH: "v_atanh({0})",
    ca.OP_LOG1P: "v_log1p({0})",
    ca.OP_EXPM1: "v_expm1({0})",
}


@cache
def template(place: str, name: str) -> str:
    """Return the C text of a template, without the comment at its head, which is for readers of the file.

    Parameters
    ----------
    place : str
        Folder of this package whose ``templates`` hold it.
    name : str
        Of the file, without its ending.

    Examples
    --------
    >>> template("compiled", "vectors").splitlines()[1]
    '#include <math.h>'
    """
    text = (files("synth") / place / "templates" / f"{name}.c").read_text(encoding="utf-8")
    return text.partition("*/\n")[2]


def filled(text: str, parts: Mapping[str, str]) -> str:
    """Return a template with its places filled, which are comments of one name in capitals.

    Parameters
    ----------
    text : str
    parts : mapping
        What stands at the place of each name; places that are not named stay empty.

    Examples
    --------
    >>> filled("a /*SIGN*/ b/*REST*/;", {"SIGN": "+"})
    'a + b;'
    """
    return re.sub(r"/\*([A-Z_]+)\*/", lambda place: parts.get(place[1], ""), text)


def bodies(text: str) -> tuple[str, dict[str, str]]:
    r"""Split a template into what stands above its functions in capitals and what stands between their braces.

    Examples
    --------
    >>> bodies("int a;\n\nvoid FIRST(void) {\n    a = 1;\n}\n")
    ('int a;\n', {'FIRST': '\n    a = 1;\n'})
    """
    above, *rest = re.split(r"\nvoid ([A-Z_]+)\(void\) \{(\n.*?\n)\}\n", text, flags=re.DOTALL)
    return above, dict(zip(rest[::3], rest[1::3], strict=True))
