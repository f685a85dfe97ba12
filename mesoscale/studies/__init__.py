"""Accuracy of a scene's topography and pad, stability of its contact (targets `accuracy` and
`stability`).
"""
