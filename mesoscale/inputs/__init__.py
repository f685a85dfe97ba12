"""The uncertain inputs of the contact model: what they are and how they are distributed."""
