"""The pot magnet that presses a friction pack: its force, its circuit and its limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from synth.declaration import Block, Declaration, Option, Requirement

from ...duty import cooling
from ...friction.duty import Duty, Size
from ...friction.engagement import Startup
from ...mechanics import heat, magnetics, plates
from ...practice import UNSOURCED
from ...sources import S0, S4, TYPICAL
from ..coil import model as coil_blocks
from ..lining.model import Pair
from . import formulas as pot_magnet

HOLDS = "magnet_overcomes_springs"
OIL = "oil_temperature_limit"
STICKING_GAP = 0.3e-3  # m, least of the typical gaps
STICKING_SHARE = 0.75  # least of the typical gaps over their middle, 0.3 and 0.4 mm


class MagnetRequirements(Block):
    """Requirements of the magnet beside those of its coil, all in SI."""

    group = "actuator"

    return_spring_force = Requirement(
        "N",
        100,
        lower=0,
        upper=1e5,
        symbol="F_ret",
        text=f"Springs that draw the armature back ({TYPICAL}; with rules of practice 1.5 % of the clamping force that "
        f"the torque lets expect, {UNSOURCED})",
        source=f"{S4}, section 6.6",
    )
    release_drag_force = Requirement(
        "N",
        20,
        lower=0,
        upper=1e5,
        symbol="F_drag",
        text=f"Push of the first phase: plates that slide in their guides ({TYPICAL}; with rules of practice 0.4 % of "
        f"the clamping force that the torque lets expect, {UNSOURCED})",
        source=f"{S0}, first phase of engagement",
    )
    pull_in_margin = Requirement(
        "-",
        1.3,
        lower=1,
        upper=5,
        symbol="k_in",
        text="Pull on the released armature over springs and drag",
        source=f"{S4}, section 6.6",
    )
    residual_gap = Requirement(
        "mm",
        0.4,
        lower=0.05,
        upper=3,
        symbol="g_r",
        text=f"Gap at each pole of the engaged magnet, against sticking ({TYPICAL}, 0.3 to 0.5; with rules of practice "
        f"0.015 of the shaft, 0.1 to 0.4, {UNSOURCED})",
        source=f"{S4}, section 6.6",
    )
    magnet_bore_radius = Requirement(
        "mm",
        20,
        lower=2,
        upper=500,
        symbol="r_b",
        text=f"Inside of the inner pole: room for shaft and bearing ({TYPICAL})",
        source=f"{S4}, section 6.6",
        group="envelope",
    )


class MagnetRules(coil_blocks.CoilRules):
    """Rules for magnets that press a pack, all in SI."""

    group = "practice"

    wear_adjust = Option(
        ("no", "yes"),
        "no",
        symbol="adj",
        text="no: the armature follows the wear, and the magnet draws it in over the gap of worn linings; yes: the gap "
        "is set again as they wear",
        source="the armature follows the wear; derived",
        group="actuator",
    )
    ramp_time_min = Requirement(
        "ms",
        20,
        lower=0,
        upper=10000,
        symbol="t_r_min",
        text=f"Least ramp time: no armature is faster ({UNSOURCED}; four units)",
        source=UNSOURCED,
    )


@dataclass(frozen=True)
class Seat:
    """What defaults of a magnet follow from where rules of practice count: sizing torque [N m], shaft and hub [m]."""

    torque: Any
    shaft_diameter: Any
    hub_diameter: Any

    @property
    def defaults(self) -> dict[str, Any]:
        """Defaults of MagnetRequirements that grow with the clutch, in SI."""
        clamping = pot_magnet.expected_clamping_force(self.torque, self.shaft_diameter)
        return {
            "return_spring_force": pot_magnet.return_force(clamping),
            "release_drag_force": pot_magnet.release_drag(clamping),
            "residual_gap": self.residual_gap,
            "magnet_bore_radius": self.hub_diameter / 2,
        }

    @property
    def residual_gap(self) -> Any:
        """Gap that a magnet of this size needs against sticking [m]."""
        return pot_magnet.gap_against_sticking(self.shaft_diameter)

    @property
    def sticking_gap(self) -> Any:
        """Gap below which it may hold without current [m]."""
        return STICKING_SHARE * self.residual_gap


@dataclass(frozen=True)
class Pressed:
    """Pack that a magnet presses, with all that is known around it.

    ``gap`` is that of each surface when released [m], ``wear_depth`` what a lining wears until the gap is set again
    [m]. ``size`` counts, ``full_size`` is that of the complete pack. ``objective`` is offered of every such pack,
    ``offered`` are further objectives.
    """

    duty: Duty
    pair: Pair
    start: Startup
    ramp_time: Any
    surfaces: Any
    gap: Any
    wear_depth: Any
    size: Size
    full_size: Size
    parts: Any
    area: Any
    objective: str
    offered: tuple[str, ...]


@dataclass(frozen=True)
class Pull:
    """What the magnet needs to draw its armature in: circuit, ampere-turns, pull and what holds it back [N]."""

    circuit: pot_magnet.Circuit
    ampere_turns: Any
    force: Any
    springs: Any


@dataclass(frozen=True)
class MagnetSize:
    """Mass of the magnet and of the copper in it [kg]."""

    mass: Any
    copper: Any


@dataclass(frozen=True)
class Magnet:
    """The magnet and what it leaves for the pack; below a gap of ``sticking_gap`` [m] it may hold without current."""

    wants: MagnetRequirements
    iron: coil_blocks.CoilRequirements
    unknowns: coil_blocks.CoilUnknowns
    shape: pot_magnet.PotMagnet
    actuation_force: Any
    sticking_gap: Any


def declare_magnet_rules(d: Declaration) -> MagnetRules:
    """Declare the requirements that rules for magnets go by, and refuse windows that no coil can have."""
    rules = d.block(MagnetRules)
    coil_blocks.refuse_bad_window(d, rules)
    return rules


def declare_magnet(
    d: Declaration, *, sticking_gap: Any, still_transfer: Any = cooling.STILL_AIR, **defaults: Any
) -> Magnet:
    """Declare requirements and unknowns of the magnet, its force, and what is left for the pack.

    Parameters
    ----------
    d : Declaration
        Takes the declarations.
    sticking_gap : float or symbol
        Gap below which it may hold without current [m].
    still_transfer : float or symbol
        Default of the surface coefficient of the standing magnet [W/(m2 K)].
    defaults : symbols
        Defaults of MagnetRequirements, in SI.

    Returns
    -------
    Magnet
        Symbols of the block.
    """
    wants = d.block(MagnetRequirements, **defaults)
    iron = coil_blocks.declare_coil_requirements(d, still_heat_transfer=still_transfer)
    pole_width = d.variable(
        "inner_pole_width",
        "mm",
        3,
        60,
        grid=0.5,
        symbol="w_p",
        text="Radial width of the inner pole; the outer pole has the same area",
        source=f"{S4}, section 6.6",
    )
    unknowns = d.block(coil_blocks.CoilUnknowns)
    shape = pot_magnet.PotMagnet(
        bore=wants.magnet_bore_radius,
        pole_width=pole_width,
        coil_length=unknowns.coil_length,
        coil_height=unknowns.coil_height,
        thickness=unknowns.yoke_thickness,
        residual_gap=wants.residual_gap,
    )
    return Magnet(wants, iron, unknowns, shape, _declare_force(d, wants, unknowns, shape), sticking_gap)


def _declare_force(
    d: Declaration, wants: MagnetRequirements, unknowns: coil_blocks.CoilUnknowns, shape: pot_magnet.PotMagnet
) -> Any:
    """Declare the pull on the engaged armature; what the springs leave of it for the pack [N]."""
    pull = d.derive(
        "magnet_force",
        "N",
        pot_magnet.magnet_force(unknowns.flux_density, shape),
        symbol="F_m",
        text="Pull on the engaged armature",
        source="Maxwell; S4 (notes on centrifugal clutches), section 3.5",
    )
    d.at_least(
        HOLDS,
        pull,
        wants.return_spring_force,
        "N",
        guard=True,
        text="The engaged magnet is stronger than the return springs; otherwise nothing presses the pack",
        source=f"{S4}, section 6.6",
    )
    return d.derive(
        "actuation_force",
        "N",
        pull - wants.return_spring_force,
        symbol="F0",
        needs=HOLDS,
        text="Axial force on the pack: magnet less return springs",
        source=f"{S4}, section 6.6",
    )


def declare_pull(d: Declaration, pressed: Pressed, magnet: Magnet) -> Pull:
    """Declare the circuit with its limits, and the pull on the released armature."""
    wants, iron, unknowns, shape = magnet.wants, magnet.iron, magnet.unknowns, magnet.shape
    circuit = pot_magnet.Circuit(shape, iron.leakage_factor, iron.iron_reluctance, iron.iron_saturation)
    flux_density = unknowns.flux_density
    coil_blocks.declare_saturation(d, wants=iron, iron_flux_density=circuit.densest(flux_density))
    d.at_most(
        "pole_flux_density",
        circuit.pole(flux_density),
        iron.iron_flux_limit,
        "T",
        text="The iron of the poles carries the flux",
        source=f"{S4}, section 6.6",
    )
    d.at_most(
        "yoke_flux_density",
        circuit.yoke(flux_density),
        iron.iron_flux_limit,
        "T",
        text="Yoke and armature carry the flux at the inner pole",
        source=f"{S4}, section 6.6",
    )
    ampere_turns = circuit.ampere_turns(flux_density)
    released, springs = _name_release(d, wants=wants, surfaces=pressed.surfaces, gap=pressed.gap)
    pull_in = d.derive(
        "pull_in_force",
        "N",
        pot_magnet.pull_in_force(ampere_turns, released, shape.pole_area),
        symbol="F_in",
        needs="iron_saturation",
        text="Pull on the released armature, across all gaps of the pack",
        source=f"{S4}, section 6.6",
    )
    return Pull(circuit, ampere_turns, pull_in, springs)


def limit_pull_in(d: Declaration, magnet: Magnet, pull: Pull) -> None:
    """Declare that the magnet draws the released armature in."""
    d.at_least(
        "pull_in",
        pull.force,
        magnet.wants.pull_in_margin * pull.springs,
        "N",
        text="The magnet draws the released armature in",
        source=f"{S4}, section 6.6",
    )


def declare_coil(d: Declaration, pressed: Pressed, magnet: Magnet, pull: Pull) -> coil_blocks.Winding:
    """Declare the coil with its limits, and the remarks on the magnet."""
    duty, iron, unknowns, shape = pressed.duty, magnet.iron, magnet.unknowns, magnet.shape
    d.derive(
        "magnet_diameter",
        "mm",
        2 * shape.outer_radius,
        symbol="D_m",
        text="Outside of the outer pole",
        source="geometry",
    )
    around = coil_blocks.Surroundings(
        ambient_temperature=duty.ambient_temperature,
        temperature_limit=unknowns.winding_wire.insulation_temperature,
        heat_transfer=iron.still_heat_transfer,
        surface=cooling.effective(d, magnetics.cylinder_surface(shape.outer_radius, shape.body_length)),
        other_heat=heat.hourly_heat(pressed.start.friction_work, duty.engagements_per_hour),
    )
    winding = coil_blocks.declare_winding(
        d,
        wants=iron,
        unknowns=unknowns,
        ampere_turns=pull.ampere_turns,
        bore_radius=shape.inner_pole_radius,
        around=around,
    )
    _declare_remarks(d, magnet=magnet)
    return winding


def declare_magnet_size(
    d: Declaration, pressed: Pressed, magnet: Magnet, pull: Pull, winding: coil_blocks.Winding
) -> MagnetSize:
    """Declare the masses of the magnet, and name its shape."""
    unknowns, shape, density = magnet.unknowns, magnet.shape, pressed.duty.steel_density
    _name_shape(d, shape=shape, circuit=pull.circuit, flux_density=unknowns.flux_density)
    radius = shape.inner_pole_radius + unknowns.coil_height / 2
    copper = coil_blocks.declare_copper(d, section=winding.copper_section, radius=radius, source="geometry")
    mass = pot_magnet.magnet_mass(density, shape, copper)
    iron_mass = pot_magnet.magnet_mass(density, shape, 0.0)
    d.step("magnet_iron_mass", "kg", iron_mass, symbol="m_fe", text="Pot and armature", source="geometry")
    d.step("magnet_mass", "kg", mass, symbol="m_mag", text="Pot, armature and coil", source="geometry")
    return MagnetSize(mass=mass, copper=copper)


def name_length(d: Declaration, magnet: Magnet) -> None:
    """Name the length of the engaged magnet."""
    text = "Engaged magnet: pot, gap and armature"
    d.step("magnet_length", "mm", magnet.shape.length, symbol="L_mag", text=text, source="geometry")


def _name_shape(d: Declaration, *, shape: pot_magnet.PotMagnet, circuit: pot_magnet.Circuit, flux_density: Any) -> None:
    """Name radii, poles and the field of the iron of the magnet."""
    densest = circuit.densest(flux_density)
    field = magnetics.froehlich_field(densest, circuit.iron_reluctance, circuit.iron_saturation)
    for name, unit, value, symbol, text in (
        ("inner_pole_radius", "mm", shape.inner_pole_radius, "r_2", "Outside of the inner pole, inside of the coil"),
        ("coil_outer_radius", "mm", shape.coil_outer_radius, "r_3", "Outside of the coil"),
        (
            "magnet_radius",
            "mm",
            shape.outer_radius,
            "r_4",
            "Outside of the outer pole, whose area is that of the inner",
        ),
        ("outer_pole_width", "mm", shape.outer_pole_width, "w_o", "Radial width of the outer pole"),
        ("pole_section", "cm2", shape.pole_section, "q_p", "Area of one pole over pi"),
        ("pole_area", "cm2", shape.pole_area, "A_p", "Area of one pole"),
        ("disc_section", "cm2", shape.disc_section, "q_d", "Section of yoke and of armature over pi"),
        ("iron_path", "mm", shape.iron_path, "l_fe", "Mean length of the flux in iron"),
        ("yoke_ratio", "-", pot_magnet.yoke_flux_ratio(shape), "k_y", "Flux density of the yoke over that of the pole"),
        ("iron_flux_density", "T", densest, "B_fe", "Flux density of the iron that has most"),
        ("iron_field", "A/m", field, "H_fe", "Field of the iron after Froehlich"),
    ):
        d.step(name, unit, value, symbol=symbol, text=text, source=f"{S4}, section 6.6")


def _limit_in_oil(d: Declaration, ambient_temperature: Any) -> None:
    """Declare that the magnet is not too hot for the oil of its pack; a dry one has none."""
    oil = d.requirements.get("oil_temperature_limit")
    if oil is not None:
        hottest, text = oil.sx - ambient_temperature, "The oil stands the temperature of the magnet"
        d.at_most("coil_in_oil", d.derived["coil_temperature_rise"].sx, hottest, "K", text=text, source=UNSOURCED)


def limit_magnet(
    d: Declaration, pressed: Pressed, magnet: Magnet, pull: Pull, winding: coil_blocks.Winding, rules: MagnetRules
) -> None:
    """Declare the limits that an engineer adds to a magnet that presses a pack, and to its coil."""
    wants, unknowns = magnet.wants, magnet.unknowns
    coil_blocks.limit_coil(d, rules=rules, wants=magnet.iron, unknowns=unknowns)
    _limit_in_oil(d, pressed.duty.ambient_temperature)
    linkage = pull.circuit.linkage(unknowns.flux_density)
    rise = coil_blocks.declare_rise_time(d, rules=rules, winding=winding, linkage=linkage)
    worn_pull = _declare_worn_pull(d, pressed, magnet, pull)
    if rules.wear_adjust == "no":
        d.at_least(
            "pull_in_worn",
            worn_pull,
            wants.pull_in_margin * pull.springs,
            "N",
            text="The magnet draws the armature in over worn linings as well",
            source=f"{S4}, section 6.6; the armature follows the wear",
        )
    d.at_most(
        "rise_time",
        rise,
        pressed.ramp_time,
        "s",
        text="The current rises within the ramp that is counted on",
        source="L/R of the circuit; derived",
    )
    d.at_least(
        "ramp_time", pressed.ramp_time, rules.ramp_time_min, "s", text="An armature needs its time", source=UNSOURCED
    )


def _declare_worn_pull(d: Declaration, pressed: Pressed, magnet: Magnet, pull: Pull) -> Any:
    """Declare the pull on the released armature over worn linings [N]."""
    worn_gap = magnet.wants.residual_gap + plates.stroke(pressed.surfaces, pressed.gap, pressed.wear_depth)
    d.step(
        "worn_gap",
        "mm",
        worn_gap,
        symbol="g_worn",
        text="Gap at each pole of the released magnet over worn linings",
        source="the armature follows the wear; derived",
    )
    return d.derive(
        "worn_pull_in_force",
        "N",
        pot_magnet.pull_in_force(pull.ampere_turns, worn_gap, magnet.shape.pole_area),
        symbol="F_in_worn",
        needs="iron_saturation",
        text="Pull on the released armature over worn linings",
        source=f"{S4}, section 6.6; the armature follows the wear",
    )


def _name_release(d: Declaration, *, wants: MagnetRequirements, surfaces: Any, gap: Any) -> tuple[Any, Any]:
    """Name what the magnet pulls against when it draws the armature in; return gap [m] and force [N]."""
    released = d.step(
        "released_gap",
        "mm",
        wants.residual_gap + surfaces * gap,
        symbol="g_rel",
        text="Gap at each pole of the released magnet",
        source=f"{S4}, section 6.6",
    )
    force = d.step(
        "springs_and_drag",
        "N",
        wants.return_spring_force + wants.release_drag_force,
        symbol="F_hold",
        text="What holds the released armature back",
        source=f"{S4}, section 6.6",
    )
    return released, force


def _declare_remarks(d: Declaration, *, magnet: Magnet) -> None:
    wants = magnet.wants
    d.advise(
        "armature_sticks",
        wants.residual_gap < magnet.sticking_gap,
        "with a residual gap below 0.3 mm, or three quarters of its default with rules of practice, the remanence of "
        "the iron may hold the armature after the current is off",
        source=f"{S4}, section 6.6",
    )
    d.advise(
        "no_return_springs",
        wants.return_spring_force <= 0,
        "without return springs nothing draws the armature back: the plates drag after release",
        source=f"{S4}, section 6.6",
    )
    d.advise(
        "magnet_model",
        True,
        "the magnet is sized by a circuit with typical figures (leakage factor, residual gap, iron curve) that no "
        "source gives: confirm its force by a field calculation or a test",
        source=f"{S4}, section 6.6",
    )
