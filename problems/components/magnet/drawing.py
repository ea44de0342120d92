"""The engaged pot magnet in a section: armature, gap, pot and coil, and a detail of the gap."""

from __future__ import annotations

from dataclasses import dataclass

from synth.drawing import Area, Balloon, Detail, Dimension, Hatch, Item, Weight, diameter

from ...drawing_parts import Sizes, ring
from ..coil.drawing import DrawnCoil, drawn_coil
from ..drawn import DrawnComponent


@dataclass(frozen=True)
class PlacedMagnet(DrawnComponent):
    """The engaged magnet at its place, where it ends along the axis, and the radius above which it is measured [mm]."""

    end: float = 0.0
    top: float = 0.0


@dataclass(frozen=True)
class DrawnMagnet:
    """Bore, outside of the inner pole, outsides of coil and magnet, and gap at each pole [mm], with the coil."""

    bore: float
    inner: float
    outer: float
    radius: float
    gap: float
    coil: DrawnCoil

    def above(self, across: float) -> float:
        """Outside of the magnet or of a pack of a radius [mm]."""
        return max(across, self.radius)

    def placed(self, start: float, across: float, first: int) -> PlacedMagnet:
        """The magnet from the face of its armature on, behind a pack of a radius [mm].

        Numbers of its parts begin at ``first``.
        """
        numbers = armature, pot, winding = first, first + 1, first + 2
        top, inner, coil = self.above(across), self.inner, self.outer
        thick = self.coil.iron
        faces = start + thick + self.gap
        bottom = faces + self.coil.length
        end = bottom + thick
        dimensions = (
            Dimension((start, top), (end, top), "magnet_length", "top"),
            self.coil.around((start, top), (start + thick, top), "top", times=2),
            self.coil.along(faces, bottom, top),
            diameter(end, self.bore, "magnet_bore_radius", factor=2.0),
            diameter(bottom, inner, "inner_pole_radius", factor=2.0),
            diameter(bottom, coil, "coil_outer_radius", factor=2.0),
            diameter(end, self.radius, "magnet_diameter"),
        )
        return PlacedMagnet(
            self._shapes(start, faces, bottom, numbers),
            (
                Item(armature, "Armature", 1, "steel", hatch=Hatch.RIGHT),
                Item(pot, "Pot with both poles", 1, "steel", hatch=Hatch.LEFT),
                self.coil.item(winding),
            ),
            (
                Balloon((start + thick / 2, -(coil + 0.3 * (self.radius - coil))), armature, "bottom"),
                Balloon((faces + 0.4 * self.coil.length, -(inner + coil) / 2), winding, "bottom"),
                Balloon((bottom + thick / 2, -(inner + coil) / 2), pot, "bottom"),
            ),
            dimensions,
            (self._gap(start + thick, faces),),
            (Weight((armature, pot), ("magnet_iron_mass",), "steel_density"), self.coil.weight(winding)),
            end,
            top,
        )

    def _shapes(self, start: float, faces: float, bottom: float, numbers: tuple[int, int, int]) -> tuple[Area, ...]:
        """Armature, pot and coil, from the armature, the faces of the poles and the bottom of the window on [mm]."""
        armature, pot, winding = numbers
        bore, inner, coil, outside, thick = self.bore, self.inner, self.outer, self.radius, self.coil.iron
        end = bottom + thick
        shell = Area(
            (
                (faces, bore), (end, bore), (end, outside), (faces, outside), (faces, coil), (bottom, coil),
                (bottom, inner), (faces, inner),
            ),
            pot,
        )  # fmt: skip
        return (
            ring(start, start + thick, bore, outside, armature), shell, ring(faces, bottom, inner, coil, winding)
        )  # fmt: skip

    def _gap(self, armature: float, faces: float) -> Detail:
        """Detail of the gap between armature and faces of the poles [mm]."""
        reach, coil = 2.5 * self.gap, self.outer
        window = (armature - reach, coil - reach, faces + reach, min(coil + 2 * reach, self.radius + reach))
        y = coil + reach
        gap = Dimension((armature, y), (faces, y), "residual_gap", "bottom")
        return Detail("Y", window, (gap,), least=self.gap, side="right")


def drawn_magnet(size: Sizes) -> DrawnMagnet:
    """The magnet of a design."""
    bore, inner, outer = size("magnet_bore_radius"), size("inner_pole_radius"), size("coil_outer_radius")
    return DrawnMagnet(bore, inner, outer, size("magnet_radius"), size("residual_gap"), drawn_coil(size))
