"""Wrong tokens, counted by where they come from: whoever guesses has to wait for a while."""

from __future__ import annotations

import ipaddress
import time
from collections import OrderedDict, deque
from collections.abc import Callable

IPV6_NETWORK = 64  # bits of an address of IPv6 that name a connection; the others its owner chooses


class FailedTokens:
    """How many wrong tokens came from where.

    Parameters
    ----------
    most : int
        Wrong tokens from one address within the window.
    window : float
        In s.
    addresses : int
        That are remembered.
    clock : callable, optional
    """

    def __init__(self, most: int, window: float, addresses: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._most, self._window, self._addresses, self._clock = most, window, addresses, clock
        self._failed: OrderedDict[str, deque[float]] = OrderedDict()

    def wait(self, address: str) -> float:
        """Return for how many s wrong tokens of an address are not answered any more; 0 where they are."""
        times = self._recent(network_of(address))
        return times[0] + self._window - self._clock() if len(times) >= self._most else 0.0

    def failed(self, address: str) -> None:
        """Count a wrong token."""
        network = network_of(address)
        times = self._failed.setdefault(network, deque(maxlen=self._most))
        times.append(self._clock())
        self._failed.move_to_end(network)
        while len(self._failed) > self._addresses:
            self._failed.popitem(last=False)

    def _recent(self, network: str) -> deque[float]:
        times = self._failed.get(network, deque())
        while times and times[0] <= self._clock() - self._window:
            times.popleft()
        return times


def network_of(address: str) -> str:
    """Network that is counted as one: an address, or the network of one of IPv6.

    Examples
    --------
    >>> network_of("192.0.2.7"), network_of("2001:db8::1") == network_of("2001:db8::2"), network_of("somebody")
    ('192.0.2.7', True, 'somebody')
    """
    try:
        found = ipaddress.ip_address(address)
    except ValueError:
        return address
    if isinstance(found, ipaddress.IPv4Address):
        return str(found)
    return str(ipaddress.ip_network((found, IPV6_NETWORK), strict=False))
