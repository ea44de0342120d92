"""How each address may be asked, by all routes together: several routes share one."""

from __future__ import annotations

import re
from collections.abc import Iterable

from starlette.routing import BaseRoute, Route


class Addresses:
    """The addresses of a server.

    Parameters
    ----------
    routes : iterable of BaseRoute
        Those that answer at an address of their own; others are left out.
    """

    def __init__(self, routes: Iterable[BaseRoute]) -> None:
        self._known: list[tuple[re.Pattern[str], frozenset[str]]] = [
            (route.path_regex, frozenset(route.methods or ())) for route in routes if isinstance(route, Route)
        ]

    def methods(self, path: str) -> frozenset[str]:
        """Return the methods by which a path may be asked; none where nothing stands there.

        Examples
        --------
        >>> from starlette.routing import Route
        >>> found = Addresses(Route("/jobs/{job}", print, methods=[method]) for method in ("POST", "DELETE"))
        >>> sorted(found.methods("/jobs/7")), sorted(found.methods("/jobs"))
        (['DELETE', 'POST'], [])
        """
        return frozenset[str]().union(*(methods for form, methods in self._known if form.match(path)))
