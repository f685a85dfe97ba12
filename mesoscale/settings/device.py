"""Settings of the switch."""

import re
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from asperity.guards.settings import Settings, key
from mesoscale.settings.inputs import DistributionRow

if TYPE_CHECKING:  # rules read settings, and are linted where Snakemake is alone
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

REFERENCE_C = 20.0
"""Temperature at which stress and shape at rest are stated."""
PartOfBeam = tuple[float, float]
NOTHING = (
    ("measured", None),
    ("release_at", "jump"),
    ("anchor_rad_per_uN_m", 0.0),
    ("shift_V", 0.0),
    ("charge_e_cm2", 0.0),
    ("uneven", None),
)
"""Keys that say nothing, and are left out of results."""
EVEN_CHARGE = ("shift_V", "charge_e_cm2")
"""Properties that shift the voltage which the electrode feels."""
Share = Annotated[float, Field(gt=0.0, lt=1.0)]
Positive = Annotated[float, Field(gt=0.0)]


class SpreadRow(DistributionRow):
    """By how much one property of the device departs from its stated value."""

    relative: bool = key(False, "whether departures are shares of the stated value")
    varies: Literal["common", "each"] = key(
        "each", "one unknown value for all devices (common), or another for each of them"
    )


ASSUMED = "assumption, to be replaced by a measurement"


def _departs(name: str, row: SpreadRow | None) -> Any:
    return key(row, f"departures of device.{name}; null: exactly known")


def _normal(deviation: float, source: str = ASSUMED, **what: Any) -> SpreadRow:
    return SpreadRow(distribution="normal", values=(0.0, deviation), source=source, **what)


NICKEL_GPa = 152.0
"""Mean modulus of plated nickel, by the published values of config/materials/plated_nickel.csv."""
PLATED_NICKEL = SpreadRow(
    distribution="truncated_normal",
    values=(0.0, 0.30, -0.6, 0.6),
    source=(
        "seven published values of plated nickel, 85 to 205 GPa"
        " (config/materials/plated_nickel.csv), cut at Voigt's bound of 242 GPa"
    ),
    relative=True,
    varies="common",
)
"""Scatter of plated nickel from bath to bath, of a beam whose modulus nobody stated."""
STATED_MODULUS = _normal(
    0.05, f"{ASSUMED}; of a modulus that the scene states", relative=True, varies="common"
)
"""The same of a modulus that is stated."""


