"""Places that are shared fairly: who has the fewest is next, and nobody has all while others may come."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import AsyncIterator, Hashable
from contextlib import asynccontextmanager
from dataclasses import dataclass


@dataclass(frozen=True)
class Asker:
    """Whose request it is, as shares are counted.

    Parameters
    ----------
    tenant, token : hashable
    alone : bool
        Nobody else can come: nothing is kept free for others.
    """

    tenant: Hashable
    token: Hashable
    alone: bool = False

    @property
    def counted(self) -> tuple[Hashable, Hashable]:
        """What is counted: the tenant, and its token."""
        return (self.tenant,), (self.tenant, self.token)


class NoPlaceError(Exception):
    """No place became free in time.

    Parameters
    ----------
    own : bool
        The asker has as many as one may have; else others have all.
    """

    def __init__(self, own: bool) -> None:
        super().__init__("as many as one may have" if own else "others have all")
        self.own = own


@dataclass(frozen=True, eq=False)
class _Turn:
    """Somebody who waits for a place."""

    asker: Asker
    granted: asyncio.Future[None]


class FairShares:
    """Places, and who holds them. For one event loop.

    Of those who wait, the tenant with the fewest places is next, and of equal ones the one that was served longer ago;
    then the same among the tokens of a tenant; then who came first.

    Parameters
    ----------
    places : int
    of_tenant, of_token : float
        Share of the places that one may hold while others may come; at least one place.
    queue : int
        Askers of a tenant that may wait at a time.
    """

    def __init__(self, places: int, of_tenant: float, of_token: float, queue: int) -> None:
        self.places, self.held = places, 0
        self._most = (max(1, int(places * of_tenant)), max(1, int(places * of_token)))
        self._queue = queue
        self._of = Counter[Hashable]()  # places by tenant and by token
        self._served: dict[Hashable, int] = {}  # number of the last place granted, of those who hold one or wait
        self._waiting: list[_Turn] = []
        self._granted = 0

    @property
    def waiting(self) -> int:
        """Number of askers who wait."""
        return len(self._waiting)

    @asynccontextmanager
    async def place(self, asker: Asker, patience: float) -> AsyncIterator[None]:
        """Hold a place for the block; raises as :meth:`take`."""
        await self.take(asker, patience)
        try:
            yield
        finally:
            self.give_back(asker)

    async def take(self, asker: Asker, patience: float) -> None:
        """Wait for a place, which :meth:`give_back` frees.

        Raises
        ------
        NoPlaceError
            There is none within ``patience``, in s; at once where too many of the tenant wait already.
        """
        tenant = asker.counted[0]
        if sum(turn.asker.counted[0] == tenant for turn in self._waiting) >= self._queue:
            raise NoPlaceError(own=True)
        turn = _Turn(asker, asyncio.get_running_loop().create_future())
        self._waiting.append(turn)
        self._serve()
        try:
            async with asyncio.timeout(patience):
                await turn.granted
        except BaseException as error:
            own = not self._may(asker)
            if turn in self._waiting:
                self._waiting.remove(turn)
                self._forget(asker)
            else:  # granted at the same moment
                self.give_back(asker)
            if isinstance(error, TimeoutError):
                raise NoPlaceError(own) from None
            raise

    def give_back(self, asker: Asker) -> None:
        """Free a place."""
        self.held -= 1
        self._of.subtract(asker.counted)
        self._serve()
        self._forget(asker)

    def _serve(self) -> None:
        """Grant the places that are free."""
        while self.held < self.places:
            able = [turn for turn in self._waiting if self._may(turn.asker)]
            if not able:
                return
            turn = min(able, key=lambda one: [(self._of[key], self._served.get(key, 0)) for key in one.asker.counted])
            self._waiting.remove(turn)
            self.held += 1
            self._granted += 1
            for key in turn.asker.counted:
                self._of[key] += 1
                self._served[key] = self._granted
            turn.granted.set_result(None)

    def _may(self, asker: Asker) -> bool:
        """Whether the asker may hold one place more."""
        return asker.alone or all(self._of[key] < most for key, most in zip(asker.counted, self._most, strict=True))

    def _forget(self, asker: Asker) -> None:
        """Drop what is known of who neither holds a place nor waits."""
        for key in asker.counted:
            if not self._of[key] and not any(key in turn.asker.counted for turn in self._waiting):
                del self._of[key]
                self._served.pop(key, None)
