"""Materials from data files (config/materials), checked: crystals, glasses, potentials.

A file holds what the stages need of it: `oxide_glass` for the hardness stage, `network_glass` for
the body that the elastic stage computes, `polycrystal` for the body it is pressed against,
`crystals` as anchors.
"""

import operator
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, model_validator

from asperity.guards.errors import InputError
from asperity.guards.settings import Settings, load_settings

SEARCHED_A = 3.0  # neighbours are sought up to this distance, so no bond may be longer
SHORTEST_BOND_A = 1.2  # the first peak of g(r) is sought beyond this


def _rising(values: tuple[float, float]) -> tuple[float, float]:
    if not values[0] < values[1]:
        raise ValueError(
            f"must rise: the low value {values[0]:g} is not below the high one {values[1]:g}"
        )
    return values


def _determinant(rows: list[tuple[int, int, int]]) -> int:
    """Of three rows of three, which is the volume that they span."""
    first, (a, b, c), (d, e, f) = rows
    cross = (b * f - c * e, c * d - a * f, a * e - b * d)
    return sum(map(operator.mul, first, cross))


Positive = Annotated[float, Field(gt=0)]
Range = Annotated[tuple[Positive, Positive], AfterValidator(_rising)]
Distance = Annotated[float, Field(gt=0, le=SEARCHED_A)]
Ratio = Annotated[float, Field(gt=-1, lt=0.5)]  # Poisson's, of a stable isotropic solid
Count = Annotated[int, Field(ge=1)]
# elements stand in LAMMPS's commands, where $(...), ${...} or a new line would be evaluated
Element = Annotated[str, Field(pattern=r"^[A-Z][a-z]?$")]
ElementPair = Annotated[str, Field(pattern=r"^[A-Z][a-z]?-[A-Z][a-z]?$")]
Vector = tuple[float, float, float]
Repeats = tuple[int, int, int]
Supercell = tuple[Count, Count, Count] | tuple[Repeats, Repeats, Repeats]


class _Section(Settings):
    """A part of a material file: an unknown key is refused with the list of those that exist."""

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, content: Any) -> Any:
        known = [field.alias or name for name, field in cls.model_fields.items()]
        if isinstance(content, dict) and (unknown := [key for key in content if key not in known]):
            raise ValueError(f"unknown key {unknown[0]!r:.60}; accepted are {', '.join(known)}")
        return content


class Published(_Section):
    """Known bulk modulus and volume of a crystal of `atoms` atoms, as the source prints them."""

    B_GPa: Annotated[int | float, Field(gt=0)]
    V0_A3: Annotated[int | float, Field(gt=0)] | None
    atoms: Count
    source: tuple[str, ...] = Field(min_length=1)


class Crystal(_Section):
    """A crystal by its space group; lengths in Å, angles in degrees."""

    spacegroup: int = Field(ge=1, le=230)
    setting: Literal[1, 2] = 1
    cell: tuple[Positive, Positive, Positive, Positive, Positive, Positive]
    sites: dict[Element, tuple[Vector, ...]]
    primitive: bool = False
    supercell: Supercell
    source: str
    cutoff_Ha: Positive | None = Field(
        default=None, description="of the density; None: that of the scene"
    )
    published: dict[Literal["GGA", "LDA", "experiment"], Published] = Field(default={})

    @model_validator(mode="after")
    def _has_volume(self) -> "Crystal":
        if max(self.cell[3:]) >= 180:
            raise ValueError(f"cell: angles must be below 180 degrees, got {max(self.cell[3:]):g}")
        rows = [row for row in self.supercell if not isinstance(row, int)]
        if rows and _determinant(rows) < 1:
            raise ValueError("supercell: its rows must span a right-handed cell of whole cells")
        return self


class Quenched(_Section):
    """What a quench here gives, for estimates of cost."""

    atoms_per_nm3: Positive
    source: str


class OxideGlass(_Section):
    """What experiment says of an oxide glass; the accepted ranges are those of a fast quench."""

    density_g_cm3: Positive
    density_range_g_cm3: Range
    bond_A: float = Field(
        gt=SHORTEST_BOND_A, lt=SEARCHED_A, description="first peak of g(r) of cation and oxygen"
    )
    bond_range_A: Range
    cation_coordination: Positive
    coordination_range: Range
    cutoff_A: Distance = Field(description="first minimum of that g(r)")
    quenched: Quenched
    indentation_GPa: Range | None = Field(
        None, description="hardness by a Berkovich tip, lowest and highest found"
    )
    sources: tuple[str, ...] = Field(min_length=1)

    @model_validator(mode="after")
    def _consistent(self) -> "OxideGlass":
        for key, value, (low, high) in (
            ("density_g_cm3", self.density_g_cm3, self.density_range_g_cm3),
            ("bond_A", self.bond_A, self.bond_range_A),
            ("cation_coordination", self.cation_coordination, self.coordination_range),
        ):
            if not low <= value <= high:
                raise ValueError(f"{key} = {value:g} must lie in its range {low:g} to {high:g}")
        if self.cutoff_A <= self.bond_A:
            raise ValueError(
                f"cutoff_A = {self.cutoff_A:g} must be longer than bond_A = {self.bond_A:g}"
            )
        return self


