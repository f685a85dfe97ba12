"""Run times and memory of the contact model, beside a plain implementation, other codes and a floor."""
