"""The reader of coordinates as text, without its worst case."""

from typing import Any

from SurfaceTopography.IO.common import OpenFromAny
from SurfaceTopography.IO.XYZ import XYZReader, read_csv


class QuickXYZReader(XYZReader):
    """As its base, which takes each of 200 lines for the first of the numbers and in turn reads to where they break.

    What breaks numbers beyond these lines breaks them whatever line is the first: one reading tells.
    """

    def _read_file(
        self, header_parser: Any, unit: Any, height_scale_factor: Any, info: Any, max_header_rows: int, encoding: str
    ) -> Any:
        given = header_parser, unit, height_scale_factor, info
        first = super()._read_file(*given, 1, encoding)
        if first[0] is not None or self._breaks(*given[:3], max_header_rows, encoding):
            return first
        return super()._read_file(*given, max_header_rows, encoding)

    def _breaks(self, header_parser: Any, unit: Any, scale: Any, header_rows: int, encoding: str) -> bool:
        with OpenFromAny(self._file_path, mode="r", encoding=encoding) as stream:
            sep, columns = header_parser(stream, unit, scale)[:2] if header_parser else (None, None)
            try:
                read_csv(stream, sep=sep, usecols=columns, skiprows=header_rows - 1)
            except ValueError:
                return True
        return False
