"""The worst points of a limit over the range, as far as a search that proves nothing finds them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from synth.robust.settings import AscentSettings

Residual = Callable[[np.ndarray], np.ndarray]  # positions (points, things) -> residuals (points,)


def stretched(points: np.ndarray) -> np.ndarray:
    """Points of a unit cube drawn apart, so that half of each coordinate lies at an end: on faces, edges, corners."""
    return np.clip(2.0 * points - 0.5, 0.0, 1.0)


def worst_point(
    residual: Residual, points: np.ndarray, free: np.ndarray, settings: AscentSettings
) -> tuple[np.ndarray, float]:
    """Return the worst point that a bounded ascent from the worst points finds, and its residual.

    Parameters
    ----------
    residual : callable
    points : array (points, things)
        Positions where to begin.
    free : array of int
        Coordinates that may move.
    settings : AscentSettings
    """
    values = residual(points)
    order = np.argsort(-values, kind="stable")
    starts = _apart(points, order, settings)
    place, best = points[starts], values[starts]
    step = np.full(len(starts), settings.first_step)
    for _ in range(settings.rounds if len(free) else 0):
        if np.isposinf(best).any() or (step < settings.last_step).all():
            break
        place, best, step = _climbed(residual, place, best, step, free, settings)
    k = int(np.argmax(best))
    return place[k], float(best[k])


def _apart(points: np.ndarray, order: np.ndarray, settings: AscentSettings) -> list[int]:
    """Return the worst points that are not close to one another."""
    chosen: list[int] = [int(order[0])]
    for k in order[: settings.candidates]:
        if len(chosen) == settings.starts:
            break
        if np.abs(points[chosen] - points[k]).max(axis=1).min() > settings.apart:
            chosen.append(int(k))
    return chosen


def _climbed(
    residual: Residual,
    place: np.ndarray,
    best: np.ndarray,
    step: np.ndarray,
    free: np.ndarray,
    settings: AscentSettings,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One round from every start: a step along each axis either way, then several along the slope these show."""
    count, things = place.shape
    axes = np.zeros((2 * len(free), things))
    axes[np.arange(len(free)), free] = 1.0
    axes[len(free) + np.arange(len(free)), free] = -1.0
    polled = np.clip(place[:, None, :] + step[:, None, None] * axes, 0.0, 1.0)
    values = residual(polled.reshape(-1, things)).reshape(count, -1)
    up, down = values[:, : len(free)], values[:, len(free) :]
    slope = np.zeros_like(place)
    with np.errstate(invalid="ignore"):
        slope[:, free] = np.where(np.isfinite(up - down), up - down, 0.0)
    size = np.abs(slope).max(axis=1, keepdims=True)
    slope = np.divide(slope, size, out=np.zeros_like(slope), where=size > 0)
    strides = np.array(settings.strides)
    along = np.clip(place[:, None, :] + (step[:, None] * strides)[:, :, None] * slope[:, None, :], 0.0, 1.0)
    further = residual(along.reshape(-1, things)).reshape(count, -1)
    points, values = np.concatenate([polled, along], axis=1), np.concatenate([values, further], axis=1)
    k, rows = np.argmax(values, axis=1), np.arange(count)
    better = values[rows, k] > best
    place = np.where(better[:, None], points[rows, k], place)
    best = np.where(better, values[rows, k], best)
    return place, best, np.where(better, np.minimum(settings.grow * step, settings.first_step), settings.shrink * step)
