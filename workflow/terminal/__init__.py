"""What a run says: its plan and cost, a line for each finished job, and its closing words."""
