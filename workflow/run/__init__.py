"""A run: who owns its folder, what its jobs share, its plan and cost, a line for each job, its last
words.
"""
