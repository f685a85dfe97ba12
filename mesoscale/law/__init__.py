"""The compact force-separation law, its fit and its error (docs/law.md)."""
