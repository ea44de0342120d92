"""Speeds at which the plates touch, part and lie at the stop, and the clamp force that they get."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..mechanics import centrifugal
from ..practice import UNSOURCED
from ..sources import DRIVE, NOT_IN_S4, S4, UNIFORM_WEAR

if TYPE_CHECKING:
    from synth.declaration import Declaration

    from .duty import Duty
    from .lining import Lining

# Remarks only.
STOP_RATIO = 3.0  # force on the stop over clamp force that is worth a word where stops are sized for what they bear


@dataclass(frozen=True)
class Contact:
    """Speeds at which the plates touch and part."""

    speed: Any
    release: Any


def declare_contact(
    d: Declaration, *, duty: Duty, contact: Any, release: Any = None, needs: str | tuple[str, ...] = ()
) -> Contact:
    """Declare contact and release speed with their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    contact : symbol
        Speed at which the plates touch [rad/s].
    release : symbol, optional
        Speed at which they part again; without it the contact speed (no friction is modelled) [rad/s].
    needs : str or tuple of str
        Guards without which the release speed (and a contact speed that is the release speed too) does not exist.

    Returns
    -------
    Contact
        Symbols of the block.
    """
    d.derive(
        "contact_speed",
        "1/min",
        contact,
        symbol="omega_contact",
        needs=needs if release is None else (),
        text="Speed at which the plates touch when the driver speeds up",
        source=f"{S4}, analyses 1 and 2",
    )
    text = "Speed at which the plates part when the driver slows down"
    if release is None:
        release = contact
        text += "; friction in the mechanism is not modelled, so it is the contact speed"
    d.derive("release_speed", "1/min", release, symbol="omega_release", text=text, source=NOT_IN_S4, needs=needs)
    d.derive(
        "idle_margin",
        "-",
        release / duty.idle_speed,
        symbol="S_i",
        needs=needs,
        text="Release speed over idle speed",
        source="definition",
    )
    d.at_least(
        "idle_release",
        release,
        duty.idle_margin_min * duty.idle_speed,
        "1/min",
        text="At idle speed the clutch has let go, with a margin",
        source=S4,
    )
    d.at_most(
        "contact_not_too_late",
        contact,
        duty.contact_speed_max,
        "1/min",
        text="The plates touch at contact speed max at the latest",
        source=DRIVE,
    )
    return Contact(contact, release)


def declare_band(d: Declaration, *, band: Any, text: str, needs: str | tuple[str, ...] = ()) -> None:
    """Declare the engagement band [-], a speed over the contact speed; ``needs`` are guards without which it is not."""
    d.derive("engagement_band", "-", band, symbol="band", text=text, source="definition", needs=needs)


def declare_full_clamp(
    d: Declaration,
    *,
    duty: Duty,
    lining: Lining,
    worn_force: Any,
    full_clamp_speed: Any,
    source: str,
    needs: str | tuple[str, ...] = (),
) -> None:
    """Declare worn torque and full-clamp speed of the types with capped clamp force, and their limits.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    lining : Lining
        Lining.
    worn_force : symbol
        Largest clamp force with worn lining [N].
    full_clamp_speed : symbol
        Speed from which on the mechanism lies at its stop [rad/s].
    source : str
        Where the full-clamp speed comes from.
    needs : str or tuple of str
        Guards without which the full-clamp speed does not exist.
    """
    torque = d.derive(
        "worn_torque",
        "N*m",
        lining.torque(worn_force),
        symbol="M_worn",
        text="Torque with full clamp force and worn lining",
        source=UNIFORM_WEAR,
    )
    d.derive(
        "full_clamp_speed",
        "1/min",
        full_clamp_speed,
        symbol="omega_stop",
        needs=needs,
        text="Speed from which on the mechanism lies at its stop and the clamp force does not grow",
        source=source,
    )
    d.at_least(
        "torque_worn",
        torque,
        duty.torque_to_carry,
        "N*m",
        text="The worn clutch carries required torque with its reserve",
        source=UNIFORM_WEAR,
    )
    d.at_most(
        "full_clamp_speed",
        full_clamp_speed,
        duty.full_torque_speed,
        "1/min",
        text="The clamp force is complete at full torque speed",
        source=source,
    )


def declare_clamp(d: Declaration, *, lining: Lining, force: Any, text: str, source: str) -> None:
    """Declare the largest clamp force and the pressure of the lining, with its limit.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    lining : Lining
        Lining.
    force : symbol
        Largest clamp force [N].
    text, source : str
        Of the clamp force.
    """
    d.derive("clamp_force", "N", force, symbol="F_N", text=text, source=source)
    pressure = d.derive(
        "lining_pressure",
        "N/mm2",
        centrifugal.lining_pressure(force, lining.inner_radius, lining.outer_radius),
        symbol="p_l",
        text="Largest pressure of the worn-in lining, at its inner radius",
        source=UNIFORM_WEAR,
    )
    d.at_most(
        "lining_pressure",
        pressure,
        lining.linings.edge_pressure(lining.pair, lining.pair.p_allow),
        "N/mm2",
        text="The lining stands the pressure",
        source=UNIFORM_WEAR,
    )
    face = centrifugal.lining_area(1, lining.inner_radius, lining.outer_radius)
    lining.linings.limit_mean(d, lining.pair, force / face)


def declare_stop_force(d: Declaration, *, force: Any, text: str, source: str) -> Any:
    """Declare the force on the stop at top speed and return it [N]."""
    return d.derive("stop_force", "N", force, symbol="F_stop", text=text, source=source)


def advise_stop_load(d: Declaration, *, stop_force: Any, clamp_force: Any) -> None:
    """Remark where the stop bears more than the lining at top speed, of both forces [N]."""
    d.advise(
        "stop_bears_more_than_lining",
        stop_force > clamp_force,
        "at top speed stop force is larger than clamp force: stop, plates and bearings must be sized for it",
        source=NOT_IN_S4,
    )


def advise_high_stop_force(d: Declaration, *, stop_force: Any, clamp_force: Any) -> None:
    """Remark where the stop bears far more than the lining at top speed, of both forces [N]."""
    d.advise(
        "stop_force_high",
        stop_force > STOP_RATIO * clamp_force,
        "at top speed stop force is more than three times clamp force: stop, flyweights and pins carry it",
        source=UNSOURCED,
    )