class TersoffAtom(_Section):
    """Tersoff parameters of an element: A, B in eV, lambda, mu in 1/Å, R, S in Å."""

    A: Positive
    B: Positive
    lambda_: Positive = Field(alias="lambda")
    mu: Positive
    beta: Positive
    n: Positive
    c: Positive
    d: Positive
    h: float = Field(ge=-1, le=1)
    R: Positive
    S: Positive
    source: str
    confidence: str

    @model_validator(mode="after")
    def _ends_after_it_fades(self) -> "TersoffAtom":
        if self.S <= self.R:
            raise ValueError(f"S = {self.S:g} must be longer than R = {self.R:g}")
        return self


class Tersoff(_Section):
    """Tersoff potential of several elements; `chi` scales the attraction of a pair."""

    elements: dict[Element, TersoffAtom] = Field(min_length=1)
    chi: dict[ElementPair, Annotated[float, Field(ge=0)]]


class Core(_Section):
    """Soft core k (r_c - r)^2 of a pair."""

    k_eV_A2: Positive
    r_A: Positive


class NetworkGlass(_Section):
    """Gates that an amorphous network must pass, and the cheap potential that makes it."""

    valence: dict[Element, Count]
    density_g_cm3: Range
    coordination: dict[Element, Range]
    shortest_A: dict[ElementPair, Distance]
    gap_eV: Positive = Field(description="least gap after relaxation")
    bond_spread_A: Positive = Field(
        description="standard deviation of bond lengths: below it the cell is crystalline"
    )
    symmetry_tolerance_A: Positive = Field(
        description="by which atoms may miss each other under a symmetry operation"
    )
    cutoff_A: Distance = Field(description="longest bond of unlike elements")
    start_density_g_cm3: Positive
    edges: tuple[Positive, Positive, Positive] = Field(description="ratio of the cell's edges")
    sources: tuple[str, ...] = Field(min_length=1)
    tersoff: Tersoff
    cores: dict[ElementPair, Core]
    masses_u: dict[Element, Positive]
    ions_follow: tuple[Positive, float] | None = Field(
        None,
        description=(
            "bulk modulus with ions that follow a strain, over that of clamped ions: mean,"
            " deviation"
        ),
    )


class FilmKind(_Section):
    """Measured elasticity of films by the way in which they are made."""

    young_GPa: Range
    poisson_ratio: tuple[Ratio, Ratio]
    source: list[str] = Field(min_length=1)


class Polycrystal(_Section):
    """Isotropic elastic constants of a body from experiment."""

    young_GPa: Positive
    young_std_GPa: float = Field(default=0.0, ge=0)
    poisson_ratio: Ratio
    source: str


class Eam(_Section):
    """Embedded-atom potential of a metal in closed form (doi:10.1103/PhysRevB.69.144113).

    Energies in eV, distances in Å; `r` is the nearest distance, `f` and `rho` are electron
    densities of one unit.
    """

    mass_u: Positive
    lattice_A: tuple[Positive, Positive] = Field(
        description="a and c of the hexagonal crystal at 0 K"
    )
    r_A: Positive
    f: Positive
    rho: Positive
    alpha: Positive
    beta: Positive
    A_eV: Positive
    B_eV: Positive
    kappa: Positive
    lambda_: Positive = Field(alias="lambda")
    F_inner_eV: tuple[float, float, float, float] = Field(
        description="F_n of densities below 0.85 rho"
    )
    F_middle_eV: tuple[float, float, float, float] = Field(description="F up to 1.15 rho")
    F_outer_eV: float = Field(description="F_e beyond")
    eta: Positive
    source: str


class MorseBond(_Section):
    """Morse bond of an atom of the base and an ion of a film."""

    D_eV: Positive
    a_1_per_A: Positive
    r0_A: Positive


class FilmBase(_Section):
    """What a body below an oxide film is like, and how ions of the film act on its atoms.

    A pair names the atom of the base first.
    """

    grain_nm: Positive | None = Field(
        default=None,
        description=(
            "of a metal, whose grains make it soft: diameter of a sphere of their mean volume"
        ),
    )
    timestep_factor: float = Field(
        default=1.0, gt=0, le=1, description="on the time step of a closing"
    )
    bonds: dict[ElementPair, MorseBond] = Field(min_length=1)
    repelled: tuple[ElementPair, ...] = Field(description="pairs that only repel each other")
    area_error: float = Field(
        ge=0,
        le=0.1,
        description="largest of the contact area on a film or on the body by itself, as a fraction",
    )
    source: str


