"""Contact of asperities that carry load each on its own, as in the paper (docs/contact.md)."""
