"""The ground: what comes from a stranger is read with limits. Imports nothing of ours; anybody may
use it.
"""
