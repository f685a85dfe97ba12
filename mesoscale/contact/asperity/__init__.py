"""Contact of rough surfaces whose asperities carry load each on its own, as in the paper
(docs/contact.md).
"""
