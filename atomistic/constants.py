"""Physical constants, written out: glasses are chaotic, so that another edition's last digit would be another glass."""

EV_PER_A3_IN_GPA = 160.21766208  # 1 eV/Å³; CODATA 2014, as ase.units, which converts the DFT energies
COULOMB_EV_A = 14.399645  # e²/(4π ε0); CODATA 2018, and the value of LAMMPS's metal units
KE_EV = 1.0364269e-4  # 1 u (Å/ps)² in eV; the value of LAMMPS's metal units
BOLTZMANN_EV_PER_K = 8.617333e-5  # CODATA 2018
AVOGADRO = 6.02214076e23  # 1/mol, exact
AMU_PER_A3_IN_G_CM3 = 1.66053906660  # 1 u/Å³; CODATA 2018, 3e-10 from what AVOGADRO gives
