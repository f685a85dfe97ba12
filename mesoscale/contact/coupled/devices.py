"""Where arrays live: NumPy's in the memory of the processor, those of CuPy or PyTorch on a GPU.

All three speak the array API (https://data-apis.org/array-api), CuPy and PyTorch by
`array-api-compat`.
"""

import importlib
import importlib.util
from typing import Any, Literal, TypeGuard, get_args

import numpy as np

from mesoscale.errors import InputError
from mesoscale.extras import MissingExtra, needs
from mesoscale.memory import GPU_SITE_MB

Array = Any
Device = Literal["cpu", "cuda"]
LIBRARIES = {"cupy": "CuPy", "torch": "PyTorch"}


def is_numpy(array: Array) -> TypeGuard[np.ndarray]:
    """Whether an array is NumPy's."""
    return isinstance(array, np.ndarray)


def namespace(array: Array) -> Any:
    """Functions of the array API for an array; NumPy has them itself."""
    if is_numpy(array):
        return np
    from array_api_compat import array_namespace

    return array_namespace(array)


def check_device(device: Any) -> None:
    """Refuse what is no device.

    Raises
    ------
    InputError
    """
    if device not in get_args(Device):
        raise InputError(f"device = {device!r:.60}: accepted are 'cpu' and 'cuda', an Nvidia GPU")


def placed(array: np.ndarray, device: Device, transformed: int) -> Array:
    """An array on a device; the processor has it already.

    Parameters
    ----------
    transformed : sites of its transforms.

    Raises
    ------
    MissingExtra : no library for the device.
    InputError : no GPU, or one with too little memory.
    """
    if device == "cpu":
        return array
    installed = [name for name in LIBRARIES if importlib.util.find_spec(name)]
    if not installed:
        raise MissingExtra(
            "device = 'cuda': needs CuPy or PyTorch, for CUDA: pip install 'asperity-contact[gpu]',"
            " which brings CuPy for CUDA 12, or either library for your version"
        )
    with needs("gpu"):
        importlib.import_module("array_api_compat")
    for name in installed:
        library = importlib.import_module(name)
        if library.cuda.is_available():
            _check_memory(array.size, transformed, _memory_MB(library))
            xp = importlib.import_module(f"array_api_compat.{name}")
            return xp.asarray(array, device=_first_gpu(library))
    names = " and ".join(LIBRARIES[name] for name in installed)
    raise InputError(
        f"device = 'cuda': no GPU for {names} as installed on this machine; take device='cpu'"
    )


def _first_gpu(library: Any) -> Any:
    """The GPU that a library calls the first."""
    if library.__name__ == "cupy":
        return library.cuda.Device(0)
    return library.device("cuda", 0)


def _memory_MB(library: Any) -> float:
    """Memory of the first GPU."""
    if library.__name__ == "cupy":
        _, total = library.cuda.Device(0).mem_info
    else:
        _, total = library.cuda.mem_get_info(0)
    return total / 1e6


def _check_memory(sites: int, transformed: int, present_MB: float) -> None:
    """Refuse a map that needs more memory than the GPU has."""
    needed_MB = GPU_SITE_MB["map"] * sites + GPU_SITE_MB["transforms"] * transformed
    if needed_MB > present_MB:
        raise InputError(
            f"device = 'cuda': a contact of {sites} sites needs {needed_MB / 1000:.3g} GB of the"
            f" GPU's memory, it has {present_MB / 1000:.3g}; take device='cpu', a part of the"
            " surface, or every second site"
        )


def fetched(array: Array) -> np.ndarray:
    """An array in the memory of the processor."""
    if is_numpy(array):
        return array
    from array_api_compat import is_cupy_array, is_torch_array, to_device

    if is_cupy_array(array) or is_torch_array(array):
        array = to_device(array, "cpu")
    return np.asarray(array)
