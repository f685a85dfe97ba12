"""Effective elastic modulus: figure 5."""

from collections.abc import Iterator

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import BLUE, SERIES, draw
from workflow.report.numbers import cell, column, number, show
from workflow.report.page import Block, Figure, stage, table


@stage(
    "Effective elastic modulus",
    *("elastic/bulk_moduli.csv", "elastic/e_star.json"),
    also=("elastic/points.csv",),
)
def describe(results: Results) -> Iterator[Block]:
    """Figure 5, and every structure."""
    summary = results.json("elastic/e_star.json")
    yield (
        "Density functional theory on an ensemble of Si₃N₄ structures: E* = "
        f"{show(summary.get('mean_GPa'))} ± {show(summary.get('std_GPa'))} GPa."
    )
    yield Figure(
        elastic_distribution(results),
        "Left: bulk moduli of the glasses by E(V); dashed: a crystal. Right: the modulus E* of the"
        " contact, variability and model-form error included.",
        "Figure 5",
        wide=True,
    )
    yield table(
        "Equation of state of every structure, ions clamped",
        results.csv("elastic/bulk_moduli.csv"),
        {
            "structure": "structure",
            "functional": "xc",
            "B (GPa)": cell("B_GPa", 4),
            "B′": cell("B_prime"),
            "V₀ (Å³)": cell("V0_A3", 4),
            "flags": "flags",
        },
    )
    yield from summary.get("notes", [])


def elastic_distribution(results: Results) -> str | None:
    """Figure 5: bulk moduli of the ensemble and the resulting E*."""
    rows = results.csv("elastic/bulk_moduli.csv")
    summary = results.json("elastic/e_star.json")
    samples = (
        results.h5("elastic/e_star.h5")[0].get("samples", {})
        if results.has("elastic/e_star.h5")
        else {}
    )
    glasses = {
        *summary.get("structures_used", []),
        *(left_out["structure"] for left_out in summary.get("kept_out", [])),
    }
    trusted = [
        row for row in rows if not row.get("flags") and np.isfinite(number(row.get("B_GPa")))
    ]

    def plot(axis, other):
        moduli = column(trusted, "B_GPa")
        bins = (
            np.linspace(moduli.min() - 5, moduli.max() + 5, 12)
            if moduli.size
            else np.linspace(0, 1, 2)
        )
        for xc, color in zip(sorted({row["xc"] for row in rows}), SERIES, strict=False):
            kind = [row for row in trusted if row["xc"] == xc]
            of_glasses = column([row for row in kind if row["structure"] in glasses], "B_GPa")
            if of_glasses.size:
                axis.hist(
                    of_glasses,
                    bins=bins,
                    color=color,
                    alpha=0.5,
                    label=f"{xc.upper()}, clamped ions",
                    linewidth=0,
                )
            for row in kind:
                if row["structure"] not in glasses:
                    crystal = f"{row['structure']} crystal, {xc.upper()}"
                    axis.axvline(number(row["B_GPa"]), color=color, linestyle="--", label=crystal)
        axis.set(xlabel="bulk modulus B (GPa)", ylabel="structures")
        axis.set_ylim(0, 1.7 * axis.get_ylim()[1])  # room for the legend
        axis.yaxis.get_major_locator().set_params(integer=True)
        axis.legend()
        if "e_star_GPa" in samples:
            other.hist(
                samples["e_star_GPa"], bins=50, density=True, color=BLUE, alpha=0.5, linewidth=0
            )
        other.set(xlabel="E* (GPa)", ylabel="density (1/GPa)", ylim=(0, None))

    return draw(
        "fig5",
        "Bulk moduli of the structures and the effective modulus",
        plot,
        (9.4, 3.7),
        columns=2,
    )
