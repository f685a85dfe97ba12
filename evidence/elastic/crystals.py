"""Do bulk moduli and volumes of known crystals agree with published ones?

E(V) of β-Si3N4, silicon and stishovite with PBE and LDA, by the engine and the settings of the
glasses.  Each value stands beside one of the same functional, or of experiment where none is known.
Ten minutes of one core.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from atomistic.elastic.energy_scans import fit_scan, scan_rows
from atomistic.elastic.networks import crystal
from atomistic.materials import load_materials
from atomistic.settings import ElasticSettings
from evidence.record import ROOT


def arguments(parser: ArgumentParser) -> None:
    """Which crystals."""
    parser.add_argument("--crystals", nargs="+", default=["beta", "silicon", "stishovite"])


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A crystal with one functional beside its published value."""
    settings = ElasticSettings()
    for material in load_materials(ROOT / "config" / "materials").values():
        for name, data in material.crystals.items():
            for xc in ("GGA", "LDA") if name in given.crystals else ():
                atoms = crystal(material, name)
                dft = settings.dft.model_copy(
                    update={"cutoff_Ha": data.cutoff_Ha or settings.dft.cutoff_Ha}
                )
                points = scan_rows(name, atoms, xc, dft)
                fit = fit_scan([{key: str(value) for key, value in row.items()} for row in points])
                kind = xc if xc in data.published else "experiment"
                known = data.published[kind]
                yield {
                    **{
                        key: fit[key]
                        for key in ("structure", "xc", "atoms", "B_GPa", "B_prime", "residual_meV")
                    },
                    "flags": fit["flags"],
                    "V0_A3": fit["V0_A3"] * known.atoms / len(atoms) if fit["V0_A3"] else None,
                    "V0_atoms": known.atoms,
                    "published": kind,
                    "published_B_GPa": known.B_GPa,
                    "published_V0_A3": known.V0_A3,
                    "published_source": " ".join(known.source),
                    "wall_s": sum(row["wall_s"] for row in points),
                }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Largest deviations from values of the same functional."""
    same = [row for row in rows if row["published"] == row["xc"]]
    B = [float(row["B_GPa"]) / float(row["published_B_GPa"]) - 1 for row in same]
    V = [
        float(row["V0_A3"]) / float(row["published_V0_A3"]) - 1
        for row in same
        if row["published_V0_A3"]
    ]
    return {
        "B_deviation": f"{100 * max(map(abs, B)):.0f} %",
        "V0_deviation": f"{100 * max(map(abs, V)):.1f} %",
    }
