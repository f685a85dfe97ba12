"""Files of the elastic stage: structures as XYZ, finished SCF calculations as a directory."""

import io
import shutil
from collections.abc import Iterator, MutableMapping
from pathlib import Path

import numpy as np
from ase import Atoms

from workflow.files.results import atomic_path


def structure_text(atoms: Atoms) -> str:
    """Extended XYZ with every digit, so that a structure read back is the same to the last bit."""
    lattice = " ".join(repr(float(x)) for x in atoms.cell.array.ravel())
    lines = [str(len(atoms)), f'Lattice="{lattice}" Properties=species:S:1:pos:R:3 pbc="T T T"']
    lines += [
        f"{symbol} {x!r} {y!r} {z!r}"
        for symbol, (x, y, z) in zip(
            atoms.get_chemical_symbols(), atoms.positions.tolist(), strict=True
        )
    ]
    return "\n".join(lines) + "\n"


def load_structure(path: str | Path) -> Atoms:
    """Read what `structure_text` makes (or any extended XYZ)."""
    from ase.io import read

    return read(io.StringIO(Path(path).read_text(encoding="utf-8")), format="extxyz")  # type: ignore[return-value]


class ScfStore(MutableMapping[str, dict[str, np.ndarray]]):
    """Finished SCF calculations of a job, one file each: a killed job loses only the one it was
    in.
    """

    def __init__(self, path: Path):
        self.path = path

    def _file(self, key: str) -> Path:
        return self.path / f"{key}.npz"

    def __contains__(self, key: object) -> bool:
        return self._file(str(key)).exists()

    def __getitem__(self, key: str) -> dict[str, np.ndarray]:
        if key not in self:
            raise KeyError(key)
        with np.load(self._file(key), allow_pickle=False) as content:
            return {name: content[name] for name in content.files}

    def __setitem__(self, key: str, value: dict[str, np.ndarray]) -> None:
        with atomic_path(self._file(key)) as temporary, temporary.open("wb") as stream:
            np.savez(stream, allow_pickle=False, **value)

    def __delitem__(self, key: str) -> None:
        self._file(key).unlink()

    def __iter__(self) -> Iterator[str]:
        return (path.stem for path in self.path.glob("*.npz"))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def remove(self) -> None:
        """Delete the directory once the results are written."""
        shutil.rmtree(self.path, ignore_errors=True)
