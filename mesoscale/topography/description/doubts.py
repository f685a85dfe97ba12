"""What is doubtful about measurements, each with a code for programs and a remedy for people."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Doubt:
    """Why a result should be taken with care.

    Attributes
    ----------
    code : for programs; does not change with the wording.
    text : what is doubtful, with numbers.
    remedy : what to do about it; may be empty where the text says so.
    about : the quantity that it touches: q0, slope, rms, heights, spectrum or contact.
    fatal : the measurements say nothing of a surface; no description helps.
    """

    code: str
    text: str
    remedy: str = ""
    about: str = "spectrum"
    fatal: bool = False

    def plain(self) -> dict[str, str]:
        """As a result file has it."""
        return {"code": self.code, "about": self.about, "text": self.text, "remedy": self.remedy}
