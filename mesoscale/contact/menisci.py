"""Liquid that condenses from humid air between two walls, and how it pulls (docs/humidity.md).

In equilibrium with the vapour a meniscus has Kelvin's radius r_K = -gamma V_m / (R T ln RH). Liquid
fills every gap below d_c = r_K (cos theta1 + cos theta2) + 2 t_w, where each wall has an adsorbed
film t_w, and Laplace's pressure p_c = gamma / r_K pulls the walls together there (Israelachvili,
Intermolecular and Surface Forces, 2011, ch. 17). Where two films meet, below 2 t_w, it does not
pull: the disjoining pressure that holds the films balances it. So flats lose the work
gamma (cos theta1 + cos theta2) with any film. Where the walls part faster than the liquid
evaporates, its volume stays, d_c grows and p_c falls.

A film in balance with the vapour has the disjoining pressure A_f / (6 pi t_w^3) = p_c. Here A_f is
that of wall, liquid and vapour. By combining relations A_f = (sqrt(A_w) - sqrt(A_l)) sqrt(A_l), and
A_H across the liquid is (sqrt(A_w) - sqrt(A_l))^2 (Israelachvili, ch. 13 and 21).
"""

import math
from typing import NamedTuple

from mesoscale.settings.contact import WATER_CM3, AirSettings

ZERO_C_K = 273.15
GAS_J_MOL_K = 8.314462618  # CODATA 2018
PER_MOL = 6.02214076e23
WATER_CRITICAL_K, WATER_CRITICAL_KPA = 647.096, 22064.0  # IAPWS


class Menisci(NamedTuple):
    """Liquid in the gaps of a contact.

    Attributes
    ----------
    pull_GPa : p_c; attraction of the walls where there is liquid.
    reach_nm : d_c; gap below which there is liquid.
    films_nm : adsorbed films of both walls together; closer walls are not pulled.
    tension : gamma (cos theta1 + cos theta2), nN/nm.
    thinnest_nm : a molecule of the liquid; no meniscus is thinner.
    dispersion : Hamaker constant across the liquid over that across air.
    keeps_volume : whether an opening keeps the volume of the liquid; else it stays in equilibrium
        with the vapour.
    """

    pull_GPa: float
    reach_nm: float
    films_nm: float
    tension: float
    thinnest_nm: float
    dispersion: float
    keeps_volume: bool

    def pull_at(self, reach_nm: float) -> float:
        """p_c (GPa) of liquid that reaches up to a gap beyond that of the films."""
        # radius times the cosines
        return self.tension / max(reach_nm - self.films_nm, self.thinnest_nm)

    @property
    def mean_pull_GPa(self) -> float:
        """Pull that does the work of p_c where it acts from touch on."""
        return self.pull_GPa * (1.0 - self.films_nm / self.reach_nm)

    @property
    def pulled_from_nm(self) -> float:
        """Gap from which on p_c pulls; sites that overlap hold liquid, too, where they attract."""
        if self.films_nm == 0.0:
            return -math.inf
        return self.films_nm


class Liquid(NamedTuple):
    """Liquid in a cell.

    Attributes
    ----------
    sites : how many sites' areas it fills.
    volume : beside the films, over the area of a site, nm.
    reach : gap up to which there is liquid, nm.
    """

    sites: float
    volume: float
    reach: float


def menisci_of(air: AirSettings | None, hamaker: float) -> Menisci | None:
    """The menisci in air; None where nothing condenses, or liquid is thinner than a molecule.

    Parameters
    ----------
    hamaker : Hamaker constant A_H of the walls across air, nN nm.
    """
    if air is None or air.humidity == 0.0:
        return None
    tension = 1e-3 * surface_tension_mN_m(air)
    wetting = sum(math.cos(math.radians(angle)) for angle in air.contact_angles_deg)
    if tension <= 0.0 or wetting <= 1e-12:  # 90 and 90 degrees, but for rounding
        return None
    kelvin = air.temperature_C + ZERO_C_K
    volume = air.molar_volume_cm3 or WATER_CM3
    pull = 1e-3 * GAS_J_MOL_K * kelvin * abs(math.log(air.humidity)) / volume  # 1 J/cm^3 = 1e-3 GPa
    between_films = wetting * tension / pull
    molecule_nm = 1e7 * math.cbrt(volume / PER_MOL)  # 0.31 nm of water
    if between_films < molecule_nm:
        return None
    films = 2.0 * film_nm(air, hamaker, pull)
    return Menisci(
        pull,
        between_films + films,
        films,
        wetting * tension,
        molecule_nm,
        air.hamaker_share,
        air.opening == "volume",
    )


def film_nm(air: AirSettings, hamaker: float, pull_GPa: float) -> float:
    """Adsorbed film on each wall (nm); in balance its disjoining pressure is p_c."""
    if air.film_nm == "adsorbed":
        from mesoscale.theory.ageing import adsorbed_film

        return float(adsorbed_film(air.humidity))
    if air.film_nm != "balance":
        return air.film_nm
    liquid = 1.0 - math.sqrt(air.hamaker_share)  # root of the liquid's A over that of the walls
    across_film = hamaker * liquid * (1.0 - liquid)
    return math.cbrt(across_film / (6.0 * math.pi * pull_GPa))


def reach_nm(air: AirSettings | None, hamaker: float) -> float:
    """Gap (nm) below which liquid condenses, of walls with A_H in nN nm; 0 without any."""
    menisci = menisci_of(air, hamaker)
    if menisci is None:
        return 0.0
    return menisci.reach_nm


def surface_tension_mN_m(air: AirSettings) -> float:
    """Surface tension of the liquid; water's by IAPWS R1-76(2014), 0 beyond its critical point."""
    if air.surface_tension_mN_m is not None:
        return air.surface_tension_mN_m
    tau = max(1.0 - (air.temperature_C + ZERO_C_K) / WATER_CRITICAL_K, 0.0)
    return 235.8 * tau**1.256 * (1.0 - 0.625 * tau)


def water_vapour_kPa(temperature_C: float) -> float:
    """Pressure of saturated water vapour (Wagner, Pruss 2002, doi:10.1063/1.1461829, eq. 2.5)."""
    kelvin = min(temperature_C + ZERO_C_K, WATER_CRITICAL_K)
    tau = 1.0 - kelvin / WATER_CRITICAL_K
    factors = (-7.85951783, 1.84408259, -11.7866497, 22.6807411, -15.9618719, 1.80122502)
    powers = (1.0, 1.5, 3.0, 3.5, 4.0, 7.5)
    series = sum(factor * tau**power for factor, power in zip(factors, powers, strict=True))
    return WATER_CRITICAL_KPA * math.exp(WATER_CRITICAL_K / kelvin * series)
