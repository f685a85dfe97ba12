"""Physical constants, written out: glasses are chaotic; another last digit is another glass."""

# 1 eV/Å³; CODATA 2014, as ase.units, which converts the DFT energies
EV_PER_A3_IN_GPA = 160.21766208
COULOMB_EV_A = 14.399645  # e²/(4π ε0); CODATA 2018, and the value of LAMMPS's metal units
AVOGADRO = 6.02214076e23  # 1/mol, exact
AMU_PER_A3_IN_G_CM3 = 1.66053906660  # 1 u/Å³; CODATA 2018, 3e-10 from what AVOGADRO gives