class SpreadSettings(Settings):
    """Departures of a device from its stated properties, uncertain inputs (docs/answer.md)."""

    thickness_um: SpreadRow | None = _departs("thickness_um", _normal(0.02, relative=True))
    gap_um: SpreadRow | None = _departs("gap_um", _normal(0.02, relative=True))
    youngs_modulus_GPa: SpreadRow | None = _departs("youngs_modulus_GPa", PLATED_NICKEL)
    residual_stress_MPa: SpreadRow | None = _departs("residual_stress_MPa", _normal(5.0))
    dielectric_nm: SpreadRow | None = _departs(
        "dielectric_nm",
        _normal(
            0.03,
            "nitride over a wafer: 2.5 % by LPCVD, 7 % by PECVD (MEMS Exchange, processes P3684 and"
            " P3822)",
            relative=True,
        ),
    )
    permittivity: SpreadRow | None = _departs(
        "permittivity", _normal(0.05, relative=True, varies="common")
    )
    bow_nm: SpreadRow | None = _departs("bow_nm", _normal(200.0))
    tilt_nm: SpreadRow | None = _departs("tilt_nm", _normal(200.0))
    temperature_C: SpreadRow | None = _departs("temperature_C", None)
    shift_V: SpreadRow | None = _departs("shift_V", None)
    charge_e_cm2: SpreadRow | None = _departs("charge_e_cm2", None)

    @model_serializer(mode="wrap")
    def _without_charge(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Charge that does not vary is left out, so that results without it stay as they were."""
        return {
            name: row
            for name, row in dump(self).items()
            if row is not None or name not in EVEN_CHARGE
        }


class UnevenCharge(Settings):
    """Charge at the surface of the dielectric that differs from place to place, about its mean.

    It is stated by waves, by round patches at random places, or by what a flat electrode feels.
    """

    waves: tuple[tuple[Positive, Positive], ...] = key(
        (), "periods (nm), and root mean square density (1/cm^2) of the waves of each", "nm, 1/cm^2"
    )
    patch_nm: float | None = key(None, "radius of round patches at random places", "(0, 1e6] nm")
    e_cm2: float = key(
        0.0,
        "root mean square departure of the density of patches from its mean",
        "[0, 1e14] 1/cm^2",
    )

    felt: tuple[tuple[float, float], ...] = key(
        (),
        "separations (nm), rising, and what the charge adds to the square of the voltage there"
        " (V^2)",
        "nm, V^2",
    )

    @model_validator(mode="after")
    def _one_of_three(self) -> "UnevenCharge":
        if bool(self.waves) + (self.patch_nm is not None) + bool(self.felt) != 1:
            raise ValueError("give one of waves, felt, and patch_nm with e_cm2")
        if self.patch_nm is None and self.e_cm2:
            raise ValueError("e_cm2 is that of patches; waves have a density of their own each")
        places = [separation for separation, _ in self.felt]
        if places != sorted(set(places)) or any(square < 0.0 for _, square in self.felt):
            raise ValueError("felt: separations rise, and squares are not below 0")
        return self


_STATED = re.compile(r"(.+?)(?:\+-|±)(.+)")


def _value_and_error(stated: Any) -> Any:
    """The two numbers of a text such as 72 +- 2; two numbers in a list as they are."""
    if isinstance(stated, (list, tuple)) and len(stated) == 2:
        return tuple(stated)
    both = _STATED.fullmatch(str(stated).replace(" ", ""))
    value, error = both.groups() if both else ("", "")
    try:
        return float(value), float(error)
    except ValueError:
        raise ValueError("accepted are a value and its standard error, as in 72 +- 2") from None


ValueAndError = Annotated[
    tuple[Positive, Positive],
    BeforeValidator(_value_and_error, json_schema_input_type=tuple[Positive, Positive] | str),
]
"""A measured value and its standard error."""


def _measured(meaning: str, unit: str) -> Any:
    return key(None, f"{meaning}: value and standard error, as in 72 +- 2", unit)


class MeasuredSettings(Settings):
    """What was measured of the open device, which narrows its properties (docs/switch.md)."""

    pull_in_V: ValueAndError | None = _measured("pull-in", "V")
    capacitance_fF: ValueAndError | None = _measured("capacitance without voltage", "fF")
    resonance_kHz: ValueAndError | None = _measured("lowest resonance, in a vacuum", "kHz")

    @property
    def stated(self) -> dict[str, tuple[float, float]]:
        """Values and errors of what was measured, by name."""
        return {name: pair for name, pair in self if pair is not None}


MEASURABLE = tuple(MeasuredSettings.model_fields)
"""What can be measured of an open device."""
SPREAD = tuple(SpreadSettings.model_fields)
"""The properties of a device that can be uncertain."""
Kind = Literal["beam", "plate"]
UNCERTAIN: dict[Kind, tuple[str, ...]] = {
    "beam": SPREAD,
    "plate": ("gap_um", "dielectric_nm", "permittivity", *EVEN_CHARGE),
}
"""Of these, the properties that act on each kind of switch."""
DESIGNED: dict[Kind, tuple[str, ...]] = {
    "beam": (
        "thickness_um",
        "length_um",
        "gap_um",
        "residual_stress_MPa",
        "dielectric_nm",
        "hold_voltage_V",
    ),
    "plate": ("spring_N_per_m", "width_um", "gap_um", "dielectric_nm", "hold_voltage_V"),
}
"""What a designer chooses of each kind, as the answer varies it; the first is the spring."""


class DeviceSettings(Settings):
    """Switch driven by the force-separation law (docs/switch.md).

    The defaults are the published fixed-fixed beam of the PRISM capacitive switch, of plated
    nickel.
    """

    ends: Literal["clamped", "cantilever"] = key(
        "clamped", "beam clamped at both ends, or at its first end only"
    )
    length_um: float = key(510.0, "length of the beam", "[0.01, 1e4] um")
    width_um: float = key(123.0, "width of the beam", "[0.01, 1e5] um")
    thickness_um: float = key(4.0, "thickness of the beam", "[0.001, 1000] um")
    gap_um: float = key(
        3.49,
        "distance from the beam at rest to the mean plane of the dielectric",
        "(0.01, 1000] um",
    )
    youngs_modulus_GPa: float = key(
        NICKEL_GPa,
        "Young's modulus of the beam; default: mean of plated nickel, which varies by 30 %; one"
        " that you state varies by 5 %",
        "[0.001, 2000] GPa",
    )
    poisson_ratio: float = key(0.3, "Poisson's ratio of the beam", "[0, 0.5)")
    bends_as: Literal["beam", "plate"] | None = key(
        None,
        "bends with E (beam) or E/(1 - nu^2) (plate); null: as a plate from a width of 5"
        " thicknesses on",
    )
    residual_stress_MPa: float = key(
        0.0,
        "residual stress at rest at 20 C; negative: compressive, beyond Euler's it buckles",
        "[-2000, 2000] MPa",
    )
    buckled: Literal["up", "down"] = key(
        "up", "side of a buckled beam; up: away from the dielectric"
    )
    temperature_C: float = key(REFERENCE_C, "temperature of the switch", "[-270, 2000] C")
    excess_expansion_ppm_C: float = key(
        10.8,
        "thermal expansion of the beam less the substrate's; default: nickel 13.4, silicon 2.6",
        "[-1000, 1000] 1e-6/C",
    )
    anchor_um_per_N: float = key(
        0.0, "how far both anchors together give way to the axial force", "[0, 1e9] um/N"
    )
    anchor_rad_per_uN_m: float = key(
        0.0, "how far each anchor turns under the moment of the beam", "[0, 1e9] rad/(uN m)"
    )
    spring_N_per_m: float | None = key(
        None, "stiffness of a plate of length times width; null: a beam", "[0.001, 1e6] N/m"
    )
    electrode: PartOfBeam = key(
        (0.0, 1.0), "part of the beam over the electrode, from and to", "share of the length"
    )
    contact: PartOfBeam = key(
        (0.0, 1.0), "part over the rough pad, from and to", "share of the length"
    )
    dimple_nm: float = key(0.0, "height of a dimple under the contact part", "[0, 1e5] nm")
    stopper_nm: float = key(
        0.0, "height of rigid stoppers elsewhere; 0: the dielectric itself", "[0, 1e5] nm"
    )
    fringe: float = key(
        0.64,
        "pull at the sides, as gaps of more width; a thin strip: 0.64 (Palmer, Trans. AIEE 56"
        " (1937) 363)",
        "[0, 10]",
    )
    bow_nm: float = key(
        0.0,
        "height at rest of the middle (cantilever: of the tip) over the anchors",
        "[-1e5, 1e5] nm",
    )
    tilt_nm: float = key(0.0, "height at rest of the last end over the first", "[-1e5, 1e5] nm")
    spread: SpreadSettings = key(
        SpreadSettings(), "departures from these properties, as uncertain inputs"
    )
    dielectric_nm: float = key(200.0, "thickness of the dielectric", "[0, 1e5] nm")
    permittivity: float = key(7.9, "relative permittivity of the dielectric", "[1, 1e5]")
    shift_V: float = key(
        0.0,
        "shift of the voltage that the electrode feels, V - shift_V, by contact potential or even"
        " charge; of the sign of the drive: it raises both voltages",
        "[-1000, 1000] V",
    )
    charge_e_cm2: float = key(
        0.0,
        "even charge at the surface of the dielectric, whose shift adds to shift_V; with its sign",
        "[-1e14, 1e14] 1/cm^2",
    )
    uneven: UnevenCharge | None = key(
        None, "charge that differs from place to place; null: none (docs/charging.md)"
    )
    density_g_cm3: float = key(
        8.9, "density of the electrode, which moves; default: nickel", "[0.01, 30] g/cm^3"
    )
    gas_kPa: float = key(
        101.325, "pressure of the air around the electrode, for its motion", "[1e-6, 1e4] kPa"
    )
    hold_voltage_V: float | None = key(
        None, "voltage of the closed switch; null: its pull-in voltage", "[0.001, 1e4] V"
    )
    release_at: Literal["jump"] | Share = key(
        "jump",
        "which voltage is the release: at the jump open (jump), or where the capacitance has fallen"
        " to this share of that while held, as in 0.5",
    )
    measured: MeasuredSettings | None = key(
        None, "what was measured of this device; null: its properties are known by `spread` alone"
    )

    @model_serializer(mode="wrap")
    def _without_nothing_measured(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """What says nothing is left out, so that results without it stay as they were."""
        return {name: value for name, value in dump(self).items() if (name, value) not in NOTHING}

    @model_validator(mode="after")
    def _stated_modulus(self) -> "DeviceSettings":
        """A modulus that is stated departs by less than that of any plated nickel."""
        name = "youngs_modulus_GPa"
        if name in self.model_fields_set and name not in self.spread.model_fields_set:
            narrower = self.spread.model_copy(update={name: STATED_MODULUS})
            object.__setattr__(self, "spread", narrower)  # frozen from here on
        return self

    @model_validator(mode="after")
    def _measured_of_a_beam(self) -> "DeviceSettings":
        if self.measured is None:
            return self
        if self.kind == "plate":
            raise ValueError("measured narrows a beam; a plate is stated by spring_N_per_m")
        if self.measured.resonance_kHz and "density_g_cm3" not in self.model_fields_set:
            raise ValueError(
                "measured.resonance_kHz needs the density of the beam: give density_g_cm3"
            )
        return self

    @model_validator(mode="after")
    def _charge_in_a_dielectric(self) -> "DeviceSettings":
        charged = self.charge_e_cm2 != 0.0 or self.spread.charge_e_cm2 or self.uneven
        if charged and self.dielectric_nm == 0.0:
            raise ValueError(
                "charge_e_cm2 and uneven: a dielectric without thickness holds no charge; give"
                " dielectric_nm, or state shift_V"
            )
        return self

    @model_validator(mode="after")
    def _parts_of_the_beam(self) -> "DeviceSettings":
        for name in ("electrode", "contact"):
            start, end = getattr(self, name)
            if not 0.0 <= start < end <= 1.0:
                raise ValueError(
                    f"{name} = [{start:g}, {end:g}]: accepted are two rising shares of the length,"
                    " 0 to 1"
                )
        return self

    @property
    def kind(self) -> Kind:
        """Which switch the settings describe: a bending beam, or a plate on a spring."""
        return "beam" if self.spring_N_per_m is None else "plate"

    @property
    def charged(self) -> bool:
        """Whether it has charge or a contact potential, or may have."""
        return bool(
            self.uneven
            or any(getattr(self, name) or getattr(self.spread, name) for name in EVEN_CHARGE)
        )

    @property
    def uncharged(self) -> "DeviceSettings":
        """The same device without charge and contact potential."""
        return self.model_copy(update=dict.fromkeys(EVEN_CHARGE, 0.0) | {"uneven": None})

    @property
    def level(self) -> "DeviceSettings":
        """The same device without its tilt."""
        return self.model_copy(update={"tilt_nm": 0.0})

    @property
    def dielectric_gap_nm(self) -> float:
        """Thickness of vacuum with the field of the dielectric."""
        return self.dielectric_nm / self.permittivity

    @property
    def area_um2(self) -> float:
        """Area of the electrode, um^2."""
        return (self.electrode[1] - self.electrode[0]) * self.length_um * self.width_um

    @property
    def pad_um2(self) -> float:
        """Area of the rough pad, um^2."""
        start, end = self.electrode if self.kind == "plate" else self.contact
        return (end - start) * self.length_um * self.width_um

    @property
    def bending_GPa(self) -> float:
        """Modulus of bending: E, or E / (1 - nu^2) of a wide beam, whose edges cannot curl."""
        # Osterberg and Senturia, J. MEMS 6 (1997) 107
        wide = self.width_um >= 5.0 * self.thickness_um
        plate = wide if self.bends_as is None else self.bends_as == "plate"
        return self.youngs_modulus_GPa / (1.0 - self.poisson_ratio**2 if plate else 1.0)

    @property
    def heating_MPa(self) -> float:
        """Axial stress by the temperature, -E (alpha_beam - alpha_substrate) (T - 20 C)."""
        strain = 1e-6 * self.excess_expansion_ppm_C * (self.temperature_C - REFERENCE_C)
        return -1e3 * self.youngs_modulus_GPa * strain

    def shape_at_rest_nm(self, share: "ArrayLike") -> "NDArray[np.float64]":
        """Height of the bending electrode at rest over its flat place (nm), at shares of its length
        from one end.
        """
        import numpy as np

        x = np.asarray(share, float)
        if self.ends == "cantilever":
            return self.bow_nm * x**2 + self.tilt_nm * x
        return self.bow_nm * 0.5 * (1.0 - np.cos(2.0 * np.pi * x)) + self.tilt_nm * (x - 0.5)

    def slope_at_rest_nm(self, share: "ArrayLike") -> "NDArray[np.float64]":
        """Derivative of `shape_at_rest_nm` by the share."""
        import numpy as np

        x = np.asarray(share, float)
        if self.ends == "cantilever":
            return 2.0 * self.bow_nm * x + self.tilt_nm
        return self.bow_nm * np.pi * np.sin(2.0 * np.pi * x) + self.tilt_nm

    @property
    def touching_at_rest(self) -> str:
        """One line on a bending electrode that touches at rest; empty where it does not."""
        import numpy as np

        shares = np.linspace(0.0, 1.0, 1001)
        height = 1e3 * self.gap_um + self.shape_at_rest_nm(shares)
        within = (self.contact[0] <= shares) & (shares <= self.contact[1])
        lowest_nm = float((height - np.where(within, self.dimple_nm, self.stopper_nm)).min())
        if self.kind == "plate" or lowest_nm > 0.0:
            return ""
        return (
            f"device: at rest the electrode is {lowest_nm:.4g} nm above what it lands on at its"
            " lowest; lower bow_nm, tilt_nm, dimple_nm or stopper_nm, or raise gap_um"
        )

    @property
    def designed(self) -> tuple[str, ...]:
        """The properties that its designer chooses, its spring first."""
        return DESIGNED[self.kind]

    def has(self, name: str) -> bool:
        """Whether this property acts on this kind of switch."""
        if self.kind == "beam":
            return name != "spring_N_per_m"
        return name in {*DESIGNED["plate"], *UNCERTAIN["plate"]}

    @property
    def varied(self) -> list[str]:
        """The properties that are not exactly known."""
        names = UNCERTAIN[self.kind]
        return [name for name in names if getattr(self.spread, name) is not None]

    @property
    def without_circuit(self) -> str:
        """One line on a switch that has no circuit, whose lumps are those of a symmetric beam;
        empty where it has one.
        """
        if self.kind != "beam":
            return "device.spring_N_per_m: circuits are made of bending electrodes; set it to null"
        if self.ends == "clamped" and self.electrode == self.contact == (0.0, 1.0):
            return ""
        return (
            "device.ends, electrode, contact: circuits are made of beams clamped at both ends, with"
            " electrode and pad all along; take clamped, [0, 1] and [0, 1], or leave the circuit"
            " out"
        )


def unit_of(name: str) -> str:
    """Unit of a key of the device; 1 where it has none."""
    extra = DeviceSettings.model_fields[name].json_schema_extra
    if isinstance(extra, dict) and "unit" in extra:
        return str(extra["unit"])
    return "1"
