"""Blocks of declarations that the centrifugal clutches share: duty, lining, springs, speeds, clamp force and size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from problems.mechanics import centrifugal, heat, ring

if TYPE_CHECKING:
    from synth.declaration import Declaration, Part

S4 = "S4 (notes on centrifugal clutches)"
DERIVED = f"derived; not in {S4}"
TYPICAL = "engineering-typical value"
DRIVE = "requirement of the drive"
SHIGLEY = "Shigley, Mechanical Engineering Design, disc clutch with uniform wear"
SOURCES = (
    "S4: notes on centrifugal and magnetic-powder clutches (in Hungarian), analyses 1 and 2, practices 1 to 3",
    SHIGLEY,
)

# Remarks only.
ZIMMERLI_AMPLITUDE = 241e6  # shear stress amplitude that unpeened spring wire lasts at [Pa]
RELEASE_GAP_MIN = 0.3e-3  # clearance that a released friction surface wants [m]
RIM_STRESS_MAX = 100e6  # hoop stress from which on the bursting of a rim is worth a calculation [Pa]

# What a sheet for several families may state.
COMMON = (
    "required_torque",
    "torque_reserve",
    "idle_speed",
    "full_torque_speed",
    "top_speed",
    "idle_margin_min",
    "contact_speed_max",
    "driven_inertia",
    "engagement_heat_limit",
    "hub_radius",
    "outer_diameter_limit",
    "steel_density",
)


# -- duty ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Duty:
    """What the drive asks of the clutch, all in SI; None where an optional requirement is not given."""

    required_torque: Any
    torque_reserve: Any
    idle_speed: Any
    full_torque_speed: Any
    top_speed: Any
    idle_margin_min: Any
    contact_speed_max: Any
    driven_inertia: Any
    engagement_heat_limit: Any
    hub_radius: Any
    rim_width: Any
    wall_thickness: Any
    plate_thickness: Any
    outer_diameter_limit: Any
    ring_ratio_min: Any
    ring_ratio_max: Any
    steel_density: Any

    @property
    def torque_to_carry(self) -> Any:
        """Torque that the clutch is sized for [N m]."""
        return self.torque_reserve * self.required_torque


def declare_duty(d: Declaration) -> Duty:
    """Declare the requirements that all centrifugal clutches have, and the refusals that concern them alone.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.

    Returns
    -------
    Duty
        Symbols of the block.
    """
    duty = Duty(
        required_torque=d.requirement(
            "required_torque", "N*m", lower=0.1, upper=1e5, symbol="M_req",
            text="Torque to transmit from full_torque_speed on", source=DRIVE,
        ),
        torque_reserve=d.requirement(
            "torque_reserve", "-", 1.2, lower=1, upper=5, symbol="k_M",
            text="Torque of the clutch over required_torque", source="practice, 1.1 to 2.5",
        ),
        idle_speed=d.requirement(
            "idle_speed", "1/min", lower=10, upper=60000, symbol="omega_idle",
            text="Idle speed of the driver; the clutch is released", source=DRIVE,
        ),
        full_torque_speed=d.requirement(
            "full_torque_speed", "1/min", lower=10, upper=60000, symbol="omega_full",
            text="From this speed of the driver on the clutch carries its full torque", source=DRIVE,
        ),
        top_speed=d.requirement(
            "top_speed", "1/min", lower=10, upper=60000, symbol="omega_max",
            text="Highest speed of the driver", source=DRIVE,
        ),
        idle_margin_min=d.requirement(
            "idle_margin_min", "-", 1.15, lower=1, upper=3, symbol="S_idle",
            text="Least release speed (lever types: contact speed) over idle_speed", source="practice, 1.05 to 1.5",
        ),
        contact_speed_max=d.requirement(
            "contact_speed_max", "1/min", lower=10, upper=60000, symbol="omega_contact_max",
            text="The plates touch at this speed at the latest", source=DRIVE,
        ),
        driven_inertia=d.requirement(
            "driven_inertia", "kg*m2", 0.5, lower=0, upper=1e4, symbol="J_load",
            text=f"Inertia on the driven side that an engagement brings up to speed ({TYPICAL})", source=TYPICAL,
        ),
        engagement_heat_limit=d.requirement(
            "engagement_heat_limit", "J/mm2", lower=0.001, upper=20, optional=True, symbol="q_A_allow",
            text="Largest work per engagement and friction area, usually 0.5 to 0.7; takes the place of "
            "friction_pair.q_single_allow", source="practice",
        ),
        hub_radius=d.requirement(
            "hub_radius", "mm", 20, lower=1, upper=500, symbol="r_hub",
            text=f"Radius of shaft and hub ({TYPICAL})", source=TYPICAL,
        ),
        rim_width=d.requirement(
            "rim_width", "mm", 3, lower=0, upper=50, symbol="c_o",
            text="Rim outside the lining", source="practice",
        ),
        wall_thickness=d.requirement(
            "wall_thickness", "mm", 5, lower=0, upper=50, symbol="c_w",
            text=f"Wall outside the flyweights ({TYPICAL})", source=TYPICAL,
        ),
        plate_thickness=d.requirement(
            "equivalent_plate_thickness", "mm", 25, lower=1, upper=200, symbol="t_plates",
            text=f"Steel thickness that all plates together amount to, for mass and inertia ({TYPICAL})",
            source=TYPICAL,
        ),
        outer_diameter_limit=d.requirement(
            "outer_diameter_limit", "mm", lower=20, upper=3000, optional=True, symbol="D_max",
            text="Largest outside diameter", source=DRIVE,
        ),
        ring_ratio_min=d.requirement(
            "ring_ratio_min", "-", 0.55, lower=0.1, upper=0.95, symbol="c_min",
            text="Least inner over outer radius of the lining", source="practice",
        ),
        ring_ratio_max=d.requirement(
            "ring_ratio_max", "-", 0.80, lower=0.1, upper=0.99, symbol="c_max",
            text="Largest inner over outer radius of the lining", source="practice",
        ),
        steel_density=d.requirement(
            "steel_density", "kg/m3", 7850, lower=1000, upper=20000, symbol="rho_steel",
            text="Density of plates and weights", source="material constant",
        ),
    )  # fmt: skip
    _refuse_contradictions(d, duty)
    return duty


def _refuse_contradictions(d: Declaration, duty: Duty) -> None:
    d.refuse(
        "empty_idle_window",
        duty.idle_margin_min * duty.idle_speed > duty.contact_speed_max,
        "a contact_speed_max of at least idle_margin_min times idle_speed; the window in which the clutch may engage "
        "is empty otherwise",
    )
    d.refuse(
        "empty_engagement_window",
        duty.contact_speed_max > duty.full_torque_speed,
        "a full_torque_speed of at least contact_speed_max; the clutch must touch before it can carry torque",
    )
    d.refuse(
        "top_speed_too_low",
        duty.full_torque_speed > duty.top_speed,
        "a top_speed of at least full_torque_speed; the highest speed is the last at which the clutch turns",
    )
    d.refuse(
        "bad_ratio",
        duty.ring_ratio_min > duty.ring_ratio_max,
        "a ring_ratio_min of at most ring_ratio_max; otherwise no lining satisfies both",
    )
    if duty.outer_diameter_limit is not None:
        d.refuse(
            "no_room_for_lining",
            duty.outer_diameter_limit <= 2 * (duty.hub_radius + duty.rim_width),
            "an outer_diameter_limit above twice hub_radius and rim_width; lining and flyweights go between them",
        )


def declare_rest_radius(d: Declaration) -> Any:
    """Declare the radius of the flyweights at rest and return it [m]."""
    return d.variable(
        "rest_radius", "mm", 30, 250, grid=1, symbol="r0",
        text="Radius of the flyweight centres at rest", source=f"{S4}, r0",
    )  # fmt: skip


# -- lining ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Lining:
    """Friction surfaces of the clutch."""

    inner_radius: Any
    outer_radius: Any
    surfaces: Any
    pair: Part

    @property
    def friction_radius(self) -> Any:
        """Friction radius of the worn-in lining [m]."""
        return centrifugal.lining_radius(self.inner_radius, self.outer_radius)

    def torque(self, force: Any) -> Any:
        """Return the torque of an axial force [N m]."""
        return ring.friction_torque(self.pair.mu_dynamic, force, self.friction_radius, self.surfaces)

    def force(self, torque: Any) -> Any:
        """Return the axial force that a torque needs [N]."""
        return centrifugal.force_for_torque(torque, self.pair.mu_dynamic, self.surfaces, self.friction_radius)


def declare_lining(d: Declaration, family: str, duty: Duty) -> Lining:
    """Declare lining and slot friction_pair, with the limits of its shape and of the heat of an engagement.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    family : str
        Name that the column family_hint must contain.
    duty : Duty
        Requirements.

    Returns
    -------
    Lining
        Symbols of the block.
    """
    inner = d.variable(
        "lining_inner_radius", "mm", 20, 250, grid=0.5, symbol="r_i",
        text="Inner radius of the lining", source="geometry",
    )  # fmt: skip
    outer = d.variable(
        "lining_outer_radius", "mm", 30, 300, grid=0.5, symbol="r_o",
        text="Outer radius of the lining", source="geometry",
    )  # fmt: skip
    surfaces = d.count(
        "friction_surfaces", 2, 8, step=2, symbol="z_f",
        text="Friction surfaces, two per friction disc", source="geometry",
    )  # fmt: skip
    pair = d.part(
        "friction_pair", "friction_materials", where=f"'{family}' in family_hint", symbol="pair",
        text="Lining and the plate it rubs on", source="table friction_materials",
    )  # fmt: skip
    d.at_least(
        "ring_ratio_min", inner / outer, duty.ring_ratio_min, "-",
        text="The lining is not too wide: it wears evenly", source="practice",
    )  # fmt: skip
    d.at_most(
        "ring_ratio_max", inner / outer, duty.ring_ratio_max, "-",
        text="The lining is not too narrow", source="practice",
    )  # fmt: skip
    energy = centrifugal.engagement_energy(duty.driven_inertia, duty.full_torque_speed)
    allowed = duty.engagement_heat_limit
    d.at_most(
        "engagement_heat", heat.single_heat(energy, centrifugal.lining_area(surfaces, inner, outer)),
        pair.optional("q_single_allow") if allowed is None else allowed, "J/mm2",
        text="The lining stands the heat of bringing driven_inertia up to full_torque_speed, without a load torque",
        source="energy balance",
    )  # fmt: skip
    d.advise(
        "bad_ring",
        inner >= outer,
        "lining_inner_radius is not below lining_outer_radius: this is no lining, and its other figures mean nothing",
        source="geometry",
    )
    return Lining(inner, outer, surfaces, pair)


# -- springs ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SpringSet:
    """Equal springs side by side."""

    part: Part
    count: Any

    @property
    def rate(self) -> Any:
        """Rate of the set [N/m]."""
        return centrifugal.set_rate(self.count, self.part.rate_R)

    @property
    def mass(self) -> Any:
        """Mass of the set [kg]."""
        return self.count * self.part.mass

    def force(self, deflection: Any) -> Any:
        """Return the force of the set at a deflection from the free length [N]."""
        # Through the force of one spring, which a limit bounds: then that limit bounds the force of the set too.
        return self.count * centrifugal.spring_force(self.part.rate_R, deflection)

    def share_of_circle(self, gap: Any) -> Any:
        """Return the length that the set takes of its circle, with a gap beside each spring [m]."""
        return self.count * (self.part.mean_diameter_D + self.part.wire_diameter_d + gap)


def declare_springs(d: Declaration, slot: str, symbol: str, count_symbol: str, text: str) -> SpringSet:
    """Declare a slot of compression springs and the number of springs in it.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    slot : {"return_spring", "clamp_spring"}
        Name of the slot; the count is its plural.
    symbol, count_symbol : str
        Symbols of slot and count.
    text : str
        What the springs do.

    Returns
    -------
    SpringSet
        Symbols of the block.
    """
    count = d.count(
        f"{slot}s", 2, 12, symbol=count_symbol,
        text=f"Number of springs: {text}", source=f"{S4}, springs around the shaft",
    )  # fmt: skip
    part = d.part(
        slot, "compression_springs", symbol=symbol,
        text=f"One spring of the set: {text}", source="table compression_springs",
    )  # fmt: skip
    return SpringSet(part, count)


def limit_spring_force(d: Declaration, name: str, springs: SpringSet, deflection: Any, text: str) -> None:
    """Declare the limit of the force on one spring at its largest deflection.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    name : str
        Name of the limit.
    springs : SpringSet
        The set.
    deflection : symbol
        Largest deflection from the free length [m].
    text : str
        What the limit says.
    """
    force = centrifugal.spring_force(springs.part.rate_R, deflection)
    d.at_most(name, force, springs.part.max_force_Fn, "N", text=text, source="EN 13906-1")


def limit_share_of_force(d: Declaration, name: str, springs: SpringSet, force: Any, text: str) -> None:
    """Declare the limit of the force on one spring, from the largest force of the set.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    name : str
        Name of the limit.
    springs : SpringSet
        The set.
    force : symbol
        Largest force of the set [N].
    text : str
        What the limit says.
    """
    d.at_most(name, force / springs.count, springs.part.max_force_Fn, "N", text=text, source="EN 13906-1")


def advise_springs(
    d: Declaration, duty: Duty, springs: SpringSet, radius: Any, preload: Any, travel: Any, what: str
) -> None:
    """Remark springs that bow outwards at top speed, or that tire from engaging again and again.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    springs : SpringSet
        The set; the codes of the remarks begin with its slot.
    radius : symbol
        Radius on which they stand [m].
    preload, travel : symbol
        Deflection at rest, and what is added to it in an engagement [m].
    what : str
        Which springs they are.
    """
    part = springs.part
    load = centrifugal.spring_bow_load(
        duty.steel_density, part.wire_diameter_d, part.mean_diameter_D, part.active_coils_n, radius, duty.top_speed
    )
    d.advise(
        f"{part.slot}_bows",
        load > centrifugal.spring_force(part.rate_R, preload + travel),
        f"at top_speed the centrifugal force of the coils of {what} is larger than their spring force: they bow "
        "outwards and rub unless they sit in pockets or on guides",
        source=DERIVED,
    )
    amplitude = part.optional("tau_k_n_corrected") * part.rate_R * travel / (2 * part.max_force_Fn)
    d.advise(
        f"{part.slot}_tires",
        amplitude > ZIMMERLI_AMPLITUDE,
        f"engaged again and again {what} tire: their shear stress swings by more than the 241 N/mm2 to either side "
        "that unpeened wire lasts at",
        source="Zimmerli; Shigley, Mechanical Engineering Design, fatigue of helical springs",
    )


# -- speeds ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Contact:
    """Speeds at which the plates touch and part."""

    speed: Any
    release: Any


def declare_contact(
    d: Declaration, duty: Duty, contact: Any, release: Any = None, needs: str | tuple[str, ...] = ()
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
        "contact_speed", "1/min", contact, symbol="omega_contact", needs=needs if release is None else (),
        text="Speed at which the plates touch when the driver speeds up", source=f"{S4}, analyses 1 and 2",
    )  # fmt: skip
    text = "Speed at which the plates part when the driver slows down"
    if release is None:
        release = contact
        text += "; friction in the mechanism is not modelled, so it is the contact speed"
    d.derive("release_speed", "1/min", release, symbol="omega_release", text=text, source=DERIVED, needs=needs)
    d.derive(
        "idle_margin", "-", release / duty.idle_speed, symbol="S_i", needs=needs,
        text="Release speed over idle_speed", source="definition",
    )  # fmt: skip
    d.at_least(
        "idle_release", release, duty.idle_margin_min * duty.idle_speed, "1/min",
        text="At idle speed the clutch has let go, with a margin", source=S4,
    )  # fmt: skip
    d.at_most(
        "contact_not_too_late", contact, duty.contact_speed_max, "1/min",
        text="The plates touch at contact_speed_max at the latest", source=DRIVE,
    )  # fmt: skip
    return Contact(contact, release)


def declare_band(d: Declaration, band: Any, text: str, needs: str | tuple[str, ...] = ()) -> None:
    """Declare the engagement band [-], a speed over the contact speed; ``needs`` are guards without which it is not."""
    d.derive("engagement_band", "-", band, symbol="band", text=text, source="definition", needs=needs)


def declare_full_clamp(
    d: Declaration,
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
        "worn_torque", "N*m", lining.torque(worn_force), symbol="M_worn",
        text="Torque with full clamp force and worn lining", source=SHIGLEY,
    )  # fmt: skip
    d.derive(
        "full_clamp_speed", "1/min", full_clamp_speed, symbol="omega_stop", needs=needs,
        text="Speed from which on the mechanism lies at its stop and the clamp force does not grow", source=source,
    )  # fmt: skip
    d.at_least(
        "torque_worn", torque, duty.torque_to_carry, "N*m",
        text="The worn clutch carries required_torque with its reserve", source=SHIGLEY,
    )  # fmt: skip
    d.at_most(
        "full_clamp_speed", full_clamp_speed, duty.full_torque_speed, "1/min",
        text="The clamp force is complete at full_torque_speed", source=source,
    )  # fmt: skip


# -- clamp force -----------------------------------------------------------------------------------


def declare_wear(d: Declaration) -> Any:
    """Declare the wear of the linings that the types with capped clamp force must stand, and return it [m]."""
    return d.requirement(
        "lining_wear", "mm", 0.6, lower=0, upper=10, symbol="wear",
        text="Wear of all linings together, by which the pressure plate travels further", source="practice",
    )  # fmt: skip


def declare_clamp(d: Declaration, lining: Lining, force: Any, text: str, source: str) -> None:
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
        "lining_pressure", "N/mm2", centrifugal.lining_pressure(force, lining.inner_radius, lining.outer_radius),
        symbol="p_l", text="Largest pressure of the worn-in lining, at its inner radius", source=SHIGLEY,
    )  # fmt: skip
    d.at_most(
        "lining_pressure", pressure, lining.pair.p_allow, "N/mm2",
        text="The lining stands the pressure", source=SHIGLEY,
    )  # fmt: skip


def declare_stop_force(d: Declaration, force: Any, text: str, source: str) -> Any:
    """Declare the force on the stop at top speed and return it [N]."""
    return d.derive("stop_force", "N", force, symbol="F_stop", text=text, source=source)


# -- size ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Flyweights:
    """Flyweights as the envelope sees them.

    ``half_height`` is from their centre to their outside.
    """

    mass: Any
    end_radius: Any
    half_height: Any


def declare_size(
    d: Declaration, duty: Duty, lining: Lining, rest_radius: Any, flyweights: Flyweights, springs: Sequence[SpringSet]
) -> None:
    """Declare outside diameter, mass and inertia, the limit of the room there is, and the default objectives.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    lining : Lining
        Lining.
    rest_radius : symbol
        Radius of the flyweights at rest, on which the springs stand too [m].
    flyweights : Flyweights
        Flyweights at the end of their way.
    springs : sequence of SpringSet
        All springs.
    """
    diameter = d.derive(
        "outer_diameter", "mm",
        centrifugal.outside_diameter(
            lining.outer_radius + duty.rim_width,
            flyweights.end_radius + flyweights.half_height + duty.wall_thickness,
        ),
        symbol="D", text="Outside diameter over lining and flyweights, whichever reaches further", source="geometry",
    )  # fmt: skip
    spring_mass: Any = sum(spring_set.mass for spring_set in springs)
    plates = centrifugal.plates_mass(duty.steel_density, diameter, duty.hub_radius, duty.plate_thickness)
    d.derive(
        "mass", "kg", plates + flyweights.mass + spring_mass, symbol="m",
        text="Plates (as a steel ring of equivalent_plate_thickness), flyweights and springs", source="geometry",
    )  # fmt: skip
    d.derive(
        "inertia", "kg*m2",
        centrifugal.clutch_inertia(
            plates, diameter, duty.hub_radius, flyweights.mass, flyweights.end_radius, spring_mass, rest_radius
        ),
        symbol="J", text="Inertia of plates, flyweights at the end of their way, and springs", source="geometry",
    )  # fmt: skip
    if duty.outer_diameter_limit is not None:
        d.at_most(
            "outer_diameter", diameter, duty.outer_diameter_limit, "mm",
            text="The clutch fits the room across", source=DRIVE,
        )  # fmt: skip
    d.advise(
        "fast_rim",
        centrifugal.rim_stress(duty.steel_density, diameter / 2, duty.top_speed) > RIM_STRESS_MAX,
        "at top_speed the hoop stress of the rim is above 100 N/mm2: calculate the speed at which it bursts",
        source="hoop stress of a thin ring",
    )


def declare_objectives(d: Declaration) -> None:
    """Declare the objectives of all centrifugal clutches."""
    d.objective("outer_diameter")
    d.objective("mass")
    d.objective("engagement_band", default=False)
    d.objective("idle_margin", "max", default=False)


# -- weights of the lever types ---------------------------------------------------------------------


@dataclass(frozen=True)
class Weights:
    """Square weights at the ends of levers."""

    mass: Any
    count: Any
    arm: Any
    thickness: Any
    angle_limit: Any


def declare_weights(d: Declaration, duty: Duty) -> Weights:
    """Declare the flyweights of the lever types: their mass, number, arm and room.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.

    Returns
    -------
    Weights
        Symbols of the block.
    """
    width = d.requirement(
        "weight_width", "mm", 30, lower=2, upper=300, symbol="b_w",
        text=f"Axial width of a weight ({TYPICAL})", source=TYPICAL,
    )  # fmt: skip
    angle = d.requirement(
        "lever_angle_limit", "rad", 0.35, lower=0.02, upper=0.35, symbol="phi_lim",
        text="Largest angle of the levers; the model takes sine and tangent for the angle", source=DERIVED,
    )  # fmt: skip
    mass = d.variable(
        "flyweight_mass", "kg", 0.05, 5, symbol="m_f",
        text="Mass of all weights together", source=f"{S4}, m",
    )  # fmt: skip
    arm = d.variable(
        "flyweight_arm", "mm", 10, 200, grid=0.5, symbol="l_c",
        text="Arm of the weights on their levers", source=f"{S4}, l_c",
    )  # fmt: skip
    count = d.count(
        "weights", 2, 6, symbol="n_w",
        text="Number of weights, each on a lever", source=f"{S4}, levers around the shaft",
    )  # fmt: skip
    thickness = d.derive(
        "weight_thickness", "mm", centrifugal.weight_thickness(mass, count, duty.steel_density, width), symbol="t_w",
        text="Radial size of a weight of square section", source=f"geometry; {DERIVED}",
    )  # fmt: skip
    return Weights(mass, count, arm, thickness, angle)


def limit_weight_room(d: Declaration, duty: Duty, weights: Weights, rest_radius: Any, pivot_arm: Any = 0.0) -> None:
    """Declare the limit that weights (and the legs of their levers) clear the hub.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    duty : Duty
        Requirements.
    weights : Weights
        Weights.
    rest_radius : symbol
        Radius of their centres at rest [m].
    pivot_arm : symbol, optional
        Length of the lever that lies below the weight [m].
    """
    d.at_most(
        "weight_clear_of_hub", duty.hub_radius + weights.thickness / 2 + pivot_arm, rest_radius, "mm",
        text="The weights at rest clear the hub", source=f"geometry; {DERIVED}",
    )  # fmt: skip


def advise_gravity(d: Declaration, rest_radius: Any, start_speed: Any) -> None:
    """Remark where the flyweights start at so low a speed that gravity moves them.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    rest_radius : symbol
        Radius of their centres at rest [m].
    start_speed : symbol
        Speed at which they leave their rest [rad/s].
    """
    d.advise(
        "gravity_at_start",
        centrifugal.gravity_ratio(rest_radius, start_speed) < 10,
        "the flyweights leave their rest below ten times gravity: on a horizontal shaft they move once per turn",
        source=DERIVED,
    )


def advise_stop_load(d: Declaration, stop_force: Any, clamp_force: Any) -> None:
    """Remark where the stop bears more than the lining at top speed.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    stop_force : symbol
        Force on the stop at top speed [N].
    clamp_force : symbol
        Largest clamp force [N].
    """
    d.advise(
        "stop_bears_more_than_lining",
        stop_force > clamp_force,
        "at top_speed stop_force is larger than clamp_force: stop, plates and bearings must be sized for it",
        source=DERIVED,
    )


def advise_release_gap(d: Declaration, gap: Any, lining: Lining) -> None:
    """Remark where the gap of the plate leaves each friction surface too little air.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    gap : symbol
        Travel of the plate to contact [m].
    lining : Lining
        Lining.
    """
    d.advise(
        "drags_when_released",
        gap < RELEASE_GAP_MIN * lining.surfaces,
        "the travel to contact leaves less than 0.3 mm for each friction surface: the released clutch drags",
        source="practice, 0.3 to 0.5 mm and the run-out",
    )
