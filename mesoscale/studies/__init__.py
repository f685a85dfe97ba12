"""Accuracy and stability of the stages at the inputs and settings of a scene (targets `accuracy`, `stability`)."""
