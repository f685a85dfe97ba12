"""What the numerical choices of the switch on a pad cost, and what they leave open."""
