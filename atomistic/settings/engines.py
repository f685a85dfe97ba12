"""Parameters that a scene may hand to the engines of ASE: those of the physics, by engine.

Everything else stays with the machine (ASE's own configuration file): what starts programs (`command`, `profile`),
where files are read or written (`directory`, `outdir`, `pseudo_dir`, `label`), raw input text (`inp`, `fdf_arguments`).
"""

import re
from collections.abc import Mapping
from typing import Any

ALLOWED: dict[str, tuple[str, ...]] = {
    "pyscf": (),
    "espresso": ("input_data", "pseudopotentials", "kspacing"),
    "vasp": (
        "xc", "gga", "encut", "ediff", "prec", "algo", "nelm", "nelmin", "ismear", "sigma", "ispin", "kspacing",
        "gamma", "lreal", "lasph", "addgrid", "setups",
    ),
    "abinit": ("xc", "ixc", "ecut", "pawecutdg", "toldfe", "nstep", "occopt", "tsmear", "kptopt", "pps"),
    "cp2k": (
        "xc", "basis_set", "pseudo_potential", "cutoff", "max_scf", "charge", "multiplicity", "uks",
        "force_eval_method", "poisson_solver", "stress_tensor",
    ),
    "gpaw": (
        "mode", "xc", "h", "kpts", "nbands", "convergence", "occupations", "spinpol", "setups", "basis", "maxiter",
    ),
    "siesta": ("xc", "mesh_cutoff", "energy_shift", "basis_set", "spin"),
}  # fmt: skip
ALLOWED_INSIDE = {
    "input_data": (
        "ecutwfc", "ecutrho", "input_dft", "occupations", "smearing", "degauss", "nspin", "nosym", "noinv",
        "conv_thr", "electron_maxstep", "mixing_beta", "mixing_mode", "diagonalization",
    ),
}  # fmt: skip
"""Keys of the mappings that hold keys of a code; the others map elements or options to values."""

PLAIN = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+-]{0,79}")
"""Text without a path, a quotation mark or a new line: it stands in input files."""


def refused_parameter(engine: str, parameters: Mapping[str, Any]) -> str | None:
    """What is wrong with the parameters of an engine, in one line; None: nothing."""
    for key, value in parameters.items():
        if key not in ALLOWED[engine]:
            return _refusal(engine, key, key, value, ALLOWED[engine])
        for inner, item in value.items() if isinstance(value, Mapping) else ():
            known = ALLOWED_INSIDE.get(key)
            if not PLAIN.fullmatch(inner) or (known is not None and inner not in known):
                return _refusal(engine, f"{key}.{inner}", inner, item, known or ())
            if isinstance(item, str) and not PLAIN.fullmatch(item):
                return _not_plain(f"{key}.{inner}", item)
        if isinstance(value, str) and not PLAIN.fullmatch(value):
            return _not_plain(key, value)
    return None


def _refusal(engine: str, place: str, key: str, value: Any, known: tuple[str, ...]) -> str:
    accepted = ", ".join(known) or ("none" if PLAIN.fullmatch(key) else "plain names")
    return (
        f"parameters.{place:.60} = {str(value)!r:.60}: not a parameter that a scene may give to {engine} (accepted: "
        f"{accepted}); programs and folders belong in ASE's own configuration file"
    )


def _not_plain(place: str, value: str) -> str:
    return f"parameters.{place} = {value!r:.60}: accepted is a plain name of letters, digits and _ . + -, no path"
