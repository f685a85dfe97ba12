"""Words of the page explained where they first stand in a section, by hover and by focus, and in a list at its end."""

import re

from markupsafe import Markup, escape

TERMS = {
    "d_c": "Separation of the mean planes at which the contact begins to push, from the fitted law.",
    "C_a": "Adhesion per nanometre of approach: slope of the law's attraction near contact.",
    "C_r": "Scale of the law's repulsion.",
    "ρ_r": "Decay length of the law's repulsion: how soft the contact is.",
    "reading": "One of several ways to understand what the model's source leaves open; the scene chooses one of each.",
    "gate": "Test that a stage must pass before its numbers are trusted.",
    "pad": "The whole area that lands: many cells under one plane.",
    "cell": "A square of rough surface, one square micrometre by default, that is computed by itself.",
    "elementary effect": "Change of an output when one input moves over its whole range, averaged over the others.",
    "response": "Fast fit of the outputs to the inputs, made from direct runs.",
    "pull-in": "Voltage at which the open switch snaps shut.",
    "release": "Voltage at which the closed switch lets go, as its voltage is lowered.",
    "stiction": "The switch stays closed without a voltage.",
    "D₀": "Smallest gap at which surfaces attract; the smaller it is, the stronger the adhesion.",
    "RMS": "Root mean square of the heights of a surface about their mean.",
}
PLURAL = {"reading", "gate", "pad", "cell", "elementary effect", "response"}


def _pattern(term: str) -> str:
    return rf"{re.escape(term)}s?" if term in PLURAL else re.escape(term)


_ANY = re.compile(rf"(?<![\w-])({'|'.join(_pattern(term) for term in sorted(TERMS, key=len, reverse=True))})(?![\w-])")


class Explainer:
    """Marks the first use of each term in each place of the page."""

    def __init__(self) -> None:
        self.done: set[tuple[str, str]] = set()

    def __call__(self, text: str, place: str) -> Markup:
        """Escaped text whose terms, where new to `place`, are links to the glossary with their meaning."""
        return Markup(_ANY.sub(lambda match: self._marked(match[1], place), str(escape(text))))

    def _marked(self, word: str, place: str) -> str:
        term = word if word in TERMS else word.removesuffix("s")
        if (place, term) in self.done:
            return word
        self.done.add((place, term))
        link = f'href="#{anchor(term)}" aria-describedby="{anchor(term)}" data-tip="{escape(TERMS[term])}"'
        return f'<a class="term" {link}>{word}</a>'


def anchor(term: str) -> str:
    """Id of a term in the list at the end of the page."""
    return f"term-{term.replace(' ', '-')}"
