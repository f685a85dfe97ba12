"""Accuracy of a scene's pad, stability of its contact (targets `accuracy` and `stability`)."""