class Material(_Section):
    """A material; every number names one of its `sources`."""

    name: str = Field(pattern=r"^[a-z][a-z0-9_]{0,39}$", description="that of the file")
    formula: dict[Element, Count] = Field(min_length=1)
    sources: dict[str, str] = Field(min_length=1)
    crystals: dict[Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")], Crystal] = Field(default={})
    oxide_glass: OxideGlass | None = None
    network_glass: NetworkGlass | None = None
    films: dict[str, FilmKind] = Field(default={})
    polycrystal: Polycrystal | None = None
    eam: Eam | None = None
    film_base: FilmBase | None = None

    @property
    def formula_text(self) -> str:
        """The formula in a word, as scenes and potentials name an oxide: SiO2."""
        return "".join(
            f"{element}{count if count > 1 else ''}" for element, count in self.formula.items()
        )

    def part(
        self, section: Literal["oxide_glass", "network_glass", "polycrystal", "eam", "film_base"]
    ) -> Any:
        """A section that a stage cannot do without.

        Raises
        ------
        InputError : the material has none.
        """
        data = getattr(self, section)
        if data is None:
            raise InputError(
                f"material {self.name}: its file has no section {section}; add one as"
                " docs/extending.md says, or choose another material"
            )
        return data

    @model_validator(mode="after")
    def _consistent(self) -> "Material":
        if unknown := sorted(
            _named_sources(self.model_dump(exclude={"sources"})) - set(self.sources)
        ):
            raise ValueError(f"source {unknown[0]!r:.60} is used but not listed under `sources`")
        of_sections = {
            f"crystals.{name}.sites": set(crystal.sites) for name, crystal in self.crystals.items()
        }
        if (glass := self.network_glass) is not None:
            of_sections |= {
                f"network_glass.{key}": set(getattr(glass, key)) for key in ("valence", "masses_u")
            }
            of_sections["network_glass.tersoff.elements"] = set(glass.tersoff.elements)
        for key, elements in of_sections.items():
            if elements != set(self.formula):
                raise ValueError(
                    f"{key} has {', '.join(sorted(elements))}; it must have"
                    f" {', '.join(self.formula)}"
                )
        if self.oxide_glass is not None and (len(self.formula) != 2 or "O" not in self.formula):
            raise ValueError(
                f"oxide_glass: needs a formula of one cation and O, got {self.formula_text}"
            )
        if self.film_base is not None and (self.eam is None) == (self.network_glass is None):
            raise ValueError(
                "film_base: needs the potential of its body; add a section eam or network_glass"
            )
        if self.film_base is not None and (self.eam is None) != (self.film_base.grain_nm is None):
            raise ValueError("film_base: grain_nm is of a metal, and every metal needs it")
        if self.eam is not None and len(self.formula) != 1:
            raise ValueError(f"eam: needs a formula of one element, got {self.formula_text}")
        return self


def _named_sources(content: Any) -> set[str]:
    """Every name under a key `source` or `sources`, however deep."""
    if not isinstance(content, dict):
        return set()
    names: set[str] = set()
    for key, value in content.items():
        names |= _named_sources(value)
        if key in ("source", "sources"):
            names |= {value} if isinstance(value, str) else set(value)
    return names


def load_material(path: str | Path) -> Material:
    """Read and check a material file.

    Raises
    ------
    InputError : unreadable or malformed file, unknown key, missing or non-physical value, unnamed
        source.
    """
    path = Path(path)
    material = load_settings(Material, path, "material", "config/materials/silicon_dioxide.yaml")
    if material.name != path.stem:
        raise InputError(
            f"{path}: name: must be that of the file, {path.stem!r} (got {material.name!r})"
        )
    return material


def load_materials(folder: str | Path) -> dict[str, Material]:
    """Every material of a folder by name.

    Raises
    ------
    InputError : a file is not accepted, or two name the same crystal or have an oxide glass of the
        same formula.
    """
    paths = sorted(Path(folder).glob("*.yaml"))
    materials = {path.stem: load_material(path) for path in paths}
    owners: dict[str, Path] = {}
    for path, material in zip(paths, materials.values(), strict=True):
        glass = [f"oxide glass {material.formula_text}"] if material.oxide_glass else []
        for thing in [*(f"crystal {name}" for name in material.crystals), *glass]:
            if thing in owners:
                raise InputError(f"{path}: {thing} stands in {owners[thing]} too; keep one")
            owners[thing] = path
    return materials


def oxide_glasses(materials: Iterable[Material]) -> Mapping[str, Material]:
    """The materials with an oxide glass by formula, as a scene's hardness.material names them."""
    return {
        material.formula_text: material
        for material in materials
        if material.oxide_glass is not None
    }
