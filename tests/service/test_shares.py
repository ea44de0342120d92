"""Places that are shared: nobody waits for ever, and nobody keeps all others out."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Callable, Coroutine
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.service.shares import Asker, FairShares, NoPlaceError
from tests.repetitions import repetitions

LONG = 60.0
A, B, C = (Asker(name, name) for name in "abc")


def run(story: Callable[[], Coroutine[Any, Any, None]]) -> None:
    asyncio.run(story())


def test_one_tenant_has_no_more_than_its_share_and_one_token_no_more_than_its_own() -> None:
    async def story() -> None:
        shares = FairShares(8, 0.5, 0.25, queue=100)
        first, second, third = (Asker("a", token) for token in (1, 2, 3))
        for asker in (first, first, second, second):
            await shares.take(asker, LONG)
        for asker in (first, second, third):
            with pytest.raises(NoPlaceError) as refused:
                await shares.take(asker, 0.0)
            assert refused.value.own
        for asker in (B, B, C, C):
            await shares.take(asker, 0.0)
        with pytest.raises(NoPlaceError) as refused:
            await shares.take(Asker("d", 1), 0.0)
        assert not refused.value.own
        assert (shares.held, shares.waiting) == (8, 0)

    run(story)


def test_who_is_alone_may_have_all() -> None:
    async def story() -> None:
        shares = FairShares(3, 0.5, 0.25, queue=100)
        for _ in range(3):
            await shares.take(Asker("local", None, alone=True), 0.0)

    run(story)


@pytest.mark.parametrize("places", [1, 2, 5])
def test_who_asks_once_is_next_however_many_questions_of_others_wait(places: int) -> None:
    """Six connections that ask again as soon as they are answered, and somebody else who asks now and then."""

    async def story() -> None:
        shares = FairShares(places, 0.5, 0.25, queue=1_000)
        granted: list[str] = []
        over = asyncio.Event()

        async def loop() -> None:
            while not over.is_set():
                async with shares.place(A, LONG):
                    granted.append("a")
                    await asyncio.sleep(0)

        crowd = [asyncio.ensure_future(loop()) for _ in range(6)]
        while len(granted) < 20:
            await asyncio.sleep(0)
        for _ in range(20):
            before = len(granted)
            async with shares.place(B, LONG):
                assert len(granted) - before <= places
                for _ in range(10):
                    await asyncio.sleep(0)
        over.set()
        await asyncio.gather(*crowd)
        assert (shares.held, shares.waiting) == (0, 0)

    run(story)


def test_tenants_take_turns() -> None:
    async def story() -> None:
        shares = FairShares(1, 1.0, 1.0, queue=100)
        order: list[str] = []

        async def one(asker: Asker) -> None:
            async with shares.place(asker, LONG):
                order.append(str(asker.tenant))
                await asyncio.sleep(0)

        await asyncio.gather(*(one(asker) for asker in (A, A, A, A, B, B, C)))
        assert "".join(order) == "abcabaa"

    run(story)


def test_a_queue_has_an_end() -> None:
    async def story() -> None:
        shares = FairShares(1, 1.0, 1.0, queue=2)
        await shares.take(A, LONG)
        waiting = [asyncio.ensure_future(shares.take(A, LONG)) for _ in range(2)]
        await asyncio.sleep(0)
        with pytest.raises(NoPlaceError):
            await shares.take(A, LONG)
        other = asyncio.ensure_future(shares.take(B, LONG))
        await asyncio.sleep(0)
        shares.give_back(A)
        await other
        for task in waiting:
            task.cancel()
        await asyncio.gather(*waiting, return_exceptions=True)
        shares.give_back(B)
        assert (shares.held, shares.waiting) == (0, 0)

    run(story)


STEPS = st.lists(
    st.tuples(st.sampled_from(["ask", "free", "leave"]), st.integers(0, 3), st.integers(0, 2)), max_size=60
)


@settings(max_examples=repetitions(40, 5_000), deadline=None, derandomize=True)
@given(steps=STEPS, places=st.integers(1, 6), of_tenant=st.floats(0.01, 1.0), of_token=st.floats(0.01, 1.0))
def test_whatever_happens_no_place_is_lost_and_no_share_is_exceeded(
    steps: list[tuple[str, int, int]], places: int, of_tenant: float, of_token: float
) -> None:
    async def story() -> None:
        shares = FairShares(places, of_tenant, of_token, queue=100)
        most = (max(1, int(places * of_tenant)), max(1, int(places * of_token)))
        held: list[Asker] = []
        waiting: list[asyncio.Task[None]] = []

        async def take(asker: Asker) -> None:
            await shares.take(asker, LONG)
            held.append(asker)

        for what, tenant, token in steps:
            if what == "ask":
                waiting.append(asyncio.ensure_future(take(Asker(tenant, token))))
            elif what == "free" and held:
                shares.give_back(held.pop(tenant % len(held)))
            elif what == "leave" and waiting:
                waiting[tenant % len(waiting)].cancel()
            for _ in range(3):
                await asyncio.sleep(0)
            waiting = [task for task in waiting if not task.done()]
            assert (shares.held, shares.waiting) == (len(held), len(waiting))
            assert shares.held <= places
            assert all(count <= most[0] for count in Counter(one.tenant for one in held).values())
            assert all(count <= most[1] for count in Counter(held).values())
        for _ in range(200):
            if not held:
                break
            shares.give_back(held.pop())
            await asyncio.sleep(0)
            await asyncio.sleep(0)
        await asyncio.gather(*waiting, return_exceptions=True)
        while held:
            shares.give_back(held.pop())
        assert (shares.held, shares.waiting) == (0, 0)
        assert not shares._of
        assert not shares._served

    run(story)
