"""Packages with families that somebody else has made and installed beside ours."""

from collections.abc import Mapping
from pathlib import Path

BRACKET = '''
import synth


class Bracket(synth.DesignProblem):
    """A cantilever of flat steel."""

    name, title, sources = "flat_bracket", "Flat bracket", ("beam theory",)

    def declare(self, d):
        load = d.requirement("load", "N", lower=1, upper=1e5, symbol="F", source="beam theory, load at the end")
        reach = d.requirement("reach", "mm", 200, lower=10, upper=2000, symbol="L")
        height = d.variable("height", "mm", 5, 100, grid=1, symbol="h")
        plates = d.count("plates", 1, 4, symbol="n")
        d.derive("mass", "kg", 7850 * 0.02 * plates * height * reach, symbol="m")
        d.derive("deflection", "mm", 4 * load * reach**3 / (210e9 * 0.02 * plates * height**3), symbol="f")
        d.at_most("stress", 6 * load * reach / (0.02 * plates * height**2), 120e6, "N/mm2")
        d.objective("mass")
        d.objective("deflection")
'''

NOT_IMPORTED = "raise ImportError('needs what is not installed')\n"
NOT_DECLARED = '''
import synth


class Wrong(synth.DesignProblem):
    """Its declaration asks for a value."""

    name = title = "wrong"

    def declare(self, d):
        size = d.variable("size", "mm", 1, 2)
        d.derive("mass", "kg", 1.0 if size > 1 else 2.0)
        d.objective("mass")
'''


def installed_beside(
    folder: Path, families: Mapping[str, tuple[str, str]] = {"flat_bracket": (BRACKET, "Bracket")}
) -> Path:
    """Folder for the search path of Python in which a package registers families.

    Parameters
    ----------
    folder : Path
        Is made.
    families : mapping
        Name of a family -> its source and the name of its class.
    """
    info = folder / "other_families-1.0.dist-info"
    info.mkdir(parents=True)
    points = ["[clutchsynth.problems]"]
    for name, (source, made) in families.items():
        (folder / f"{name}_family.py").write_text(source)
        points.append(f"{name} = {name}_family:{made}")
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: other-families\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("\n".join(points) + "\n")
    return folder
